#include "runtime/geometry_pool.h"

#include <gtest/gtest.h>

#include <random>
#include <set>

namespace cuesta {
namespace {

struct Piece {
  std::uint32_t first, count;
};

TEST(RunAllocator, never_hands_out_an_element_twice) {
  std::mt19937 engine(1);
  const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
  RunAllocator allocator;
  std::vector<Piece> runs;
  std::set<std::uint32_t> used;
  for (int i = 0; i < 4000; ++i) {
    if (runs.empty() || random() % 3 > 0) {
      const std::uint32_t count = 1 + random() % 20;
      runs.push_back({allocator.allocate(count), count});
      for (std::uint32_t k = 0; k < count; ++k)
        ASSERT_TRUE(used.insert(runs.back().first + k).second) << "step " << i;
    } else {
      const std::size_t victim = random() % runs.size();
      const Piece run = runs[victim];
      runs[victim] = runs.back();
      runs.pop_back();
      allocator.release(run.first, run.count);
      for (std::uint32_t k = 0; k < run.count; ++k) used.erase(run.first + k);
    }
    ASSERT_GE(allocator.end(), used.empty() ? 0 : *used.rbegin() + 1);
  }
  for (const Piece& run : runs) allocator.release(run.first, run.count);
  EXPECT_EQ(allocator.end(), 0u) << "free neighbours were not joined";
}

/// Against a plain model: which triangles are active, and what their corners are.
TEST(GeometryPool, active_triangles_are_drawn_once_with_their_corners) {
  using Corners = std::array<std::uint32_t, 3>;
  std::mt19937 engine(2);
  const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
  GeometryPool pool;
  struct PageModel {
    GeometryPool::RunId run;
    std::uint32_t first;
    std::vector<Corners> corners;
    std::vector<bool> active;
  };
  std::vector<PageModel> pages;
  for (int step = 0; step < 3000; ++step) {
    if (pages.size() < 3 || random() % 200 == 0) {
      const std::uint32_t triangles = random() % 700;
      PageModel page{pool.add(random() % 50, triangles), 0, std::vector<Corners>(triangles),
                     std::vector<bool>(triangles)};
      page.first = pool.run(page.run).first_triangle;
      pages.push_back(page);
    } else if (pages.size() > 6) {
      pool.remove(pages.front().run);
      pages.erase(pages.begin());
    }
    PageModel& page = pages[random() % pages.size()];
    if (page.corners.empty()) continue;
    const auto t = static_cast<std::uint32_t>(random() % page.corners.size());
    const auto c = static_cast<std::uint32_t>(random() % 3),
               slot = static_cast<std::uint32_t>(random() % 1000);
    pool.set_corner(page.first + t, c, slot);
    page.corners[t][c] = slot;
    for (std::uint32_t k = 0; k < 3; ++k) pool.set_corner(page.first + t, k, page.corners[t][k]);
    page.active[t] ? pool.deactivate(page.first + t) : pool.activate(page.first + t);
    page.active[t] = !page.active[t];
    if (step % 50 != 0) continue;
    std::multiset<Corners> expected, drawn;
    for (const PageModel& p : pages)
      for (std::size_t i = 0; i < p.corners.size(); ++i) {
        EXPECT_EQ(pool.active(p.first + static_cast<std::uint32_t>(i)), p.active[i]);
        if (p.active[i]) expected.insert(p.corners[i]);
      }
    const DrawList list = pool.draw_list({});
    for (const Range& r : list.draws)
      for (std::uint32_t i = r.first; i < r.first + r.count; i += 3)
        drawn.insert({list.indices[i], list.indices[i + 1], list.indices[i + 2]});
    ASSERT_EQ(drawn, expected) << "step " << step;
    ASSERT_EQ(pool.active_triangles(), expected.size());
  }
}

/// Who uploads only what changed has what is drawn.
TEST(GeometryPool, changed_ranges_are_enough) {
  std::mt19937 engine(3);
  const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
  GeometryPool pool;
  const auto run = pool.add(10, 500);
  const std::uint32_t first = pool.run(run).first_triangle;
  std::vector<bool> active(500);
  std::vector<std::uint32_t> uploaded;
  for (int frame = 0; frame < 200; ++frame) {
    for (std::uint32_t k = random() % 20; k > 0; --k) {
      const auto t = static_cast<std::uint32_t>(random() % 500);
      pool.set_corner(first + t, random() % 3, static_cast<std::uint32_t>(random() % 100));
      if (random() % 2) continue;
      active[t] ? pool.deactivate(first + t) : pool.activate(first + t);
      active[t] = !active[t];
    }
    const DrawList list = pool.draw_list({});
    uploaded.resize(list.indices.size(), 0xFFFFFFFFu);
    for (const Range& r : list.changed_indices)
      std::copy_n(list.indices.begin() + r.first, r.count, uploaded.begin() + r.first);
    for (const Range& r : list.draws)
      for (std::uint32_t i = r.first; i < r.first + r.count; ++i)
        ASSERT_EQ(uploaded[i], list.indices[i]) << frame;
  }
}

}  // namespace
}  // namespace cuesta
