#include "runtime/geometry_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

namespace cuesta {
namespace {

DrawList list_of(GeometryPool& pool, std::span<const GeometryPool::RunId> runs) {
  const std::vector<PageId> pages(runs.size(), 0);
  return pool.draw_list({}, runs, pages);
}

TEST(BlockAllocator, never_hands_out_a_number_twice) {
  std::mt19937 engine(1);
  const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
  constexpr std::uint32_t capacity = 200;
  BlockAllocator allocator(capacity);
  std::vector<std::vector<std::uint32_t>> held;
  std::set<std::uint32_t> used;
  for (int i = 0; i < 4000; ++i) {
    const std::uint32_t count = random() % 20;
    if (random() % 2 && count <= allocator.free()) {
      held.push_back(allocator.allocate(count));
      ASSERT_EQ(held.back().size(), count);
      ASSERT_TRUE(std::is_sorted(held.back().begin(), held.back().end()));
      for (const std::uint32_t n : held.back()) {
        ASSERT_LT(n, capacity);
        ASSERT_TRUE(used.insert(n).second) << "step " << i;
      }
    } else if (!held.empty()) {
      const std::size_t victim = random() % held.size();
      allocator.release(held[victim]);
      for (const std::uint32_t n : held[victim]) used.erase(n);
      held[victim] = held.back();
      held.pop_back();
    }
    ASSERT_EQ(allocator.free(), capacity - used.size());
  }
  for (const auto& numbers : held) allocator.release(numbers);
  EXPECT_EQ(allocator.allocate(capacity).size(), capacity) << "free neighbours were not joined";
}

/// What is free in pieces can be had as a whole.
TEST(BlockAllocator, scattered_numbers_are_as_good) {
  BlockAllocator allocator(10);
  const auto all = allocator.allocate(10);
  allocator.release(std::vector<std::uint32_t>{1, 2, 5, 9});
  EXPECT_EQ(allocator.allocate(2), (std::vector<std::uint32_t>{1, 2}));
  EXPECT_EQ(allocator.allocate(2), (std::vector<std::uint32_t>{5, 9}));
  EXPECT_EQ(allocator.free(), 0u);
}

/// Against a plain model: which triangles are active, and what their corners are.
TEST(GeometryPool, active_triangles_are_drawn_once_with_their_corners) {
  using Corners = std::array<std::uint32_t, 3>;
  std::mt19937 engine(2);
  const auto random = [&engine] { return static_cast<std::uint32_t>(engine()); };
  GeometryPool pool({40, 40}, false);
  struct PageModel {
    GeometryPool::RunId run;
    std::vector<std::uint32_t> blocks;
    std::vector<Corners> corners;
    std::vector<bool> active;
    TriangleHandle handle(std::size_t t) const {
      return GeometryPool::number(blocks, static_cast<std::uint32_t>(t));
    }
  };
  std::vector<PageModel> pages;
  for (int step = 0; step < 3000; ++step) {
    if (pages.size() < 3 || random() % 200 == 0) {
      const std::uint32_t triangles = random() % 700;
      PageModel page{pool.add(random() % 50, triangles),
                     {},
                     std::vector<Corners>(triangles),
                     std::vector<bool>(triangles)};
      page.blocks = pool.run(page.run).triangle_blocks;
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
    page.corners[t][c] = slot;
    for (std::uint32_t k = 0; k < 3; ++k) pool.set_corner(page.handle(t), k, page.corners[t][k]);
    page.active[t] ? pool.deactivate(page.handle(t)) : pool.activate(page.handle(t));
    page.active[t] = !page.active[t];
    if (step % 50 != 0) continue;
    std::multiset<Corners> expected, drawn;
    std::vector<GeometryPool::RunId> runs;
    for (const PageModel& p : pages) {
      runs.push_back(p.run);
      for (std::size_t i = 0; i < p.corners.size(); ++i) {
        EXPECT_EQ(pool.active(p.handle(i)), p.active[i]);
        if (p.active[i]) expected.insert(p.corners[i]);
      }
    }
    const DrawList list = list_of(pool, runs);
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
  GeometryPool pool({4, 5}, false);
  const auto gap = pool.add(0, 200);
  const auto other = pool.add(10, 200);
  pool.remove(gap);
  const auto run = pool.add(10, 1000);  // around the other one's block
  const auto handle = [blocks = pool.run(run).triangle_blocks](std::uint32_t t) {
    return GeometryPool::number(blocks, t);
  };
  ASSERT_EQ(handle(300), 2 * GeometryPool::block + 300 % GeometryPool::block);
  const std::array runs{other, run};
  std::vector<bool> active(1000);
  std::vector<std::uint32_t> uploaded;
  for (int frame = 0; frame < 200; ++frame) {
    for (std::uint32_t k = random() % 20; k > 0; --k) {
      const auto t = static_cast<std::uint32_t>(random() % 1000);
      pool.set_corner(handle(t), random() % 3, static_cast<std::uint32_t>(random() % 100));
      if (random() % 2) continue;
      active[t] ? pool.deactivate(handle(t)) : pool.activate(handle(t));
      active[t] = !active[t];
    }
    const std::uint64_t announced = pool.upload_bytes();
    const DrawList list = list_of(pool, runs);
    std::uint64_t bytes = 0;
    for (const Range& r : list.changed_indices) bytes += r.count * 4ull;
    ASSERT_LE(bytes, announced);
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
