/// The byte budget is hard, the cut stays whole without pages, and scales are monotone.

#include "runtime/page_cache.h"

#include <gtest/gtest.h>

#include <random>

#include "apps/verify/cut_shape.h"
#include "hierarchy/bounding_sphere.h"
#include "hierarchy/page_codec.h"
#include "tests/hierarchy/seam_groups.h"
#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

/// Bytes of the base page, and of all pages.
std::pair<std::uint64_t, std::uint64_t> resident_range(const std::filesystem::path& path) {
  const auto cut = open_cut(path);
  const std::uint64_t base = cut->cache().resident_bytes();
  return {base, cut->settle(ErrorScale::uniform(cut->directory().grid), -1, {}).resident_bytes};
}

TEST(PageCache, random_flights_never_exceed_the_budget) {
  TemporaryFolder folder;
  build_file(bumpy_sphere(40), folder / "a.cuesta");
  const auto [base, all] = resident_range(folder / "a.cuesta");
  for (const double share : {0.02, 0.2, 0.5, 0.9}) {
    const std::uint64_t budget = base + static_cast<std::uint64_t>(share * static_cast<double>(all - base));
    const auto cut = open_cut(folder / "a.cuesta", budget);
    ASSERT_TRUE(cut);
    std::mt19937 random(11);
    int bound = 0;
    for (int frame = 0; frame < 200; ++frame) {
      const View view = random_view(cut->directory(), random);
      const auto report = cut->adapt(ErrorScale::perspective(cut->directory().grid, view, 4), 0.5, {});
      bound += report.bound_by == Binding::resident_bytes;
      ASSERT_LE(report.resident_bytes, budget) << "seed 11, frame " << frame;
      std::uint64_t charged = 0, real = 0;
      for (PageId id : cut->cache().resident_ids()) {
        const PageEntry& e = cut->directory().pages[id];
        charged += cut->cache().charge(id);
        real += cut->cache().resident(id)->bytes() +
                GeometryPool::page_bytes(e.owned_vertices, e.owned_triangles, cut->directory().has_texcoords);
      }
      ASSERT_EQ(charged, report.resident_bytes);
      ASSERT_LE(real, charged);
    }
    EXPECT_GT(bound, 0);
  }
}

/// I1: a missing page or an exhausted budget costs quality, never a hole.
TEST(PageCache, crack_free_whatever_is_resident) {
  TemporaryFolder folder;
  build_file(faceted_cube(24), folder / "a.cuesta");
  const auto [base, all] = resident_range(folder / "a.cuesta");
  const auto cut = open_cut(folder / "a.cuesta", base + (all - base) / 3);
  std::mt19937 random(12);
  for (int frame = 0; frame < 100; ++frame) {
    const View view = random_view(cut->directory(), random);
    cut->adapt(ErrorScale::perspective(cut->directory().grid, view), 0.5, {});
    const DrawList list = cut->draw_list();
    std::vector<Vec3i> positions;
    for (const DrawVertex& v : list.vertices) positions.push_back({v.x, v.y, v.z});
    std::vector<verify::Triangle> triangles;
    for (const Range& r : list.draws)
      for (std::uint32_t i = r.first; i < r.first + r.count; i += 3)
        triangles.push_back({list.indices[i], list.indices[i + 1], list.indices[i + 2]});
    const verify::SurfaceShape shape(seam_groups(positions, triangles), triangles);
    for (const auto& component : shape.components())
      ASSERT_EQ(component.border_edges, 0u) << "seed 12, frame " << frame;
  }
}

/// Also when only the finer page is wanted, as the directory of a damaged file may make it look.
TEST(PageCache, a_page_is_not_evicted_for_the_page_that_leans_on_it) {
  TemporaryFolder folder;
  build_file(bumpy_sphere(24), folder / "a.cuesta");
  const auto cache = PageCache::open(CuestaFile::open(folder / "a.cuesta").value(), unlimited).value();
  const auto& pages = cache->directory().pages;
  ASSERT_NE(pages[0].coarser[0], cache->directory().base());
  std::vector<std::uint8_t> needed(pages.size(), 0);
  needed[0] = 1;
  for (PageId id = 0; id < pages.size(); ++id)
    for (PageId c : pages[id].coarser) needed[c] |= needed[id];
  for (PageId id = cache->directory().base(); --id > 0;)
    if (needed[id]) {
      ASSERT_TRUE(cache->request(id, 1));
      ASSERT_EQ(cache->take_in(1, unlimited), 1u);
    }
  const std::size_t residents = cache->resident_ids().size();
  cache->set_budget_bytes(cache->resident_bytes());
  EXPECT_FALSE(cache->request(0, 2));
  EXPECT_EQ(cache->resident_ids().size(), residents);
}

