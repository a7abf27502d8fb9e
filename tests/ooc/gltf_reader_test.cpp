/// glTF 2.0: one small file per feature.

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <fmt/format.h>
#include <meshoptimizer.h>

#include "tests/ooc/gltf_files.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

using test::bytes_of;
using test::glb;
using test::load_bytes;
using test::load_error;
using test::triangle_glb;
using Triangle = std::array<std::uint32_t, 3>;

TEST(GltfReader, InstancesWithTransformsOfAllScenes) {
  const SurfaceMesh mesh = load_bytes(
      "a.glb",
      triangle_glb(
          R"([{"mesh":0,"translation":[10,0,0],"children":[1]},{"mesh":0,"scale":[2,2,2],"rotation":[0,0,0.70710678118654752,0.70710678118654752]},
          {"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,5,1]}])",
          R"(,"scenes":[{"nodes":[0]},{"nodes":[2,0]}])"));
  ASSERT_EQ(mesh.positions.size(), 9u);
  EXPECT_EQ(mesh.positions[1], (Vec3d{11, 0, 0}));
  EXPECT_NEAR(mesh.positions[4].x, 10, 1e-12);  // x turned into y, twice as long, moved by the parent
  EXPECT_NEAR(mesh.positions[4].y, 2, 1e-12);
  EXPECT_EQ(mesh.positions[7], (Vec3d{-1, 0, 5}));
  ASSERT_EQ(mesh.triangles.size(), 3u);
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[2], (Triangle{6, 8, 7}));  // mirrored: turned round
}

TEST(GltfReader, NodeCyclesAndSharedChildrenAreCorrupt) {
  EXPECT_EQ(load_error("a.glb", triangle_glb(R"([{"children":[1]},{"mesh":0,"children":[0]}])",
                                             R"(,"scenes":[{"nodes":[0]}])"))
                .code,
            ErrorCode::corrupt);
  EXPECT_EQ(load_error("a.glb", triangle_glb(R"([{"children":[2]},{"children":[2]},{"mesh":0}])", "")).code,
            ErrorCode::corrupt);
}

