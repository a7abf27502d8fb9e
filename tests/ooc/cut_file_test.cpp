/// Files that become shorter while they are read: every reader ends with an error that says so, none with
/// SIGBUS.

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <zlib.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <functional>
#include <thread>

#include "ooc/mapped_file.h"
#include "ooc/mesh_writer.h"
#include "ooc/read_job.h"
#include "tests/ooc/gltf_files.h"
#include "tests/ooc/mesh_files.h"
#include "tests/ooc/small_meshes.h"

namespace cuesta {
namespace {

constexpr const char* shorter = "the file became shorter while it was read";

void cut(const std::filesystem::path& path, std::uintmax_t bytes = 0) {
  std::filesystem::resize_file(path, bytes);
}

/// Does something when the first block comes.
class CuttingSink : public MeshSink {
 public:
  explicit CuttingSink(std::function<void()> once) : once_(std::move(once)) {}
  Result<void> vertices(const VertexBlock&) override { return act(); }
  Result<void> triangles(TriangleBlock) override { return act(); }

 private:
  Result<void> act() {
    if (once_) std::exchange(once_, {})();
    return ++blocks_ < 10'000 ? Result<void>{} : fail(ErrorCode::cancelled, "", "", "enough for a test");
  }
  std::function<void()> once_;
  int blocks_ = 0;
};

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string obj_text(int n) {
  const SurfaceMesh mesh = test::wavy_patch(n);
  std::string text;
  for (const Vec3d& p : mesh.positions)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (const auto& t : mesh.triangles)
    text += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " +
            std::to_string(t[2] + 1) + "\n";
  return text;
}

std::string off_text(int n) {
  const SurfaceMesh mesh = test::wavy_patch(n);
  std::string text =
      "OFF\n" + std::to_string(mesh.positions.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n";
  for (const Vec3d& p : mesh.positions)
    text += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (const auto& t : mesh.triangles)
    text += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return text;
}

std::string stl_text(int n) {
  const SurfaceMesh mesh = test::wavy_patch(n);
  std::string text = "solid s\n";
  for (const auto& t : mesh.triangles) {
    text += "facet normal 0 0 1\nouter loop\n";
    for (const std::uint32_t v : t) {
      const Vec3d& p = mesh.positions[v];
      text += "vertex " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
    }
    text += "endloop\nendfacet\n";
  }
  return text + "endsolid s\n";
}

std::string stl_bytes(int n) {
  const SurfaceMesh mesh = test::wavy_patch(n);
  std::string bytes(80, ' ');
  bytes += test::bytes_of<std::uint32_t>({static_cast<std::uint32_t>(mesh.triangles.size())});
  for (const auto& t : mesh.triangles) {
    std::vector<float> values(3);
    for (const std::uint32_t v : t)
      for (int k = 0; k < 3; ++k) values.push_back(static_cast<float>(mesh.positions[v][k]));
    bytes += test::bytes_of(values) + std::string(2, '\0');
  }
  return bytes;
}

std::string draco_bytes(const SurfaceMesh& mesh) {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(static_cast<int>(mesh.triangles.size()));
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vec3f, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = vec_cast<float>(mesh.positions[mesh.triangles[t][k]]);
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(t), &p[0], &p[1], &p[2]);
  }
  draco::Encoder encoder;
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*builder.Finalize(), &buffer).ok());
  return {buffer.data(), buffer.size()};
}

