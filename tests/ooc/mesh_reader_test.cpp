/// PLY, OBJ, STL and OFF: one small hand-written file per feature, and what exactly must come out of it.

#include "ooc/mesh_reader.h"

#include <cmath>
#include <cstdlib>
#include <cstring>

#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

using test::load_bytes;
using test::load_error;
using Triangle = std::array<std::uint32_t, 3>;

template <class T>
std::string raw(T value, bool big_endian = false) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  return bytes;
}

TEST(PlyReader, AsciiInAnyPropertyOrderWithUnknownElementsAndComments) {
  ReadReport report;
  const SurfaceMesh mesh =
      load_bytes("a.bin",
                 "ply\r\nformat ascii 1.0\r\ncomment hello\r\nobj_info x\r\n"
                 "element junk 2\r\nproperty list uchar float stuff\r\nproperty int more\r\n"
                 "element vertex 3\r\nproperty uchar red\r\nproperty float z\r\nproperty double y\r\n"
                 "property list uchar int extra\r\nproperty short x\r\nproperty uchar green\r\n"
                 "property uchar blue\r\nproperty float s\r\nproperty float t\r\nproperty float nx\r\n"
                 "property float ny\r\nproperty float nz\r\n"
                 "element face 1\r\nproperty list uchar uint vertex_index\r\nend_header\r\n"
                 "2 0.5 0.25 7\r\n0 8\r\n"
                 "255 3 2.5 1 9 1 0 128 0.25 0.75 0 0 2\r\n0 6 5 0 4 1 2 0 0 0 1 0\r\n"
                 "1 9 8 2 5 6 7 3 4 0 0 0 0 0\r\n3 0 1 2\r\n",
                 &report);
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[0], (Vec3d{1, 2.5, 3}));
  EXPECT_EQ(mesh.positions[2], (Vec3d{7, 8, 9}));
  EXPECT_EQ(mesh.colours[0], (Rgba8{255, 0, 128, 255}));
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.normals[2], (Vec3f{0, 0, 0}));
  EXPECT_EQ(mesh.texcoords[0], (TexCoord{0.25f, 0.75f}));
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(report.vertices, 3u);
}

TEST(PlyReader, BinaryOfBothOrdersFacesBeforeVerticesQuadAndBadIndex) {
  for (const bool big : {false, true}) {
    std::string ply =
        std::string("ply\nformat binary_") + (big ? "big" : "little") +
        "_endian 1.0\nelement face 4\nproperty uchar flag\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\nelement vertex 4\nproperty double x\nproperty float y\n"
        "property int z\nproperty float red\nproperty float green\nproperty float blue\nproperty float "
        "alpha\n"
        "property float texture_u\nproperty float texture_v\nend_header\n";
    const auto face = [&](std::vector<std::int32_t> corners) {
      ply += raw<std::uint8_t>(1) + raw(static_cast<std::uint8_t>(corners.size()));
      for (const std::int32_t c : corners) ply += raw(c, big);
      ply += raw<std::uint8_t>(1) + raw(0.5f, big);
    };
    face({0, 1, 2, 3});
    face({0, 1, 4});
    face({0, -1, 2});
    face({0, 1});
    for (int i = 0; i < 4; ++i) {
      ply += raw(i == 1 || i == 2 ? 0.1 : 0.0, big) + raw(i >= 2 ? 1.0f : 0.0f, big) +
             raw(std::int32_t{-7}, big);
      ply += raw(0.0f, big) + raw(0.5f, big) + raw(1.0f, big) + raw(2.0f, big) + raw(0.25f, big) +
             raw(1.5f, big);
    }
    ReadReport report;
    const SurfaceMesh mesh = load_bytes("a.ply", ply, &report);
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.positions[2], (Vec3d{0.1, 1, -7}));
    EXPECT_EQ(mesh.colours[0], (Rgba8{0, 128, 255, 255}));
    EXPECT_EQ(mesh.texcoords[3], (TexCoord{0.25f, 1.5f}));
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(report.polygons_triangulated, 1u);
    EXPECT_EQ(report.faces_out_of_range, 2u);
    EXPECT_EQ(report.faces_too_small, 1u);
  }
}

