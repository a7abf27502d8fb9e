#include "ooc/local_name.h"

#include <algorithm>
#include <filesystem>

namespace cuesta {

bool is_local_name(const std::string& name) {
  if (name.empty() || name.find('\0') != name.npos || name.find(':') != name.npos ||
      name.find('\\') != name.npos) {
    return false;
  }
  const std::filesystem::path path(name);
  return path.is_relative() &&
         std::none_of(path.begin(), path.end(), [](const auto& part) { return part == ".."; });
}

}  // namespace cuesta