TEST(GltfReader, DeepNodeChainsDoNotRecurse) {
  std::string nodes = "[";
  for (int i = 0; i < 100'000; ++i) nodes += fmt::format(R"({{"children":[{}]}},)", i + 1);
  EXPECT_EQ(load_bytes("a.glb", triangle_glb(nodes + R"({"mesh":0}])", "")).triangles.size(), 1u);
}

TEST(GltfReader, DeepJsonIsRefused) {
  EXPECT_EQ(load_error("a.gltf", std::string(100'000, '[')).code, ErrorCode::corrupt);
  EXPECT_EQ(load_error("a.gltf", R"({"asset":{"version":"2.0"},"extras":)" + std::string(100'000, '[') +
                                     std::string(100'000, ']') + "}")
                .code,
            ErrorCode::corrupt);
}

TEST(GltfReader, VersionsAndRequiredExtensionsAreNamed) {
  EXPECT_EQ(load_error("a.gltf", R"({"asset":{"version":"1.0"}})").code, ErrorCode::unsupported_version);
  const Error error = load_error("a.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["EXT_x"]})");
  EXPECT_EQ(error.code, ErrorCode::unsupported_version);
  EXPECT_NE(error.message.find("EXT_x"), std::string::npos);
}

/// One primitive over attributes that follow each other in the buffer; `accessors` and `attributes` are JSON.
std::string gltf_of(const std::string& views, const std::string& accessors, const std::string& primitive,
                    const std::string& binary, const std::string& more = "") {
  return glb(
      fmt::format(
          R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}{}],"bufferViews":[{}],"accessors":[{}],
    "meshes":[{{"primitives":[{{{}}}]}}],"nodes":[{{"mesh":0}}]}})",
          binary.size(), more, views, accessors, primitive),
      binary);
}

TEST(GltfReader, QuantisedInterleavedAttributesAndColours) {
  // Per vertex 20 bytes: u16 position (normalised) + pad, i8 normal + pad, u8 linear colour, u16 texcoord
  // (normalised).
  std::string binary;
  for (const std::uint16_t x : {std::uint16_t{0}, std::uint16_t{65535}, std::uint16_t{13107}}) {
    binary += bytes_of<std::uint16_t>({x, 0, 65535, 0}) + bytes_of<std::int8_t>({0, 0, -127, 0}) +
              bytes_of<std::uint8_t>({255, 55, 0, 128}) + bytes_of<std::uint16_t>({65535, 0});
  }
  const std::string file =
      gltf_of(R"({"buffer":0,"byteLength":60,"byteStride":20})",
              R"({"bufferView":0,"componentType":5123,"normalized":true,"count":3,"type":"VEC3"},
         {"bufferView":0,"byteOffset":8,"componentType":5120,"normalized":true,"count":3,"type":"VEC3"},
         {"bufferView":0,"byteOffset":12,"componentType":5121,"normalized":true,"count":3,"type":"VEC4"},
         {"bufferView":0,"byteOffset":16,"componentType":5123,"normalized":true,"count":3,"type":"VEC2"})",
              R"("attributes":{"POSITION":0,"NORMAL":1,"COLOR_0":2,"TEXCOORD_0":3})", binary);
  const SurfaceMesh mesh = load_bytes("a.glb", file);
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[1], (Vec3d{1, 0, 1}));
  EXPECT_NEAR(mesh.positions[2].x, 0.2, 1e-15);
  EXPECT_EQ(mesh.normals[0], (Vec3f{0, 0, -1}));
  EXPECT_EQ(mesh.colours[0], (Rgba8{255, 128, 0, 128}));  // linear 55/255 is sRGB 128/255
  EXPECT_EQ(mesh.texcoords[0], (TexCoord{1, 1}));         // v is turned up
  EXPECT_EQ(mesh.triangles.size(), 1u);
}

TEST(GltfReader, StripsAndFans) {
  const std::string binary = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
  const auto load = [&](int mode) {
    return load_bytes("a.glb",
                      gltf_of(R"({"buffer":0,"byteLength":48})",
                              R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"})",
                              fmt::format(R"("mode":{},"attributes":{{"POSITION":0}})", mode), binary))
        .triangles;
  };
  EXPECT_EQ(load(5), (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(load(6), (std::vector<Triangle>{{1, 2, 0}, {2, 3, 0}}));
  EXPECT_TRUE(load(0).empty());
  EXPECT_TRUE(load(1).empty());
}

TEST(GltfReader, SparseAccessorsReplaceElementsOfZeros) {
  const std::string binary = bytes_of<std::uint8_t>({1, 2, 0, 0}) + bytes_of<float>({1, 0, 0, 0, 1, 0});
  const SurfaceMesh mesh = load_bytes(
      "a.glb",
      gltf_of(
          R"({"buffer":0,"byteLength":4},{"buffer":0,"byteOffset":4,"byteLength":24})",
          R"({"componentType":5126,"count":3,"type":"VEC3","sparse":{"count":2,"indices":{"bufferView":0,"componentType":5121},"values":{"bufferView":1}}})",
          R"("attributes":{"POSITION":0})", binary));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.positions[0], (Vec3d{0, 0, 0}));
  EXPECT_EQ(mesh.positions[2], (Vec3d{0, 1, 0}));
}

TEST(GltfReader, MeshoptViewsWithFallbackBufferWithoutData) {
  const std::vector<float> positions{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::vector<unsigned> indices{0, 1, 2, 2, 1, 3};
  std::string vertex_code(meshopt_encodeVertexBufferBound(4, 12), '\0');
  meshopt_encodeVertexVersion(0);
  vertex_code.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(vertex_code.data()),
                                                vertex_code.size(), positions.data(), 4, 12));
  std::string index_code(meshopt_encodeIndexBufferBound(6, 4), '\0');
  index_code.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(index_code.data()),
                                              index_code.size(), indices.data(), 6));
  const auto view = [](std::size_t offset, std::size_t bytes, int stride, int count, const char* mode) {
    return fmt::format(
        R"({{"buffer":1,"byteLength":{},"extensions":{{"EXT_meshopt_compression":{{"buffer":0,"byteOffset":{},"byteLength":{},"byteStride":{},"count":{},"mode":"{}"}}}}}})",
        stride * count, offset, bytes, stride, count, mode);
  };
  const SurfaceMesh mesh = load_bytes(
      "a.glb",
      gltf_of(
          view(0, vertex_code.size(), 12, 4, "ATTRIBUTES") + "," +
              view(vertex_code.size(), index_code.size(), 4, 6, "TRIANGLES"),
          R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"})",
          R"("attributes":{"POSITION":0},"indices":1)", vertex_code + index_code, R"(,{"byteLength":72})"));
  ASSERT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.positions[3], (Vec3d{1, 1, 0}));
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[1], (Triangle{2, 1, 3}));
}

