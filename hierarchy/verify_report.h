#pragma once
/// What a look at a .cuesta file found: counts of what was checked, and the first findings in words.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "hierarchy/page.h"

namespace cuesta {

/// Guarantees that a file is held to; I1 … I5 are those of DESIGN §1.
enum class Check : std::uint8_t {
  readable,      ///< checksums, decoding, block places
  directory,     ///< entries and totals agree with the pages
  sources,       ///< pages of a round hold all survivors of the one before, each triangle once
  crack_free,    ///< I1
  legal,         ///< I2
  saturated,     ///< I3
  honest_error,  ///< I5
  count
};
inline constexpr std::size_t check_count = static_cast<std::size_t>(Check::count);
std::string_view name(Check check);

inline constexpr PageId no_page = 0xFFFFFFFFu;

/// One violation; `number` is that of a fan, child, triangle or vertex, as `text` says.
struct Finding {
  Check check = Check::readable;
  PageId page = no_page;  ///< no_page: of the file as a whole
  std::uint64_t number = 0;
  std::string text;
};

struct VerifyReport {
  std::uint64_t pages = 0;
  std::uint64_t fans = 0;
  std::uint64_t substitutions = 0;  ///< wedges that move together count once
  std::uint64_t topology_let_go =
      0;  ///< of these: such that sheets touch or handles close, where little else is left
  float topology_kept_below = std::numeric_limits<float>::infinity();  ///< least error of these, grid units
  std::uint64_t cuts = 0;   ///< sample cuts whose topology and error were checked
  double least_cosine = 1;  ///< of a triangle's normals before and after a substitution
  double median_bound_ratio =
      0;  ///< reported bound over measured distance, over uniform cuts; 0: none measured
  std::array<std::uint64_t, check_count> found{};  ///< violations by check, also those not kept in `findings`
  std::vector<Finding> findings;                   ///< the first max_findings
  std::vector<std::string> skipped;                ///< sentences: what was not checked, and why
  std::size_t max_findings = 20;

  bool ok() const;
  std::uint64_t violations() const;
  void add(Check check, PageId page, std::uint64_t number, std::string text);
};

}  // namespace cuesta
