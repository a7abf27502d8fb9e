#include "hierarchy/verify_directory.h"

#include <algorithm>
#include <string>
#include <utility>

namespace cuesta {
namespace {

/// A walk goes up one round per level; a quarter of the triangles less each time, 2^64 of them need 32.
constexpr std::uint32_t most_rounds = 256;

void check_total(std::uint64_t found, std::uint64_t announced, const char* what, VerifyReport& report) {
  if (found != announced)
    report.add(Check::directory, no_page, found,
               std::string("pages have ") + what + " of " + std::to_string(found) + ", the directory says " +
                   std::to_string(announced));
}

void check_totals(const Directory& d, VerifyReport& report) {
  std::uint64_t triangles = 0, first_round = 0;
  for (const PageEntry& e : d.pages) {
    triangles += e.owned_triangles;
    if (e.round == 0) first_round += e.triangles;
  }
  check_total(triangles, d.triangles, "a sum of owned triangles", report);
  check_total(first_round, d.triangles, "a sum of round 0's triangles", report);
}

void check_blocks(const Directory& d, std::uint64_t file_bytes, VerifyReport& report) {
  std::vector<std::pair<BlockRef, PageId>> blocks;
  for (PageId id = 0; id < d.pages.size(); ++id) blocks.emplace_back(d.pages[id].block, id);
  std::sort(blocks.begin(), blocks.end(),
            [](const auto& a, const auto& b) { return a.first.offset < b.first.offset; });
  std::uint64_t end = container_alignment;  // of the header
  for (const auto& [block, id] : blocks) {
    if (block.offset % container_alignment != 0 || block.offset < end || block.offset > file_bytes)
      report.add(Check::directory, id, block.offset, "the page's block is misplaced");
    end = block.offset + std::min(block.bytes, file_bytes);
  }
}

std::string text(ErrorCode8 code) {
  return std::to_string(decode_error(code));
}

void check_errors(PageId id, const PageEntry& e, const Page& page, VerifyReport& report) {
  ErrorCode8 least = page.script.children.empty() ? 0 : 255, largest = 0;
  for (const Child& c : page.script.children) {
    least = std::min(least, c.error);
    largest = std::max(largest, c.error);
  }
  // The entry's largest error covers finer pages too: check_saturation() looks at those.
  if (least != e.least_error || largest > e.largest_error)
    report.add(Check::directory, id, e.largest_error,
               "errors are from " + text(least) + " to " + text(largest) + ", the entry says " +
                   text(e.least_error) + " to " + text(e.largest_error));
}

void check_bound(PageId id, const PageEntry& e, const Page& page, std::span<const Vec3i> positions,
                 VerifyReport& report) {
  for (std::size_t f = 0; f < page.script.fans.size(); ++f) {
    const Fan& fan = page.script.fans[f];
    if (!contains(e.bound, decode_sphere(fan.sphere, positions[fan.centre])))
      report.add(Check::directory, id, f,
                 "the page's bound does not contain the sphere of fan " + std::to_string(f));
  }
  for (std::size_t v = 0; v < positions.size(); ++v)
    if (length(vec_cast<double>(positions[v]) - vec_cast<double>(e.bound.centre)) >
        static_cast<double>(e.bound.radius))
      return report.add(Check::directory, id, v,
                        "the page's bound does not contain vertex " + std::to_string(v));
}

}  // namespace

namespace {

/// A page is never wanted without the pages it leans on.
void check_saturation(const Directory& d, VerifyReport& report) {
  for (PageId id = 0; id < d.pages.size(); ++id)
    for (PageId c : d.pages[id].coarser)
      if (c < d.pages.size() && (d.pages[c].largest_error < d.pages[id].largest_error ||
                                 !contains(d.pages[c].bound, d.pages[id].bound)))
        report.add(
            Check::directory, c, id,
            "its error and bound do not cover those of page " + std::to_string(id) + ", which leans on it");
}

}  // namespace

bool check_directory(const Directory& d, std::uint64_t file_bytes, VerifyReport& report) {
  check_totals(d, report);
  check_saturation(d, report);
  check_blocks(d, file_bytes, report);
  const std::uint32_t rounds = d.pages.back().round;
  if (rounds >= most_rounds)
    report.add(Check::directory, d.base(), rounds, "more than " + std::to_string(most_rounds) + " rounds");
  return rounds < most_rounds;
}

void check_vertex_total(const Directory& d, std::uint64_t orphans, VerifyReport& report) {
  std::uint64_t vertices = 0;
  for (const PageEntry& e : d.pages) vertices += e.owned_vertices;
  if (vertices < d.vertices || vertices - d.vertices > orphans)
    check_total(vertices, d.vertices, "a sum of owned vertices", report);
}

void check_entry(PageId id, const PageEntry& e, const Page& page, std::span<const Vec3i> positions,
                 const ReplayedSurvivors& survivors, VerifyReport& report) {
  const auto triangles =
      static_cast<std::uint32_t>(page.base ? page.triangles.size() : survivors.removed_triangles);
  if (triangles != e.owned_triangles)
    report.add(Check::directory, id, triangles,
               "the script removes " + std::to_string(triangles) + " triangles, the entry says " +
                   std::to_string(e.owned_triangles));
  check_errors(id, e, page, report);
  check_bound(id, e, page, positions, report);
}

std::vector<std::vector<PageId>> source_pages(const Directory& d) {
  std::vector<std::vector<PageId>> sources(d.pages.size());
  for (PageId id = 0; id < d.pages.size(); ++id)
    for (PageId c : d.pages[id].coarser) sources[c].push_back(id);
  return sources;
}

/// Post-order of a walk down from the base page.
std::vector<PageId> finer_first_order(const std::vector<std::vector<PageId>>& sources) {
  std::vector<PageId> order;
  if (sources.empty()) return order;
  std::vector<std::uint8_t> seen(sources.size(), 0);
  std::vector<std::pair<PageId, std::size_t>> path;
  const auto enter = [&](PageId id) {
    if (!std::exchange(seen[id], std::uint8_t{1})) path.emplace_back(id, 0);
  };
  enter(static_cast<PageId>(sources.size() - 1));
  while (!path.empty()) {
    auto& [id, next] = path.back();
    if (next < sources[id].size()) {
      enter(sources[id][next++]);
    } else {
      order.push_back(id);
      path.pop_back();
    }
  }
  return order;
}

}  // namespace cuesta