std::string draco_triangle() {
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const float a[3] = {0, 0, 0}, b[3] = {4, 0, 0}, c[3] = {0, 4, 0};
  builder.SetAttributeValuesForFace(position, draco::FaceIndex(0), a, b, c);
  const auto mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetEncodingMethod(draco::MESH_EDGEBREAKER_ENCODING);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

TEST(GltfReader, DracoPrimitive) {
  const std::string code = draco_triangle();
  const SurfaceMesh mesh = load_bytes(
      "a.glb",
      gltf_of(
          fmt::format(R"({{"buffer":0,"byteLength":{}}})", code.size()),
          R"({"componentType":5126,"count":3,"type":"VEC3"},{"componentType":5125,"count":3,"type":"SCALAR"})",
          R"("attributes":{"POSITION":0},"indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}})",
          code));
  ASSERT_EQ(mesh.positions.size(), 3u);
  EXPECT_EQ(mesh.triangles.size(), 1u);
  double longest = 0;
  for (const Vec3d& p : mesh.positions) longest = std::max(longest, length(p));
  EXPECT_NEAR(longest, 4, 1e-6);
}

TEST(DracoReader, BareFileAndItsBudget) {
  EXPECT_EQ(load_bytes("a.drc", draco_triangle()).triangles.size(), 1u);
  EXPECT_EQ(load_error("a.drc", draco_triangle(), 1000).code, ErrorCode::out_of_budget);
}

TEST(GltfReader, BuffersBesideTheFileInsideItAndNowhereElse) {
  const test::ScratchFolder folder;
  const auto gltf = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}]})";
  };
  folder.write("my data.bin", test::triangle_binary());
  ReadReport report;
  EXPECT_TRUE(load_mesh(folder.write("a.gltf", gltf("my%20data.bin")), test::test_memory, &report));
  EXPECT_EQ(report.other_files, 1u);
  const std::string base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
  const auto inside = load_mesh(
      folder.write("b.gltf", gltf("data:application/octet-stream;base64," + base64)), test::test_memory);
  ASSERT_TRUE(inside) << inside.error().text();
  EXPECT_EQ(inside->positions[1], (Vec3d{1, 0, 0}));
  for (const std::string uri : {"../secret.bin", "sub/../../secret.bin", "/etc/passwd", "file:///etc/passwd",
                                "http://x/y", "..%2fsecret.bin", "..\\\\x"}) {
    const auto refused = load_mesh(folder.write("c.gltf", gltf(uri)), test::test_memory);
    ASSERT_FALSE(refused) << uri;
    EXPECT_EQ(refused.error().code, ErrorCode::invalid_input) << refused.error().text();
  }
  const auto missing = load_mesh(folder.write("d.gltf", gltf("gone.bin")), test::test_memory);
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::not_found);
}

TEST(GltfReader, AccessorsBeyondTheirViewsAreCorrupt) {
  for (const std::string count : {"4", "18446744073709551615", "6148914691236517206"}) {
    const Error error = load_error(
        "a.glb", gltf_of(R"({"buffer":0,"byteLength":36})",
                         R"({"bufferView":0,"componentType":5126,"count":)" + count + R"(,"type":"VEC3"})",
                         R"("attributes":{"POSITION":0})", test::triangle_binary()));
    EXPECT_EQ(error.code, ErrorCode::corrupt) << error.text();
  }
  const Error zeros =
      load_error("a.glb", gltf_of("", R"({"componentType":5126,"count":999999999999,"type":"VEC3"})",
                                  R"("attributes":{"POSITION":0})", "xxxx"));
  EXPECT_EQ(zeros.code, ErrorCode::out_of_budget) << zeros.text();
}

}  // namespace
}  // namespace cuesta
