#include "hierarchy/verify_report.h"

#include <numeric>
#include <utility>

namespace cuesta {

std::string_view name(Check check) {
  constexpr std::array<std::string_view, check_count> names{
      "readable", "directory", "sources", "crack_free", "legal", "saturated", "honest_error"};
  return names.at(static_cast<std::size_t>(check));
}

std::uint64_t VerifyReport::violations() const {
  return std::accumulate(found.begin(), found.end(), std::uint64_t{0});
}

bool VerifyReport::ok() const {
  return violations() == 0;
}

void VerifyReport::add(Check check, PageId page, std::uint64_t number, std::string text) {
  ++found[static_cast<std::size_t>(check)];
  if (findings.size() < max_findings) findings.push_back({check, page, number, std::move(text)});
}

}  // namespace cuesta
