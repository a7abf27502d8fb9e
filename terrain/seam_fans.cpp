#include "terrain/seam_fans.h"

#include <algorithm>
#include <tuple>

namespace cuesta {
namespace {

auto order_of(const PostingRef& p) {
  return std::tuple(p.layer, p.row, p.column);
}
bool before(const PostingRef& a, const PostingRef& b) {
  return order_of(a) < order_of(b);
}

/// Triangles around a posting that edges from it join: their other corners, and which they are.
struct Fan {
  std::vector<PostingRef> others;
  std::vector<std::size_t> parts;
};

bool joins(const Fan& a, const Fan& b) {
  return std::any_of(a.others.begin(), a.others.end(), [&](const PostingRef& p) {
    return std::find(b.others.begin(), b.others.end(), p) != b.others.end();
  });
}

void add_part(std::vector<Fan>& fans, Fan part) {
  for (auto fan = fans.begin(); fan != fans.end();) {
    if (!joins(*fan, part)) {
      ++fan;
      continue;
    }
    part.others.insert(part.others.end(), fan->others.begin(), fan->others.end());
    part.parts.insert(part.parts.end(), fan->parts.begin(), fan->parts.end());
    fan = fans.erase(fan);
  }
  fans.push_back(std::move(part));
}

}  // namespace

SeamFans::SeamFans(std::span<const SeamTriangle> corners) : fans_(corners.size()) {
  for (std::uint32_t s = 0; s < corners.size(); ++s)
    for (std::uint32_t k = 0; k < 3; ++k) uses_.push_back({s, k});
  const auto posting = [&](const std::array<std::uint32_t, 2>& use) { return corners[use[0]][use[1]]; };
  std::stable_sort(uses_.begin(), uses_.end(),
                   [&](const auto& a, const auto& b) { return before(posting(a), posting(b)); });
  for (std::uint64_t u = 0; u < uses_.size(); ++u) {
    if (u > 0 && posting(uses_[u]) == posting(uses_[u - 1])) continue;
    postings_.push_back(posting(uses_[u]));
    first_use_.push_back(u);
  }
  first_use_.push_back(uses_.size());
}

bool SeamFans::contains(const PostingRef& at) const {
  return std::binary_search(postings_.begin(), postings_.end(), at, before);
}

/// Parts are the cell fans, then the seams.
SeamFans::Split SeamFans::split(std::size_t i, const CellFans& cells, std::span<const SeamTriangle> corners) {
  constexpr std::size_t first_seam = LatticePatch::most_fans;
  std::vector<Fan> fans;
  for (std::size_t f = 0; f < first_seam; ++f)
    if (!cells.others[f].empty()) add_part(fans, {cells.others[f], {f}});
  const std::span<const std::array<std::uint32_t, 2>> uses =
      std::span(uses_).subspan(first_use_[i], first_use_[i + 1] - first_use_[i]);
  for (std::size_t u = 0; u < uses.size(); ++u) {
    const auto& [seam, k] = uses[u];
    add_part(fans, {{corners[seam][(k + 1) % 3], corners[seam][(k + 2) % 3]}, {first_seam + u}});
  }
  // By their first parts: whatever the order in which they were joined.
  for (Fan& fan : fans) std::sort(fan.parts.begin(), fan.parts.end());
  std::sort(fans.begin(), fans.end(), [](const Fan& a, const Fan& b) { return a.parts < b.parts; });
  Split out{postings_[i], static_cast<std::uint32_t>(std::min(fans.size(), first_seam)), {}};
  for (std::size_t f = 0; f < fans.size(); ++f)
    for (const std::size_t part : fans[f].parts) {
      const auto number = static_cast<std::uint8_t>(std::min(f, first_seam - 1));
      if (part < first_seam)
        out.of_cells[part] = number;
      else
        fans_[uses[part - first_seam][0]][uses[part - first_seam][1]] = number;
    }
  return out;
}

void SeamFans::keep(std::vector<Split> splits) {
  std::erase_if(splits, [](const Split& s) { return s.count < 2; });
  splits_ = std::move(splits);
}

const SeamFans::Split* SeamFans::find(const PostingRef& at) const {
  const auto found = std::lower_bound(splits_.begin(), splits_.end(), at,
                                      [](const Split& s, const PostingRef& p) { return before(s.at, p); });
  return found != splits_.end() && found->at == at ? &*found : nullptr;
}

std::uint32_t SeamFans::count(const PostingRef& at) const {
  const Split* split = find(at);
  return split ? split->count : 1;
}

std::uint32_t SeamFans::of_cells(const PostingRef& at, std::uint32_t cell_fan) const {
  const Split* split = find(at);
  return split ? split->of_cells[cell_fan] : 0;
}

}  // namespace cuesta