/// 40,000 substitutions that each carry 1,000 triangles along: a small page that would take gigabytes if they
/// were more.
TEST(PageCache, a_script_that_explodes_is_refused) {
  constexpr std::uint32_t triangles = 1000, moves = 40000;
  Page page;
  page.base = true;
  page.vertex_count = 2 * triangles + 1 + moves;
  for (std::uint32_t t = 0; t < triangles; ++t) page.triangles.push_back({0, 2 * t + 1, 2 * t + 2});
  for (std::uint32_t i = 0, vertex = 0; i < moves; ++i) {
    const std::uint32_t target = 2 * triangles + 1 + i;
    page.script.fans.push_back({target, i, 1, {}});
    page.script.children.push_back({vertex, target, 1});
    vertex = target;
  }
  page.owned.positions.resize(page.vertex_count);
  const auto decoded = decode_page(encode_page(page), {});
  ASSERT_FALSE(decoded);
  EXPECT_EQ(decoded.error().code, ErrorCode::corrupt);
  GeometryPool pool({1000, 10}, false);
  const auto run = pool.add(page.vertex_count, triangles);
  const auto resident = ResidentPage::create(0, page, {}, pool, run, pool.run(run));
  ASSERT_FALSE(resident);
  EXPECT_EQ(resident.error().code, ErrorCode::corrupt);
}

TEST(PageCache, base_page_larger_than_the_budget) {
  TemporaryFolder folder;
  build_file(bumpy_sphere(10), folder / "a.cuesta");
  auto cache = PageCache::open(CuestaFile::open(folder / "a.cuesta").value(), 100);
  ASSERT_FALSE(cache);
  EXPECT_EQ(cache.error().code, ErrorCode::out_of_budget);
}

TEST(PageCache, an_unreadable_page_is_drawn_coarser) {
  TemporaryFolder folder;
  build_file(bumpy_sphere(24), folder / "a.cuesta");
  std::string bytes = bytes_of(folder / "a.cuesta");
  bytes[CuestaFile::open(folder / "a.cuesta")->directory().pages[0].block.offset + 50] ^= 4;
  put_bytes(folder / "a.cuesta", bytes);
  const auto cut = open_cut(folder / "a.cuesta");
  const auto report = cut->settle(ErrorScale::uniform(cut->directory().grid), -1, {});
  EXPECT_TRUE(report.settled);
  EXPECT_EQ(cut->cache().errors().size(), 1u);
  EXPECT_LT(report.triangles, cut->directory().triangles);
  EXPECT_GT(report.achieved, 0);
}

/// A sphere inside another never has the smaller scale, nor a page inside another the smaller factor.
TEST(ErrorScale, monotone_for_nested_spheres) {
  std::mt19937 random(13);
  const auto unit = [&random] { return static_cast<float>(random() >> 8) / (1 << 24); };
  const Grid grid{{-3, 5, 100}, 0.25};
  for (int i = 0; i < 20000; ++i) {
    View view;
    view.eye = {400.0 * unit(), 400.0 * unit(), 400.0 * unit()};
    view.target = view.eye + Vec3d{unit() - 0.5, unit() - 0.5, unit() - 0.45};
    view.width_px = 100 + static_cast<int>(random() % 4000);
    const auto scale = ErrorScale::perspective(grid, view, 1 + 7.0 * (i % 2));
    const Vec3i at{static_cast<int>(random() % 2000), static_cast<int>(random() % 2000),
                   static_cast<int>(random() % 2000)};
    const Sphere inner{vec_cast<float>(at) + Vec3f{unit(), unit(), unit()} * 50.0f, 40 * unit() * unit()};
    const Sphere outer = decode_sphere(enclose(std::span(&inner, 1), at), at);
    ASSERT_TRUE(contains(outer, inner));
    ASSERT_LE(scale.scale(outer), scale.scale(inner)) << "seed 13, case " << i;
    ASSERT_LE(scale.page_factor(outer), scale.page_factor(inner)) << "seed 13, case " << i;
    ASSERT_LE(scale.invisible(outer), scale.invisible(inner)) << "seed 13, case " << i;
    ASSERT_GE(scale.sse(2, outer), scale.sse(1, inner));
  }
}

TEST(ErrorScale, by_hand) {
  const Grid grid{{0, 0, 0}, 0.5};
  EXPECT_DOUBLE_EQ(ErrorScale::uniform(grid).sse(3, {}), 1.5);
  View view;  // at the origin, along -z, 720 pixels for 60 degrees
  const auto scale = ErrorScale::perspective(grid, view);
  // One grid unit at 90 grid units: k / 90 pixels.
  EXPECT_NEAR(scale.sse(1, {{0, 0, -100}, 10}), view.pixels_per_unit() / 90, 1e-9);
  EXPECT_EQ(scale.sse(0, {{0, 0, 0}, 10}), 0);
  // The eye in the sphere: as from the nearest distance at which anything is drawn.
  EXPECT_NEAR(scale.sse(1, {{0, 0, 5}, 10}), view.pixels_per_unit() / ErrorScale::nearest, 1e-9);
}

}  // namespace
}  // namespace cuesta::test
