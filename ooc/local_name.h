#pragma once
/// Names of files that a file of the world gives.

#include <string>

namespace cuesta {

/// Below the folder of the file that names it: nothing absolute, no scheme, no way up.
bool is_local_name(const std::string& name);

}  // namespace cuesta