std::string gzip_bytes(const std::filesystem::path& path, const std::string& bytes) {
  gzFile file = gzopen(path.c_str(), "wb1");
  EXPECT_EQ(gzwrite(file, bytes.data(), static_cast<unsigned>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(gzclose(file), Z_OK);
  return text_of(path);
}

struct Format {
  const char* name;
  Result<ReadReport> (*read)(const ReadJob&);  ///< none where only read_mesh() can
  std::string bytes;
};

/// More than one block of vertices, so that something is read after the first.
std::vector<Format> formats() {
  const int n = 300;
  const test::ScratchFolder folder;
  const SurfaceMesh mesh = test::wavy_patch(n);
  const auto written = [&](const char* name) {
    EXPECT_TRUE(write_mesh(folder / name, mesh));
    return text_of(folder / name);
  };
  return {{"a.ply", read_ply, written("a.ply")},
          {"a.obj", read_obj, obj_text(n)},
          {"a.off", read_off, off_text(n)},
          {"text.stl", read_stl_ascii, stl_text(n)},
          {"a.stl", read_stl_binary, stl_bytes(n)},
          {"a.glb", read_gltf, written("a.glb")},
          {"a.drc", read_draco, draco_bytes(mesh)},
          {"a.obj.gz", nullptr, gzip_bytes(folder / "a.obj.gz", obj_text(n))}};
}

/// Nothing looks at the file between the cut and the next page that is read, as when both happen at once.
TEST(CutFile, EveryReaderGoesOnOverZerosAndTheMapTells) {
  for (const Format& format : formats()) {
    if (!format.read) continue;
    for (const double part : {0.0, 0.3, 0.8}) {
      SCOPED_TRACE(format.name + std::string(" at ") + std::to_string(part));
      const test::ScratchFolder folder;
      const auto path = folder.write(format.name, format.bytes);
      const auto left = static_cast<std::uintmax_t>(part * static_cast<double>(format.bytes.size()));
      for (const bool is_first : {true, false}) {
        folder.write(format.name, format.bytes);
        auto file = MappedFile::open(path);
        ASSERT_TRUE(file);
        ReadBudget budget(test::test_memory);
        const ReadProgress none;
        CuttingSink sink([&] { cut(path, left); });
        const ReadJob job{path, file->bytes(), sink, budget, none, {}};
        if (is_first) cut(path, left);
        static_cast<void>(format.read(job));  // of no meaning
        EXPECT_TRUE(file->has_faulted() || !is_first || part > 0);
        const auto unchanged = file->check_unchanged();
        ASSERT_FALSE(unchanged);
        EXPECT_EQ(unchanged.error().code, ErrorCode::io);
        EXPECT_NE(unchanged.error().text().find(shorter), std::string::npos) << unchanged.error().text();
      }
    }
  }
}

TEST(CutFile, ReadMeshTellsTheFileAndThatItBecameShorter) {
  for (const Format& format : formats()) {
    SCOPED_TRACE(format.name);
    const test::ScratchFolder folder;
    const auto path = folder.write(format.name, format.bytes);
    CuttingSink sink([&] { cut(path, format.bytes.size() / 2); });
    const auto report = read_mesh(path, sink, test::test_memory);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::io);
    EXPECT_EQ(report.error().file, path.string());
    EXPECT_NE(report.error().text().find(shorter), std::string::npos) << report.error().text();
  }
}

/// Whenever it happens: the whole mesh or the error.
TEST(CutFile, AnotherThreadMayCutAtAnyTime) {
  int failed = 0;
  for (const Format& format : formats()) {
    for (int delay_us = 0; delay_us < 4000; delay_us += 250) {
      SCOPED_TRACE(format.name + std::string(" after ") + std::to_string(delay_us));
      const test::ScratchFolder folder;
      const auto path = folder.write(format.name, format.bytes);
      std::atomic<bool> begun{false};
      std::thread other([&] {
        while (!begun) std::this_thread::yield();
        std::this_thread::sleep_for(std::chrono::microseconds(delay_us));
        cut(path);
      });
      const auto begin = [&](std::uint64_t, std::uint64_t) { return begun = true; };
      const auto mesh = load_mesh(path, test::test_memory, nullptr, begin);
      begun = true;
      other.join();
      if (mesh) {
        EXPECT_EQ(mesh->triangles.size(), 2u * 300 * 300);
        continue;
      }
      ++failed;
      EXPECT_EQ(mesh.error().code, ErrorCode::io) << mesh.error().text();
      EXPECT_EQ(mesh.error().file, path.string());
    }
  }
  EXPECT_GT(failed, 0);
}

TEST(CutFile, BuffersOfGltfAreWatchedToo) {
  const std::size_t vertices = 90'000;  // more than a block
  std::vector<float> positions(3 * vertices);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i % 7);
  const std::string bytes = test::bytes_of(positions);
  const std::string count = std::to_string(vertices), size = std::to_string(bytes.size());
  const std::string json =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + size +
      R"(,"uri":"b.bin"}],"bufferViews":[{"buffer":0,"byteLength":)" + size +
      R"(}],"accessors":[{"bufferView":0,"componentType":5126,"count":)" + count +
      R"(,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})";
  const test::ScratchFolder folder;
  const auto path = folder.write("a.gltf", json), buffer = folder.write("b.bin", bytes);
  CuttingSink sink([&] { cut(buffer); });
  const auto report = read_mesh(path, sink, test::test_memory);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::io);
  EXPECT_EQ(report.error().file, buffer.string());
}

/// OpenVDB has a map of its own.
TEST(CutFile, VolumesAreReadToTheErrorToo) {
  openvdb::initialize();
  const test::ScratchFolder folder;
  const auto path = folder / "v.vdb";
  const auto save = [&] {
    auto grid =
        openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(20.0f, openvdb::Vec3f(0, 0, 0), 0.25f);
    openvdb::io::File file(path.string());
    file.write({grid});
  };
  for (const bool is_watched : {true, false}) {
    save();
    auto file = MappedFile::open(path);
    ASSERT_TRUE(file);
    ReadBudget budget(test::test_memory);
    const ReadProgress none;
    CuttingSink sink([&] { cut(path); });
    ReadJob job{path, file->bytes(), sink, budget, none, {}};
    job.volume.block_voxels = 16;
    if (is_watched) job.file = &*file;
    const auto report = read_vdb(job);
    ASSERT_FALSE(report);
    EXPECT_EQ(report.error().code, ErrorCode::io) << report.error().text();
    EXPECT_EQ(report.error().file, path.string());
    EXPECT_FALSE(file->check_unchanged());
  }
}

TEST(CutFile, WhatIsReadWholeHasNoZeros) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a", std::string(100'000, 'x'));
  auto file = MappedFile::open(path);
  ASSERT_TRUE(file);
  MappedFile moved = std::move(*file);
  EXPECT_EQ(std::count(moved.bytes().begin(), moved.bytes().end(), 'x'), 100'000);
  EXPECT_FALSE(moved.has_faulted());
  EXPECT_TRUE(moved.check_unchanged());
  cut(path, 50'000);
  EXPECT_EQ(moved.bytes()[99'000], '\0');
  EXPECT_EQ(moved.bytes()[0], 'x');
  EXPECT_TRUE(moved.has_faulted());
  moved.release(moved.bytes().data(), moved.bytes().data() + 100'000);
  EXPECT_EQ(moved.bytes()[99'000], '\0');
  folder.write("a", std::string(100'000, 'y'));  // as long again: what was read is wrong still
  const auto unchanged = moved.check_unchanged();
  ASSERT_FALSE(unchanged);
  EXPECT_EQ(unchanged.error().code, ErrorCode::io);
}

TEST(CutFileDeathTest, OtherFaultsEndTheProcessAsEver) {
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  const test::ScratchFolder folder;
  const auto guarded = MappedFile::open(folder.write("a", "x"));
  ASSERT_TRUE(guarded);
  EXPECT_EXIT(::raise(SIGBUS), testing::KilledBySignal(SIGBUS), "");
}

}  // namespace
}  // namespace cuesta
