#include "runtime/part_store.h"

#include <set>

#include "runtime/index_cache.h"
#include "tests/runtime/small_scene.h"

namespace cuesta::test {
namespace {

std::unique_ptr<SmallScene> balls(std::uint32_t count, std::uint32_t rings = 16) {
  auto scene = std::make_unique<SmallScene>();
  for (std::uint32_t i = 0; i < count; ++i) scene->add_part(bumpy_ball(rings + i, 24));
  return scene;
}

/// Wishes for all, until nothing changes.
StoreReport settle(PartStore& store, std::uint32_t parts, double triangles) {
  StoreReport report;
  for (int i = 0; i < 100; ++i) {
    for (std::uint32_t p = 0; p < parts; ++p) store.want(p, triangles, 1 + p);
    report = store.update();
    store.wait();
    EXPECT_EQ(report.resident_bytes, store.resident_bytes());
  }
  return report;
}

TEST(PartStore, LoadsWhatIsWantedAndNoMore) {
  const auto scene = balls(3);
  PartStore store(scene->directory.parts, scene->reader(), 1 << 30, 1);
  EXPECT_EQ(store.tom(0), nullptr);
  store.want(1, 1, 1);
  store.update();
  store.wait();
  store.want(1, 1, 1);
  EXPECT_EQ(store.update().loaded, 1u);
  EXPECT_EQ(store.tom(0), nullptr);
  ASSERT_NE(store.tom(1), nullptr);
  EXPECT_EQ(store.tom(1)->full(), scene->directory.parts[1].segments[0].vertices);
  settle(store, 3, 1e9);
  for (std::uint32_t p = 0; p < 3; ++p) EXPECT_EQ(store.tom(p)->full(), scene->toms[p].full());
}

TEST(PartStore, FirstSegmentsComeFirst) {
  const auto scene = balls(6);
  PartStore store(scene->directory.parts, scene->reader(), 1 << 30, 0);
  for (std::uint32_t p = 0; p < 6; ++p) store.want(p, 1e9, p == 0 ? 1e-9 : 1);
  store.update();
  for (std::uint32_t p = 0; p < 6; ++p) store.want(p, 1e9, 1);
  store.update();
  for (std::uint32_t p = 0; p < 6; ++p) EXPECT_NE(store.tom(p), nullptr) << p;
}

TEST(PartStore, WhatIsNotAtHandIsReadWhenItHasCome) {
  const auto scene = balls(3);
  std::set<std::uint32_t> here;
  int asked = 0;
  const auto at_hand = [&](std::uint32_t part, std::uint32_t have, std::uint32_t segments) {
    EXPECT_EQ(segments, have + 1);
    asked += !here.contains(part);
    return here.contains(part);
  };
  PartStore store(scene->directory.parts, scene->reader(), 1 << 30, 0, at_hand);
  EXPECT_EQ(settle(store, 3, 1e9).missing, 3u);
  EXPECT_GT(asked, 3);
  here = {1};
  EXPECT_EQ(settle(store, 3, 1e9).missing, 2u);
  EXPECT_EQ(store.tom(0), nullptr);
  EXPECT_EQ(store.tom(1)->full(), scene->toms[1].full());
  here = {0, 1, 2};
  EXPECT_EQ(settle(store, 3, 1e9).missing, 0u);
  EXPECT_EQ(store.tom(2)->full(), scene->toms[2].full());
  EXPECT_TRUE(store.errors().empty());
}

TEST(PartStore, NeverExceedsItsBytes) {
  const auto scene = balls(8);
  const std::uint64_t budget = bytes_of_all(*scene) / 3;
  for (const std::uint32_t threads : {0u, 2u}) {
    PartStore store(scene->directory.parts, scene->reader(), budget, threads);
    for (int frame = 0; frame < 200; ++frame) {
      for (std::uint32_t p = 0; p < 8; ++p)
        if ((p + static_cast<std::uint32_t>(frame) / 20) % 3 == 0) store.want(p, 1e9, p);
      ASSERT_LE(store.update().resident_bytes, budget);
      if (frame % 3 == 0) store.wait();
    }
    EXPECT_GT(store.resident_bytes(), budget / 4);
  }
}

TEST(PartStore, WhatIsNoLongerWantedMakesRoom) {
  const auto scene = balls(4);
  const std::uint64_t budget = size_bytes(scene->toms[3]) * 2 + 20'000;
  PartStore store(scene->directory.parts, scene->reader(), budget, 0);
  for (const std::uint32_t part : {0u, 3u, 1u, 2u}) {
    for (int i = 0; i < 20; ++i) {
      store.want(part, 1e9, 1);
      store.update();
    }
    ASSERT_EQ(store.tom(part)->full(), scene->toms[part].full()) << part;
  }
}

TEST(PartStore, WhatIsWantedMoreMakesRoomForItself) {
  const auto scene = balls(2, 100);
  const std::uint64_t budget = size_bytes(scene->toms[1]) * 14 / 10;  // one whole and one quarter
  PartStore store(scene->directory.parts, scene->reader(), budget, 0);
  const auto frames = [&](double first, double second) {
    for (int i = 0; i < 30; ++i) {
      store.want(0, 1e9, first), store.want(1, 1e9, second);
      store.update();
    }
  };
  frames(10, 1);
  EXPECT_GT(store.tom(0)->full(), store.tom(1)->full());
  frames(1, 10);
  EXPECT_GT(store.tom(1)->full(), store.tom(0)->full());
  const std::uint32_t reads = scene->reads;
  frames(1, 1.5);
  EXPECT_EQ(scene->reads, reads) << "what is wanted about equally must not take turns";
}

TEST(PartStore, APartThatCannotBeReadIsDrawnCoarser) {
  const auto scene = balls(2);
  const PrefixReader good = scene->reader();
  PartStore store(
      scene->directory.parts,
      [&](std::uint32_t part, const Tom* have, std::uint32_t a, std::uint32_t b) -> Result<Tom> {
        if (part == 0 && b == 3) return fail(ErrorCode::corrupt, "scene", "part 0, segment 2", "damaged");
        return good(part, have, a, b);
      },
      1 << 30, 2);
  settle(store, 2, 1e9);
  EXPECT_EQ(store.tom(0)->full(), scene->directory.parts[0].segments[1].vertices);
  EXPECT_EQ(store.tom(1)->full(), scene->toms[1].full());
  ASSERT_EQ(store.errors().size(), 1u);
  EXPECT_EQ(store.errors()[0].place, "part 0, segment 2");
}

TEST(IndexCache, GivesTheTrianglesOfTheResolution) {
  SmallScene scene;
  scene.add_part(bumpy_ball(20, 30));
  const Tom& tom = scene.toms[0];
  IndexCache cache(0);
  cache.begin_frame();
  for (Resolution n = tom.base_vertices; n <= tom.full(); n += 37) {
    const auto block = cache.get(0, tom, n, 1'000'000);
    std::vector<Triangle> expected(triangle_count(tom, n));
    extract_triangles(tom, n, expected);
    ASSERT_EQ(block->triangles, expected) << n;
    ASSERT_EQ(cache.get(0, tom, n, 0), block) << "shared";
  }
}

TEST(IndexCache, OverItsTrianglesItGivesWhatIsThere) {
  SmallScene scene;
  scene.add_part(bumpy_ball(20, 30));
  const Tom& tom = scene.toms[0];
  IndexCache cache(1 << 20);
  cache.begin_frame();
  const auto coarse = cache.get(0, tom, tom.full() / 4, 1'000'000);
  cache.begin_frame();
  EXPECT_EQ(cache.get(0, tom, tom.full(), 10), coarse);
  EXPECT_EQ(cache.extracted_triangles(), 0u);
  EXPECT_EQ(cache.denied_triangles(), tom.triangles.size());
  EXPECT_EQ(cache.get(1, tom, tom.full(), 0)->resolution, tom.base_vertices) << "never nothing";
  EXPECT_EQ(cache.get(0, tom, tom.full(), 1'000'000)->resolution, tom.full());
}

TEST(IndexCache, ForgetsWhatIsNotUsed) {
  SmallScene scene;
  scene.add_part(bumpy_ball(20, 30));
  const Tom& tom = scene.toms[0];
  IndexCache cache(50'000);
  std::shared_ptr<const IndexBlock> kept;
  for (std::uint32_t frame = 0; frame < 200; ++frame) {
    cache.begin_frame();
    const auto now = cache.get(0, tom, tom.full(), 1'000'000);
    if (!kept) kept = now;
    ASSERT_EQ(now, kept) << "in use";
    cache.get(0, tom, tom.base_vertices + frame, 1'000'000);
    cache.end_frame();
    ASSERT_LE(cache.bytes(), 50'000 + 2 * 12 * tom.triangles.size());
  }
}

TEST(RungTriangles, AreEightToAnOctave) {
  EXPECT_EQ(rung_triangles(1000, 1000), 1000);
  EXPECT_EQ(rung_triangles(500, 1000), 500);
  EXPECT_NEAR(rung_triangles(999, 1000), 1000 * std::exp2(-1.0 / 8), 1e-9);
  for (double t = 1; t < 1000; t *= 1.07) {
    EXPECT_LE(rung_triangles(t, 1000), t * (1 + 1e-9));
    EXPECT_GT(rung_triangles(t, 1000), t / 1.0906);
  }
}

}  // namespace
}  // namespace cuesta::test
