/// Several files into one surface: order, offsets, attributes that only some have, and errors of one of them.

#include <cmath>
#include <string>
#include <vector>

#include "ooc/ingest.h"
#include "ooc/oct_normal.h"
#include "tests/ooc/grid_mesh.h"
#include "tests/ooc/mesh_files.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta {
namespace {

using Paths = std::vector<std::filesystem::path>;
using RawTriangle = std::array<std::uint64_t, 3>;

const std::string plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
const std::string coloured =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float nx\nproperty float ny\n"
    "property float nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "5 0 0 9 8 7 0 0 1\n6 0 0 9 8 7 0 0 1\n6 1 0 9 8 7 0 0 1\n5 1 0 9 8 7 0 0 1\n3 0 1 3\n";

/// Reads files as a build does: one after the other into one sink, each with the same memory.
Result<std::vector<ReadReport>> read_all(const Paths& paths, RawSurface& sink,
                                         std::uint64_t memory = test::test_memory) {
  std::vector<ReadReport> reports;
  for (const auto& path : paths) {
    sink.begin_input();
    const auto report = read_mesh(path, sink, memory);
    if (!report) return fail(report.error());
    reports.push_back(*report);
  }
  return reports;
}

/// Block after block, in numbers of the whole.
std::vector<RawTriangle> triangles_of(const RawSurface& raw) {
  std::vector<RawTriangle> out(raw.counts().triangles);
  for (std::uint32_t b = 0; b < raw.block_count(); ++b) {
    const std::uint64_t first = b * raw.block_vertices();
    for (const auto& t : records_of<LocalTriangle>(raw.local_triangles().read(b).value()))
      out.at(t.ordinal()) = {first + t.corners[0], first + t.corners[1], first + t.corners[2]};
    for (const auto& c : records_of<LocalCorner>(raw.local_corners().read(b).value()))
      out.at(c.slot() / 4).at(c.slot() % 4) = first + c.vertex;
  }
  return out;
}

RawVertices vertices_of(const RawSurface& raw) {
  RawVertices all;
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (std::uint32_t b = 0; b < raw.block_count(); ++b) {
    const RawVertices block = raw.block(b).value();
    add(all.positions, block.positions);
    add(all.normals, block.normals);
    add(all.colours, block.colours);
    add(all.texcoords, block.texcoords);
  }
  return all;
}

/// What is read, for blocks of all sizes: all triangles within one, none, and in between.
template <class Check>
void for_block_sizes(const Paths& paths, Check check) {
  for (const std::uint64_t block_vertices : {1, 2, 5, 1000}) {
    SCOPED_TRACE(block_vertices);
    const test::ScratchFolder folder;
    auto raw = RawSurface::create(folder / "", block_vertices);
    ASSERT_TRUE(raw) << raw.error().text();
    const auto reports = read_all(paths, *raw);
    ASSERT_TRUE(reports) << reports.error().text();
    ASSERT_TRUE(raw->finish());
    check(*raw, *reports);
    const auto again = RawSurface::open(folder / "", raw->encode());
    ASSERT_TRUE(again) << again.error().text();
    check(*again, *reports);
  }
}

TEST(Ingest, VerticesAndTrianglesFollowInOrder) {
  const test::ScratchFolder folder;
  const Paths paths{folder.write("a.obj", plain), folder.write("b.ply", coloured),
                    folder.write("c.obj", plain)};
  for_block_sizes(paths, [](const RawSurface& raw, const std::vector<ReadReport>& reports) {
    EXPECT_EQ(triangles_of(raw), (std::vector<RawTriangle>{{0, 1, 2}, {3, 4, 6}, {7, 8, 9}}));
    const RawVertices vertices = vertices_of(raw);
    ASSERT_EQ(vertices.positions.size(), 10u);
    EXPECT_EQ(vertices.positions[6], (Vec3d{5, 1, 0}));
    ASSERT_EQ(reports.size(), 3u);
    EXPECT_EQ(reports[1].vertices, 4u);
  });
}

TEST(Ingest, AttributesAnyFileHasAreKeptAndTheRestCounted) {
  const test::ScratchFolder folder;
  const auto a = folder.write("a.obj", plain), b = folder.write("b.ply", coloured);
  for (const Paths& paths : {Paths{a, b}, Paths{b, a}}) {
    for_block_sizes(paths, [&](const RawSurface& raw, const auto&) {
      const std::size_t without = paths[0] == a ? 0 : 4, with = paths[0] == a ? 3 : 0;
      const RawVertices vertices = vertices_of(raw);
      ASSERT_EQ(vertices.colours.size(), 7u);
      EXPECT_EQ(vertices.colours[without], (Rgba8{255, 255, 255, 255}));
      EXPECT_EQ(vertices.colours[without + 2], (Rgba8{255, 255, 255, 255}));
      EXPECT_EQ(vertices.colours[with], (Rgba8{9, 8, 7, 255}));
      ASSERT_EQ(vertices.normals.size(), 7u);
      EXPECT_EQ(decode_oct(vertices.normals[without + 2], normal_bits), Vec3f{});
      EXPECT_EQ(decode_oct(vertices.normals[with], normal_bits), (Vec3f{0, 0, 1}));
      EXPECT_TRUE(vertices.texcoords.empty());
      EXPECT_EQ(raw.counts().missing.normals, 3u);
      EXPECT_EQ(raw.counts().missing.colours, 3u);
      EXPECT_EQ(raw.counts().missing.texcoords, 0u);
      EXPECT_TRUE(raw.counts().has_missing_normals);
    });
  }
  for_block_sizes({b, b}, [](const RawSurface& raw, const auto&) {
    EXPECT_EQ(raw.counts().missing.normals + raw.counts().missing.colours, 0u);
    EXPECT_FALSE(raw.counts().has_missing_normals);
  });
}

/// Ingests in a folder of its own.
Result<test::GridMesh> ingested(const Paths& paths, IngestedSurface& surface, bool make_normals = true) {
  const test::ScratchFolder scratch;
  auto folder = WorkFolder::open(scratch / "work", "test");
  if (!folder) return fail(folder.error());
  MemoryBudget memory(test::test_memory);
  auto done = ingest(*folder, {.make_normals = make_normals, .chunk_triangles = 40}, memory,
                     [&](RawSurface& sink) { return read_all(paths, sink); });
  if (!done) return fail(done.error());
  surface = std::move(*done);
  return test::put_together(surface);
}

TEST(Ingest, MissingNormalsAreComputedOrLeftOut) {
  const test::ScratchFolder folder;
  const Paths paths{folder.write("a.obj", plain), folder.write("b.ply", coloured)};
  for (const bool make_normals : {true, false}) {
    IngestedSurface surface;
    const auto mesh = ingested(paths, surface, make_normals);
    ASSERT_TRUE(mesh) << mesh.error().text();
    EXPECT_EQ(surface.missing.normals, 3u);
    EXPECT_EQ(surface.inputs.size(), 2u);
    ASSERT_EQ(mesh->positions.size(), 6u);
    for (std::size_t v = 0; v < 6; ++v) {
      const bool given = mesh->grid.world(mesh->positions[v]).x > 3;
      EXPECT_EQ(mesh->normals[v], given || make_normals ? (Vec3f{0, 0, 1}) : Vec3f{}) << v;
      EXPECT_EQ(mesh->colours[v], given ? (Rgba8{9, 8, 7, 255}) : (Rgba8{255, 255, 255, 255})) << v;
    }
  }
}

std::string obj_of(const SurfaceMesh& mesh, std::size_t first, std::size_t end) {
  std::string text;
  for (const Vec3d& p : mesh.positions)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (std::size_t t = first; t < end; ++t) {
    text += "f";
    for (const std::uint32_t v : mesh.triangles[t]) text += " " + std::to_string(v + 1);
    text += "\n";
  }
  return text;
}

/// Where files meet, vertices weld: the same surface as from one file.
TEST(Ingest, SeveralFilesGiveTheSurfaceOfOne) {
  const SurfaceMesh mesh = test::wavy_patch(16);
  const std::size_t all = mesh.triangles.size();
  const test::ScratchFolder folder;
  const auto whole = folder.write("whole.obj", obj_of(mesh, 0, all));
  const auto one = folder.write("one.obj", obj_of(mesh, 0, all / 3));
  const auto two = folder.write("two.obj", obj_of(mesh, all / 3, all));
  IngestedSurface whole_surface, surface;
  const auto expected = ingested({whole}, whole_surface);
  const auto found = ingested({one, two}, surface);
  ASSERT_TRUE(expected && found);
  EXPECT_GT(surface.chunk_count(), 4u);
  EXPECT_EQ(surface.triangles, all);
  EXPECT_EQ(surface.vertices, mesh.positions.size());
  EXPECT_EQ(surface.box.lo, whole_surface.box.lo);
  EXPECT_EQ(surface.box.hi, whole_surface.box.hi);
  const auto points = [](const test::GridMesh& m) {
    std::vector<std::array<Vec3i, 3>> out;
    for (const auto& t : m.triangles) {
      out.push_back({m.positions[t[0]], m.positions[t[1]], m.positions[t[2]]});
      std::rotate(out.back().begin(), std::min_element(out.back().begin(), out.back().end()),
                  out.back().end());
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  EXPECT_EQ(points(*expected), points(*found));
}

TEST(Ingest, AnErrorOfOneInputIsTheirsAndTheFolderStaysOfUse) {
  const test::ScratchFolder scratch;
  const auto good = scratch.write("a.obj", plain);
  auto folder = WorkFolder::open(scratch / "work", "test");
  ASSERT_TRUE(folder);
  MemoryBudget memory(test::test_memory);
  const auto missing = ingest(*folder, {}, memory, [&](RawSurface& sink) {
    return read_all({good, scratch / "gone.ply"}, sink);
  });
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
  EXPECT_NE(missing.error().file.find("gone.ply"), std::string::npos);
  const auto surface = ingest(*folder, {}, memory, [&](RawSurface& sink) { return read_all({good}, sink); });
  ASSERT_TRUE(surface) << surface.error().text();
  EXPECT_EQ(surface->triangles, 1u);
  EXPECT_EQ(memory.used_bytes(), 0u);
}

/// What one reader held is given back before the next: any number of files in what one needs.
TEST(Ingest, ReadersOfManyFilesNeedTheMemoryOfOne) {
  std::string large;
  for (int i = 0; i < 20'000; ++i) large += "v 1 2 3\n";
  const test::ScratchFolder folder;
  const auto path = folder.write("a.obj", large + "f 1 2 3\n");
  auto raw = RawSurface::create(folder / "", 1000);
  ASSERT_TRUE(raw);
  const auto reports = read_all(Paths(40, path), *raw, 1 << 20);
  ASSERT_TRUE(reports) << reports.error().text();
  ASSERT_TRUE(raw->finish());
  EXPECT_EQ(raw->counts().triangles, 40u);
}

}  // namespace
}  // namespace cuesta
