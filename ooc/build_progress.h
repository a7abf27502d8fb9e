#pragma once
/// How the stages of a build tell how far they are.

#include <cstdint>
#include <functional>
#include <string_view>

namespace cuesta {

/// Work done of the total in the stage's own unit; returning false cancels. Called by one thread at a time.
using BuildProgress = std::function<bool(std::string_view stage, std::uint64_t done, std::uint64_t total)>;

}  // namespace cuesta
