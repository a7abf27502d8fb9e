#include "hierarchy/verify_sources.h"
#include "ooc/triangle_order.h"

#include <algorithm>
#include <string>
#include <utility>

namespace cuesta {
namespace {

void count_up(std::uint8_t& n) {
  if (n < 255) ++n;
}

std::string of_source(PageId source) {
  return " of source page " + std::to_string(source);
}

/// Local number of each survivor vertex of the source; none where the page does not have it.
constexpr std::uint32_t absent = 0xFFFFFFFFu;
std::vector<std::uint32_t> local_numbers(PageId id, const PageSource& s,
                                         std::span<const std::uint8_t> removed, ClaimedSurvivors& from,
                                         VerifyReport& report) {
  std::vector<std::uint32_t> local(from.survivors.vertices, absent);
  for (std::size_t i = 0; i < s.vertices.size(); ++i) {
    const std::uint32_t v = s.vertices[i];
    if (v >= local.size()) {
      report.add(Check::sources, id, v, "no such survivor vertex" + of_source(s.page));
      continue;
    }
    local[v] = s.local_vertices[i];
    count_up(from.vertex_claims[v]);
    if (removed[s.local_vertices[i]]) count_up(from.vertex_owners[v]);
  }
  return local;
}

std::array<std::uint32_t, 3> renamed(std::array<std::uint32_t, 3> t, std::span<const std::uint32_t> local) {
  return smallest_first({local[t[0]], local[t[1]], local[t[2]]});
}

}  // namespace

ClaimedSurvivors claimable(ReplayedSurvivors survivors, std::uint32_t coarser_pages) {
  ClaimedSurvivors c;
  c.triangle_claims.assign(survivors.triangles.size(), 0);
  c.vertex_claims.assign(survivors.vertices, 0);
  c.vertex_owners.assign(survivors.vertices, 0);
  c.pages_left = coarser_pages;
  c.survivors = std::move(survivors);
  return c;
}

void claim(PageId id, const Page& page, const PageSource& s, std::span<const std::uint8_t> removed,
           ClaimedSurvivors& from, std::vector<Birth>& births, VerifyReport& report) {
  const auto local = local_numbers(id, s, removed, from, report);
  for (std::size_t i = 0; i < s.triangles.size(); ++i) {
    const std::uint32_t t = s.triangles[i], here = s.first_triangle + static_cast<std::uint32_t>(i);
    if (t >= from.survivors.triangles.size()) {
      report.add(Check::sources, id, here, "no such survivor triangle" + of_source(s.page));
      continue;
    }
    count_up(from.triangle_claims[t]);
    births[here] = from.survivors.births[t];
    if (renamed(from.survivors.triangles[t], local) != page.triangles[here])
      report.add(Check::sources, id, here,
                 "the triangle's corners are not those of survivor " + std::to_string(t) + of_source(s.page));
  }
}

void check_claims(PageId source, const ClaimedSurvivors& c, VerifyReport& report) {
  for (std::size_t t = 0; t < c.triangle_claims.size(); ++t)
    if (c.triangle_claims[t] != 1)
      report.add(
          Check::sources, source, t,
          "survivor triangle is in " + std::to_string(c.triangle_claims[t]) + " coarser pages, not in one");
  for (std::size_t v = 0; v < c.vertex_claims.size(); ++v) {
    if (c.vertex_claims[v] == 0)
      report.add(Check::sources, source, v, "survivor vertex is in no coarser page");
    else if (c.vertex_claims[v] > 1 && c.vertex_owners[v] > 0)
      report.add(Check::sources, source, v, "survivor vertex is removed by one of the pages that share it");
  }
}

}  // namespace cuesta
