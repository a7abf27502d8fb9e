/// Damaged files: every one is read or refused with a message; none crashes, hangs or takes more than its
/// memory.

#include <fstream>
#include <sstream>

#include "ooc/mesh_writer.h"
#include "tests/ooc/gltf_files.h"
#include "tests/ooc/mesh_files.h"
#include "tests/shared_data.h"

namespace cuesta {
namespace {

constexpr std::uint64_t memory = std::uint64_t{64} << 20;

std::string bytes_of_file(const std::filesystem::path& path) {
  std::ostringstream out;
  out << std::ifstream(path, std::ios::binary).rdbuf();
  return out.str();
}

bool read_or_refused(const std::filesystem::path& path) {
  test::CheckingSink sink(2'000'000);
  const auto report = read_mesh(path, sink, memory);
  if (report) {
    sink.expect_in_range();
  } else {
    EXPECT_FALSE(report.error().message.empty()) << path;
    EXPECT_FALSE(report.error().file.empty()) << path;
  }
  return report.has_value();
}

/// Small files of each format, by name.
std::vector<std::pair<std::string, std::string>> small_files() {
  const test::ScratchFolder folder;
  SurfaceMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0.5}};
  mesh.normals = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
  mesh.colours = {{1, 2, 3, 255}, {255, 2, 3, 255}, {1, 255, 3, 255}, {1, 2, 255, 255}};
  mesh.texcoords = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  std::vector<std::pair<std::string, std::string>> files;
  for (const std::string name : {"a.ply", "a.obj", "a.glb"}) {
    EXPECT_TRUE(write_mesh(folder / name, mesh));
    files.emplace_back(name, bytes_of_file(folder / name));
  }
  files.emplace_back(
      "ascii.ply",
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2\n");
  files.emplace_back(
      "big.ply",
      "ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty list uchar short l\nproperty short x\n"
      "property short y\nproperty short z\nelement tristrips 1\nproperty list int int "
      "vertex_indices\nend_header\n" +
          std::string("\1\0\7\0\1\0\2\0\3\0\0\0\2\0\0\0\0\377\377\377\377", 21));
  files.emplace_back("a.off",
                     "COFF\n4 2 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n1 1 0 0 0 255 255\n0 1 0 1 1 1 "
                     "255\n4 0 1 2 3\n3 0 1 2\n");
  files.emplace_back("ascii.stl",
                     "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 "
                     "0\nendloop\nendfacet\nendsolid x\n");
  std::string stl(80, ' ');
  stl += std::string("\2\0\0\0", 4) + std::string(100, '\1');
  files.emplace_back("a.stl", stl);
  files.emplace_back("nodes.glb",
                     test::triangle_glb(R"([{"mesh":0,"children":[1]},{"mesh":0,"scale":[1,-1,1]}])",
                                        R"(,"scenes":[{"nodes":[0]}])"));
  files.emplace_back(
      "a.gltf",
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"data:;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
    "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})");
  return files;
}

TEST(MeshHostile, SmallFilesAreGoodToBeginWith) {
  const test::ScratchFolder folder;
  for (const auto& [name, bytes] : small_files())
    EXPECT_TRUE(read_or_refused(folder.write(name, bytes))) << name;
}

TEST(MeshHostile, TruncatedAtEveryByte) {
  const test::ScratchFolder folder;
  for (const auto& [name, bytes] : small_files()) {
    for (std::size_t n = 0; n < bytes.size(); ++n) read_or_refused(folder.write(name, bytes.substr(0, n)));
  }
}

TEST(MeshHostile, EveryByteChanged) {
  const test::ScratchFolder folder;
  for (const auto& [name, bytes] : small_files()) {
    for (std::size_t i = 0; i < std::min<std::size_t>(bytes.size(), 700); ++i) {
      for (const int change : {0x01, 0x80, 0xff}) {
        std::string flipped = bytes;
        flipped[i] = static_cast<char>(flipped[i] ^ change);
        read_or_refused(folder.write(name, flipped));
      }
    }
  }
}

TEST(MeshHostile, DracoTruncatedAndChanged) {
  CUESTA_NEED_SHARED(path, "mesh/kamakura_buddha_photogrammetry.drc");
  const std::string bytes = bytes_of_file(path);
  const test::ScratchFolder folder;
  for (std::size_t n = 0; n < 64; ++n) read_or_refused(folder.write("a.drc", bytes.substr(0, n)));
  for (std::size_t n = 1; n <= 8; ++n)
    read_or_refused(folder.write("a.drc", bytes.substr(0, bytes.size() * n / 9)));
  for (std::size_t i = 0; i < 40; ++i) {
    std::string flipped = bytes;
    flipped[i] = static_cast<char>(flipped[i] ^ 0xff);
    read_or_refused(folder.write("a.drc", flipped));
  }
}

TEST(MeshHostile, CollectionsOfBadFiles) {
  CUESTA_NEED_SHARED(path, "bad");
  const test::ScratchFolder folder;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(path)) {
    const std::string name = entry.path().filename().string();
    if (name.ends_with(".tar.gz")) {
      const auto target = folder / name.substr(0, name.size() - 7);
      std::filesystem::create_directories(target);
      ASSERT_EQ(std::system(("tar xzf '" + entry.path().string() + "' -C '" + target.string() + "'").c_str()),
                0);
    } else if (entry.is_regular_file()) {
      read_or_refused(entry.path());
    }
  }
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder / "")) {
    if (entry.is_regular_file()) read_or_refused(entry.path());
  }
}

}  // namespace
}  // namespace cuesta
