/// Scenes built, opened, cut off and damaged.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <random>

#include "hierarchy/build_scene.h"
#include "hierarchy/page_positions.h"
#include "hierarchy/scene_file.h"
#include "hierarchy/scene_tom.h"
#include "hierarchy/verify_file.h"
#include "ooc/mesh_writer.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

struct SceneWith {
  std::uint64_t largest_tom = 3000;
  std::uint64_t memory_bytes = std::uint64_t{1} << 30;
};

Result<SceneBuildReport> try_scene(const std::filesystem::path& input, const std::filesystem::path& output,
                                   const SceneWith& with = {}, const BuildProgress& progress = {}) {
  auto source = open_scene(input, std::uint64_t{64} << 20);
  if (!source) return fail(source.error());
  auto folder = WorkFolder::open(output.string() + ".work", "test");
  if (!folder) return fail(folder.error());
  MemoryBudget memory(with.memory_bytes);
  SceneBuildOptions options;
  options.largest_tom = with.largest_tom;
  options.cell_triangles = 512;
  auto report = build_scene(**source, output, options, *folder, memory, progress);
  if (report) folder->remove();
  return report;
}

/// A folder with two equal spheres, a large one, a cube, and a file in which nothing is left after cleaning.
class SceneBuild : public testing::Test {
 protected:
  void SetUp() override {
    const auto write = [&](const char* name, const SurfaceMesh& mesh) {
      ASSERT_TRUE(write_mesh(folder_ / name, mesh));
    };
    std::filesystem::create_directories(folder_ / "in/more");
    write("in/ball.ply", bumpy_sphere(16));
    write("in/cube.ply", cube());
    write("in/large.ply", bumpy_sphere(24, {5, 0, 0}));
    write("in/more/ball2.ply", bumpy_sphere(16));
    write("in/flat.ply", mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 0}}));
  }
  void build() {
    const auto report = try_scene(folder_ / "in", folder_ / "a.cuesta");
    ASSERT_TRUE(report) << report.error().text();
    report_ = *report;
  }
  SceneFile open() {
    auto file = SceneFile::open(folder_ / "a.cuesta");
    EXPECT_TRUE(file) << file.error().text();
    return std::move(*file);
  }
  TemporaryFolder folder_;
  SceneBuildReport report_;
};

TEST_F(SceneBuild, stores_equal_parts_once_and_counts) {
  build();
  EXPECT_EQ(report_.parts_read, 5u);
  EXPECT_EQ(report_.parts_equal, 1u);
  EXPECT_EQ(report_.parts_empty, 1u);
  EXPECT_EQ(report_.toms, 2u);
  EXPECT_EQ(report_.surfaces, 1u);
  EXPECT_EQ(report_.instances, 4u);
  EXPECT_EQ(report_.triangles, 8u * 16 * 16 + 8 * 24 * 24 + 12);
  EXPECT_EQ(report_.instanced_triangles, report_.triangles + 8 * 16 * 16);
  const SceneFile file = open();
  EXPECT_EQ(file.file_bytes(), report_.file_bytes);
  EXPECT_EQ(file.parts().size(), 3u);
  EXPECT_EQ(file.instances().size(), 4u);
  EXPECT_EQ(file.nodes()[file.instances()[3].node].name, "ball2");
  EXPECT_EQ(file.instances()[3].part, file.instances()[0].part);
  const auto flat = std::find_if(file.nodes().begin(), file.nodes().end(),
                                 [](const SceneNode& n) { return n.name == "flat"; });
  ASSERT_NE(flat, file.nodes().end());
  EXPECT_EQ(flat->part, no_index);
  EXPECT_EQ(flat->material, no_index);
}

TEST_F(SceneBuild, toms_are_what_was_read) {
  build();
  const SceneFile file = open();
  const SurfaceMesh in = bumpy_sphere(16);
  const ScenePartEntry& entry = file.parts()[0];
  ASSERT_TRUE(entry.is_tom());
  ASSERT_GT(entry.segments.size(), 1u);
  for (std::uint32_t k = 1; k <= entry.segments.size(); ++k) {
    const auto tom = read_tom(file, 0, k);
    ASSERT_TRUE(tom) << tom.error().text();
    EXPECT_TRUE(is_consistent(*tom));
    EXPECT_EQ(tom->full(), entry.segments[k - 1].vertices);
  }
  const SurfaceMesh out = surface_at(*read_tom(file, 0, static_cast<std::uint32_t>(entry.segments.size())),
                                     static_cast<Resolution>(entry.vertices));
  EXPECT_EQ(out.triangles.size(), in.triangles.size());
  EXPECT_EQ(out.normals.size(), out.positions.size());
  const double reach = 1e-2;
  for (const Vec3d& p : in.positions) {
    double nearest = 1;
    for (const Vec3d& q : out.positions) nearest = std::min(nearest, length(p - q));
    EXPECT_LT(nearest, reach);
  }
}