TEST(PlyReader, StripsAlternateAndRestart) {
  const SurfaceMesh mesh =
      load_bytes("a.ply",
                 "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\n"
                 "property float z\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
                 "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n9 0 1 2 3 -1 3 5 4 4\n");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{2, 1, 3}));
  EXPECT_EQ(mesh.triangles[2], (Triangle{3, 5, 4}));
}

TEST(PlyReader, CountsBeyondTheFileAreRefusedBeforeAllocating) {
  for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    const Error error = load_error("a.ply", "ply\nformat " + format +
                                                " 1.0\nelement vertex 99999999999999\nproperty float x\n"
                                                "property float y\nproperty float z\nend_header\n0 0 0\n");
    EXPECT_EQ(error.code, ErrorCode::corrupt) << error.text();
    EXPECT_NE(error.message.find("99999999999999"), std::string::npos) << error.text();
  }
}

TEST(PlyReader, UnknownVersionIsNamed) {
  const Error error = load_error("a.ply", "ply\nformat ascii 2.0\nelement vertex 0\nend_header\n");
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
}

TEST(ObjReader, CornerFormsShareVerticesByTriple) {
  const SurfaceMesh mesh =
      load_bytes("a.obj",
                 "# comment\r\nmtllib a.mtl\r\no thing\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nv 1 1 0\r\n"
                 "vt 0 0\r\nvt 1 0 0\r\nvn 0 0 3\r\ns off\r\n"
                 "f 1/1/1 2/2/1 3/1/1\r\nf 3/1/1 2/2/1 4//1\r\nf 1/1/1 2/1/1 \\\r\n  4//1 # end\r\n");
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.positions.size(), 5u);  // (1,1,1) (2,2,1) (3,1,1) (4,-,1) (2,1,1)
  EXPECT_EQ(mesh.triangles[1], (Triangle{2, 1, 3}));
  EXPECT_EQ(mesh.triangles[2], (Triangle{0, 4, 3}));
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.texcoords[1], (TexCoord{1, 0}));
}

TEST(ObjReader, NegativeIndicesColoursForwardReferencesAndPolygons) {
  ReadReport report;
  const SurfaceMesh mesh =
      load_bytes("a.obj",
                 "v +0 0 0 1 0 0.5\nv 4.0e0 0 0 0 0 0\nv 1 1 0 0 0 0\nf -3 -2 -1 4\nv 0 4 0 1 1 1\n"
                 "f 0 1 2\nf 1 2 9\nf 1 2\nf -9 1 2\nvp 1 2\n",
                 &report);
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[1], (Vec3d{4, 0, 0}));
  EXPECT_EQ(mesh.colours[0], (Rgba8{255, 0, 128, 255}));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  for (const Triangle& t : mesh.triangles) {  // the dent at 2 is not cut across: both triangles have it
    EXPECT_TRUE(std::count(t.begin(), t.end(), 2u) == 1 && std::count(t.begin(), t.end(), 0u) == 1);
  }
  EXPECT_EQ(report.faces_out_of_range, 3u);
  EXPECT_EQ(report.faces_too_small, 1u);
}

TEST(ObjReader, MalformedLinesAreNamed) {
  EXPECT_EQ(load_error("a.obj", "v 0 0 0\nv 1 x\n").place, "line 2");
  EXPECT_EQ(load_error("a.obj", "v 0 0 0\nf 1 1 a\n").place, "line 2");
}

TEST(TextNumbers, AreCorrectlyRounded) {
  const std::vector<std::string> numbers{"0.1",
                                         "-123.456e-3",
                                         "1e22",
                                         "1e23",
                                         "9007199254740993",
                                         "3.141592653589793238",
                                         "4.9e-324",
                                         "1.7976931348623157e308",
                                         "123456789012345678e-5",
                                         "-0.0",
                                         "5.",
                                         ".5"};
  std::string obj;
  for (const std::string& n : numbers) obj += "v " + n + " 0 0\n";
  const SurfaceMesh mesh = load_bytes("a.obj", obj);
  for (std::size_t i = 0; i < numbers.size(); ++i)
    EXPECT_EQ(mesh.positions[i].x, std::strtod(numbers[i].c_str(), nullptr)) << numbers[i];
  EXPECT_TRUE(std::isinf(load_bytes("a.obj", "v 1e999 0 0\n").positions[0].x));
  EXPECT_TRUE(std::isnan(load_bytes("a.obj", "v nan 0 0\n").positions[0].x));
}