TEST_F(SceneBuild, large_parts_are_surfaces_that_verify) {
  build();
  const SceneFile file = open();
  ASSERT_FALSE(file.parts()[2].is_tom());
  const auto surface = file.open_surface(2);
  ASSERT_TRUE(surface) << surface.error().text();
  EXPECT_GT(surface->directory().pages.size(), 1u);
  const auto report = verify_file(*surface);
  ASSERT_TRUE(report) << report.error().text();
  EXPECT_TRUE(report->ok());
  EXPECT_EQ(surface->directory().triangles, 8u * 24 * 24);
}

TEST_F(SceneBuild, same_bytes_for_any_threads_and_memory) {
  build();
  const std::string expected = bytes_of(folder_ / "a.cuesta");
  for (const std::size_t threads : {1, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    ASSERT_TRUE(try_scene(folder_ / "in", folder_ / "b.cuesta", {3000, std::uint64_t{256} << 20}));
    EXPECT_TRUE(bytes_of(folder_ / "b.cuesta") == expected) << threads << " threads";
  }
}

TEST_F(SceneBuild, goes_on_after_interruptions_with_the_same_bytes) {
  build();
  for (int stop = 1; stop < 60; stop += 7) {
    int calls = 0;
    const auto interrupted =
        try_scene(folder_ / "in", folder_ / "b.cuesta", {},
                  [&](std::string_view, std::uint64_t, std::uint64_t) { return ++calls < stop; });
    if (!interrupted) {
      EXPECT_EQ(interrupted.error().code, ErrorCode::cancelled);
      EXPECT_FALSE(std::filesystem::exists(folder_ / "b.cuesta"));
    }
    const auto done = try_scene(folder_ / "in", folder_ / "b.cuesta");
    ASSERT_TRUE(done) << done.error().text();
    EXPECT_TRUE(bytes_of(folder_ / "b.cuesta") == bytes_of(folder_ / "a.cuesta")) << stop;
    std::filesystem::remove(folder_ / "b.cuesta");
  }
}

TEST_F(SceneBuild, too_little_memory_is_told) {
  const auto report = try_scene(folder_ / "in", folder_ / "a.cuesta", {3000, 100'000});
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::out_of_budget);
}

TEST_F(SceneBuild, a_scene_without_triangles_is_refused) {
  std::filesystem::create_directories(folder_ / "none");
  std::filesystem::copy(folder_ / "in/flat.ply", folder_ / "none/flat.ply");
  const auto report = try_scene(folder_ / "none", folder_ / "a.cuesta");
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::invalid_input);
}

TEST_F(SceneBuild, the_other_kind_of_file_is_refused_by_name) {
  build();
  build_file(cube(), folder_ / "surface.cuesta");
  EXPECT_EQ(CuestaFile::open(folder_ / "a.cuesta").error().code, ErrorCode::invalid_input);
  EXPECT_NE(CuestaFile::open(folder_ / "a.cuesta").error().message.find("scene"), std::string::npos);
  EXPECT_EQ(SceneFile::open(folder_ / "surface.cuesta").error().code, ErrorCode::invalid_input);
  EXPECT_EQ(*ContainerReader::kind_of(folder_ / "a.cuesta"), ContainerKind::scene);
  EXPECT_EQ(*ContainerReader::kind_of(folder_ / "surface.cuesta"), ContainerKind::surface);
}

TEST_F(SceneBuild, a_prefix_is_a_scene_with_less_detail) {
  build();
  const std::string whole = bytes_of(folder_ / "a.cuesta");
  const SceneFile full = open();
  EXPECT_LT(report_.coarsest_bytes, report_.file_bytes / 2);
  bool had_all = false;
  for (std::size_t n = 0; n < whole.size(); n += n < report_.coarsest_bytes ? 13 : 997) {
    put_bytes(folder_ / "cut.cuesta", std::string_view(whole).substr(0, n));
    const auto file = SceneFile::open(folder_ / "cut.cuesta");
    if (!file) {
      EXPECT_EQ(file.error().code, ErrorCode::corrupt);
      EXPECT_LT(n, full.parts()[0].segments[0].block.offset);
      continue;
    }
    EXPECT_FALSE(file->is_whole());
    EXPECT_EQ(file->whole_bytes(), whole.size());
    bool has_all = true;
    for (std::uint32_t p = 0; p < file->parts().size(); ++p) {
      const std::uint32_t segments = file->available_segments(p);
      has_all &= segments > 0;
      if (!file->parts()[p].is_tom()) continue;
      if (segments > 0) {
        EXPECT_TRUE(read_tom(*file, p, segments));
      }
      if (segments < file->parts()[p].segments.size()) {
        EXPECT_FALSE(file->read_segment(p, segments));
      }
    }
    EXPECT_EQ(has_all, n >= report_.coarsest_bytes) << n;
    had_all |= has_all;
    if (has_all) {
      EXPECT_TRUE(file->open_surface(2)->read_page(file->open_surface(2)->directory().base(), {}));
    }
  }
  EXPECT_TRUE(had_all);
}

TEST_F(SceneBuild, damaged_bytes_are_errors) {
  build();
  const std::string whole = bytes_of(folder_ / "a.cuesta");
  std::mt19937 random(7);
  for (int i = 0; i < 400; ++i) {
    std::string bad = whole;
    const std::size_t at = i < 64 ? static_cast<std::size_t>(i) : random() % whole.size();
    bad[at] = static_cast<char>(bad[at] ^ (1 << (i % 8)));
    put_bytes(folder_ / "bad.cuesta", bad);
    const auto file = SceneFile::open(folder_ / "bad.cuesta");
    if (at < 64) {
      EXPECT_FALSE(file) << at;
    }
    if (!file) continue;
    for (std::uint32_t p = 0; p < file->parts().size(); ++p) {
      if (file->parts()[p].is_tom()) {
        const auto tom = read_tom(*file, p, static_cast<std::uint32_t>(file->parts()[p].segments.size()));
        EXPECT_TRUE(tom || tom.error().code == ErrorCode::corrupt);
      } else if (const auto surface = file->open_surface(p)) {
        PagePositions positions(*surface, std::uint64_t{1} << 26);
        for (PageId id = 0; id < surface->directory().pages.size(); ++id) {
          const auto survivors = positions.survivors(id);
          if (!survivors) continue;
          if (const auto page = surface->read_page(id, *survivors); !page) {
            EXPECT_NE(page.error().place.find("part 2, page"), std::string::npos);
          }
        }
      }
    }
  }
}

/// A directory with one of everything.
SceneDirectory small_directory() {
  SceneDirectory d;
  d.metadata = R"({"made for":"a test"})";
  d.scene.materials = {{"steel", {1, 2, 3, 4}, 0.5f, 0.25f, true}};
  d.scene.nodes = {{"root", no_index, no_index, no_index, Trs{{1, 2, 3}, {0, 0, 0, 1}, {1, 1, 2}}},
                   {"", 0, 0, 0, Affine{{Vec3d{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}, {10, 11, 12}}},
                   {"b", 0, 1, 0, Trs{}}};
  d.scene.clips = {{"c", {{0, AnimatedProperty::rotation, Interpolation::step, {0.5f}, {0, 0, 0, 1}}}}};
  d.parts.resize(2);
  d.parts[0].name = "tom";
  d.parts[0].box = {{0, 0, 0}, {1, 1, 1}};
  d.parts[0].vertices = 100;
  d.parts[0].triangles = 200;
  d.parts[0].attributes = {true, false, true};
  d.parts[0].segments = {{{0, 50, 1}, 10, 20, 0.5f}, {{0, 70, 2}, 100, 200, 0}};
  d.parts[1] = d.parts[0];
  d.parts[1].segments.clear();
  d.parts[1].surface = EmbeddedSurface{{0, 30, 3}, {0, 40, 4}, 0, 1000};
  return d;
}

TEST(SceneDirectoryBytes, round_trip_and_layout) {
  const SceneDirectory d = small_directory();
  const auto again = decode_scene_directory(encode_scene_directory(d), 200);
  ASSERT_TRUE(again) << again.error().text();
  EXPECT_EQ(again->scene, d.scene);
  EXPECT_EQ(again->metadata, d.metadata);
  ASSERT_EQ(again->parts.size(), 2u);
  EXPECT_EQ(again->parts[0].name, "tom");
  EXPECT_EQ(again->parts[0].attributes, d.parts[0].attributes);
  EXPECT_EQ(again->parts[0].segments[0].block, (BlockRef{256, 50, 1}));  // first of the first layer
  EXPECT_EQ(again->parts[1].surface->directory, (BlockRef{320, 30, 3}));
  EXPECT_EQ(again->parts[1].surface->base, (BlockRef{384, 40, 4}));
  EXPECT_EQ(again->parts[0].segments[1].block, (BlockRef{448, 70, 2}));  // second layer
  EXPECT_EQ(again->parts[1].surface->pages_offset, 576u);
  EXPECT_EQ(encode_scene_directory(*again), encode_scene_directory(d));
  EXPECT_EQ(coarsest_blocks(d), 3u);
}

TEST(SceneDirectoryBytes, cut_off_at_every_byte) {
  const auto bytes = encode_scene_directory(small_directory());
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(decode_scene_directory(std::span(bytes).first(n), 64)) << n;
}

TEST(SceneDirectoryBytes, contradictions_are_corrupt) {
  const auto is_refused = [](auto&& change) {
    SceneDirectory d = small_directory();
    change(d);
    const auto decoded = decode_scene_directory(encode_scene_directory(d), 64);
    return !decoded && decoded.error().code == ErrorCode::corrupt;
  };
  EXPECT_FALSE(is_refused([](SceneDirectory&) {}));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.scene.nodes[1].part = 2; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.scene.nodes[0].parent = 2; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.scene.clips[0].channels[0].node = 1; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].segments[0].vertices = 101; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].segments[1].triangles = 199; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].segments[1].error = 1; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].segments[0].block.bytes = 1ull << 47; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].box.lo.x = 2; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].box.hi.x = std::nan(""); }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[1].surface->pages_bytes = 1ull << 47; }));
  EXPECT_TRUE(is_refused([](SceneDirectory& d) { d.parts[0].segments.resize(65, d.parts[0].segments[1]); }));
}

}  // namespace
}  // namespace cuesta::test