std::string binary_stl(std::string header, std::uint32_t count) {
  header.resize(80, ' ');
  std::string stl = header + raw(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 12; ++k) stl += raw(static_cast<float>(k) + static_cast<float>(i));
    stl += raw(std::uint16_t{0xffff});
  }
  return stl;
}

TEST(StlReader, BinaryThatStartsWithSolid) {
  const SurfaceMesh mesh = load_bytes("a.stl", binary_stl("solid not ascii", 3));
  ASSERT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(mesh.positions[3], (Vec3d{4, 5, 6}));
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[2], (Triangle{6, 7, 8}));
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(StlReader, AsciiOfSeveralSolidsWithVertexInTheName) {
  const SurfaceMesh mesh = load_bytes("a.stl",
                                      "solid vertex 1\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex "
                                      "1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
                                      "endsolid vertex 1\nSOLID\nFACET NORMAL 0 0 1 OUTER LOOP VERTEX 1e0 0 "
                                      "0 VERTEX 1 1 0 VERTEX 0 1 -2.5 ENDLOOP\n"
                                      "ENDFACET ENDSOLID\n");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.positions[5], (Vec3d{0, 1, -2.5}));
}

TEST(StlReader, TruncatedBinaryIsCorrupt) {
  std::string stl = binary_stl("x", 3);
  stl.pop_back();
  const Error error = load_error("a.stl", stl);
  EXPECT_EQ(error.code, ErrorCode::corrupt);
  EXPECT_EQ(error.place, "byte 80");
}

TEST(OffReader, PrefixesColoursAndComments) {
  const SurfaceMesh mesh =
      load_bytes("a.off",
                 "# first\nSTCNOFF # all of it\n\n3 1 # no edges\n"
                 "0 0 0 0 0 1 255 128 0 255 0.5 0.25\n# between\n1 0 0 0 0 1 1 2 3 4 0 1\n"
                 "0 1 0 0 0 1 0 0 0 0 1 1\n3 0 1 2 255 0 0\n");
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(mesh.colours[0], (Rgba8{255, 128, 0, 255}));
  EXPECT_EQ(mesh.colours[1], (Rgba8{1, 2, 3, 4}));
  EXPECT_EQ(mesh.texcoords[0], (TexCoord{0.5f, 0.25f}));
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(OffReader, RealColoursPolygonAndNoKeyword) {
  const SurfaceMesh coff = load_bytes("a.off", "COFF\n1 0 0\n0 0 0 1.0 0.5 0.0 1.0\n");
  EXPECT_EQ(coff.colours[0], (Rgba8{255, 128, 0, 255}));
  ReadReport report;
  const SurfaceMesh plain =
      load_bytes("a.off", "5 2 0\n0 0 0\n2 0 0\n2 2 0\n1 3 0\n0 2 0\n5 0 1 2 3 4\n3 0 1 7\n", &report);
  EXPECT_EQ(plain.triangles.size(), 3u);
  EXPECT_EQ(report.faces_out_of_range, 1u);
}

TEST(MeshReader, FormatIsTakenFromTheContentFirst) {
  EXPECT_EQ(load_bytes("a.obj", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").triangles.size(), 1u);
}

TEST(MeshReader, UnknownEmptyAndMissingFiles) {
  const Error unknown = load_error("a.xyz", "what is this");
  EXPECT_EQ(unknown.code, ErrorCode::unsupported_version);
  EXPECT_NE(unknown.message.find("PLY"), std::string::npos);
  EXPECT_EQ(load_error("a.ply", "").code, ErrorCode::corrupt);
  const auto missing = load_mesh("/no/such/file.ply", test::test_memory);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
}

TEST(MeshReader, MemoryIsBounded) {
  std::string obj;
  for (int i = 0; i < 10'000; ++i) obj += "v 1 2 3\n";
  EXPECT_EQ(load_error("a.obj", obj, 100'000).code, ErrorCode::out_of_budget);
}

TEST(MeshReader, ProgressCancels) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a.stl", binary_stl("x", 50'000));
  int calls = 0;
  test::CheckingSink sink;
  const auto report = read_mesh(path, sink, test::test_memory, [&](std::uint64_t done, std::uint64_t total) {
    EXPECT_LE(done, total);
    return ++calls < 2;
  });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::cancelled);
  EXPECT_EQ(calls, 2);
}

}  // namespace
}  // namespace cuesta
