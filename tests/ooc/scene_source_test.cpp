/// Scene files: what of them becomes nodes, parts, materials and clips.

#include "ooc/scene_source.h"

#include <fmt/format.h>
#include <lzma.h>
#include <zip.h>

#include "ooc/part_survey.h"
#include "tests/ooc/gltf_files.h"
#include "tests/ooc/mesh_files.h"
#include "tests/shared_data.h"

namespace cuesta {
namespace {

using test::ScratchFolder;
using test::test_memory;

std::unique_ptr<SceneSource> open(const std::filesystem::path& path) {
  auto scene = open_scene(path, test_memory);
  if (scene) return std::move(*scene);
  ADD_FAILURE() << scene.error().text();
  return nullptr;
}

SurfaceMesh part_of(SceneSource& scene, std::uint32_t part) {
  const auto facts = survey_part(scene, part);
  if (!facts) {
    ADD_FAILURE() << facts.error().text();
    return {};
  }
  auto mesh = load_part(scene, part, *facts);
  if (mesh) return std::move(*mesh);
  ADD_FAILURE() << mesh.error().text();
  return {};
}

TEST(GltfScene, NodesKeepNamesParentsAndTransforms) {
  const ScratchFolder folder;
  const auto scene = open(folder.write(
      "a.glb", test::triangle_glb(R"([{"name":"leaf","mesh":0,"matrix":[2,0,0,0,0,2,0,0,0,0,2,0,7,8,9,1]},
        {"name":"root","children":[2,0],"translation":[1,2,3]},{"name":"twin","mesh":0},{"name":"nowhere","mesh":0}])",
                                  R"(,"scenes":[{"nodes":[1]}])")));
  const auto& nodes = scene->scene().nodes;
  ASSERT_EQ(nodes.size(), 3u);
  EXPECT_EQ(nodes[0],
            (SceneNode{"root", no_index, no_index, no_index, Trs{{1, 2, 3}, {0, 0, 0, 1}, {1, 1, 1}}}));
  EXPECT_EQ(nodes[1].name, "twin");
  EXPECT_EQ(nodes[1].parent, 0u);
  EXPECT_EQ(nodes[1].part, 0u);
  EXPECT_EQ(nodes[2].name, "leaf");
  EXPECT_EQ(nodes[2].local, LocalTransform(Affine{{Vec3d{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {7, 8, 9}}));
  ASSERT_EQ(scene->parts().size(), 1u);
  EXPECT_EQ(part_of(*scene, 0).positions[1], (Vec3d{1, 0, 0}));  // in its own frame
  ASSERT_EQ(scene->scene().materials.size(), 1u);                // glTF's own
  EXPECT_EQ(scene->scene().materials[0].metallic, 1);
}

/// Two primitives over the triangle, with what is asked for.
std::string two_primitives(const std::string& first, const std::string& second,
                           const std::string& materials) {
  const std::string primitive = R"({{"attributes":{{"POSITION":0}},"indices":1{}}})";
  return test::glb(
      fmt::format(
          R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":44}}],"bufferViews":[{{"buffer":0,"byteLength":36}},
    {{"buffer":0,"byteOffset":36,"byteLength":6}}],"accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
    {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}],"meshes":[{{"name":"m","primitives":[{},{}]}}],
    "nodes":[{{"mesh":0}}],"materials":[{}]}})",
          fmt::format(fmt::runtime(primitive), first), fmt::format(fmt::runtime(primitive), second),
          materials),
      test::triangle_binary());
}

constexpr const char* red_and_blue =
    R"({"name":"red","pbrMetallicRoughness":{"baseColorFactor":[1,0,0,0.5],"metallicFactor":0.25,"roughnessFactor":0.5}},
       {"name":"blue","doubleSided":true,"alphaMode":"BLEND","pbrMetallicRoughness":{"baseColorFactor":[0,0,1,0.5]}})";

TEST(GltfScene, OneMaterialIsTheNodes) {
  const ScratchFolder folder;
  const auto scene =
      open(folder.write("a.glb", two_primitives(R"(,"material":1)", R"(,"material":1)", red_and_blue)));
  EXPECT_EQ(scene->scene().nodes[0].material, 1u);
  EXPECT_EQ(scene->scene().materials[0], (SceneMaterial{"red", {255, 0, 0, 255}, 0.25f, 0.5f, false}));
  EXPECT_EQ(scene->scene().materials[1], (SceneMaterial{"blue", {0, 0, 255, 128}, 1, 1, true}));
  const SurfaceMesh mesh = part_of(*scene, 0);
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(mesh.colours.empty());
  EXPECT_EQ(scene->parts()[0], "m");
}

TEST(GltfScene, SeveralMaterialsBecomeVertexColours) {
  const ScratchFolder folder;
  const auto scene =
      open(folder.write("a.glb", two_primitives(R"(,"material":0)", R"(,"material":1)", red_and_blue)));
  const SceneMaterial& m = scene->scene().materials[scene->scene().nodes[0].material];
  EXPECT_EQ(m.base_colour, (Rgba8{255, 255, 255, 255}));
  EXPECT_TRUE(m.double_sided);
  const SurfaceMesh mesh = part_of(*scene, 0);
  ASSERT_EQ(mesh.colours.size(), 6u);
  EXPECT_EQ(mesh.colours[0], (Rgba8{255, 0, 0, 255}));
  EXPECT_EQ(mesh.colours[3], (Rgba8{0, 0, 255, 128}));
}

/// The triangle, and floats behind it: accessor 2 on are those of `accessors`.
std::string with_floats(const std::string& nodes, const std::string& accessors,
                        const std::vector<float>& floats, const std::string& more) {
  return test::glb(
      fmt::format(
          R"({{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":{}}}],"bufferViews":[{{"buffer":0,"byteLength":36}},
    {{"buffer":0,"byteOffset":36,"byteLength":6}},{{"buffer":0,"byteOffset":44,"byteLength":{}}}],
    "accessors":[{{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}},
    {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}},{}],
    "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"nodes":{}{}}})",
          44 + 4 * floats.size(), 4 * floats.size(), accessors, nodes, more),
      test::triangle_binary() + test::bytes_of(floats));
}

TEST(GltfScene, GpuInstancesAreNodes) {
  const ScratchFolder folder;
  const std::string glb = with_floats(
      R"([{"name":"many","mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}},{"mesh":0}])",
      R"({"bufferView":2,"componentType":5126,"count":2,"type":"VEC3"})", {1, 0, 0, 2, 0, 0},
      R"(,"extensionsRequired":["EXT_mesh_gpu_instancing"])");
  const auto path = folder.write("a.glb", glb);
  const auto scene = open(path);
  const auto& nodes = scene->scene().nodes;
  ASSERT_EQ(nodes.size(), 4u);
  EXPECT_EQ(nodes[0].part, no_index);
  EXPECT_EQ(nodes[2].parent, 0u);
  EXPECT_EQ(nodes[2].part, 0u);
  EXPECT_EQ(std::get<Trs>(nodes[2].local).translation, (Vec3d{2, 0, 0}));
  EXPECT_EQ(nodes[3].parent, no_index);
  const auto surface = load_mesh(path, test_memory);  // as a surface: all of them
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->triangles.size(), 3u);
  EXPECT_EQ(surface->positions[3], (Vec3d{2, 0, 0}));
}

TEST(GltfScene, AnimationsBecomeClips) {
  const ScratchFolder folder;
  const std::string accessors =
      R"({"bufferView":2,"componentType":5126,"count":4,"type":"SCALAR"},
         {"bufferView":2,"byteOffset":16,"componentType":5126,"count":4,"type":"VEC3"})";
  const std::vector<float> floats{0, 1, 1, 2, 1, 0, 0, 2, 0, 0, 3, 0, 0, 4, 0, 0};
  const auto scene = open(folder.write(
      "a.glb",
      with_floats(R"([{"children":[1,2]},{"mesh":0},{"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])",
                  accessors, floats,
                  R"(,"animations":[{"name":"go","samplers":[{"input":2,"output":3,"interpolation":"STEP"}],
      "channels":[{"sampler":0,"target":{"node":1,"path":"translation"}},{"sampler":0,"target":{"node":2,"path":"scale"}},
      {"sampler":0,"target":{"node":1,"path":"weights"}},{"sampler":0,"target":{"node":1,"path":"rotation"}}]}])")));
  ASSERT_EQ(scene->scene().clips.size(), 1u);
  const SceneClip& clip = scene->scene().clips[0];
  EXPECT_EQ(clip.name, "go");
  ASSERT_EQ(clip.channels.size(), 1u);  // not of a matrix, not of weights, not three numbers for a rotation
  EXPECT_EQ(clip.channels[0], (SceneChannel{1,
                                            AnimatedProperty::translation,
                                            Interpolation::step,
                                            {0, 1, 2},
                                            {1, 0, 0, 2, 0, 0, 4, 0, 0}}));  // a second key at 1 s is dropped
  EXPECT_EQ(scene->warnings().size(), 2u);
}

TEST(GltfScene, EmptyMeshesAreNoParts) {
  const ScratchFolder folder;
  const auto scene = open(folder.write(
      "a.gltf",
      R"({"asset":{"version":"2.0"},"meshes":[{"primitives":[{"mode":1,"attributes":{}}]}],"nodes":[{"mesh":0}]})"));
  EXPECT_TRUE(scene->parts().empty());
  EXPECT_EQ(scene->scene().nodes[0].part, no_index);
  EXPECT_EQ(scene->warnings().size(), 1u);
}

TEST(GltfScene, CutOffAtEveryByteIsAnError) {
  const ScratchFolder folder;
  const std::string good = test::triangle_glb(R"([{"mesh":0}])", "");
  for (std::size_t n = 0; n < good.size(); ++n)
    EXPECT_FALSE(open_scene(folder.write("a.glb", good.substr(0, n)), test_memory)) << n;
}

TEST(GltfScene, HugeInstancingIsRefusedBeforeItIsAllocated) {
  const ScratchFolder folder;
  const std::string glb =
      with_floats(R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":2}}}}])",
                  R"({"componentType":5126,"count":99999999999,"type":"VEC3"})", {0}, "");
  const auto scene = open_scene(folder.write("a.glb", glb), test_memory);
  ASSERT_FALSE(scene);
  EXPECT_EQ(scene.error().code, ErrorCode::out_of_budget);
}

constexpr const char* grouped =
    "mtllib a.mtl\n"
    "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    "g one\nusemtl red\nf 1 2 3\n"
    "v 5 0 0\nv 6 0 0\nv 5 1 0\n"
    "g two\nf -3 -2 -1\nusemtl blue\nf 4 6 5\n"
    "g empty\n"
    "g one\nusemtl red\nf 1 3 2\n";

TEST(ObjScene, GroupsOfOneNameAreOnePart) {
  const ScratchFolder folder;
  folder.write("a.mtl",
               "newmtl red\nKd 1 0 0\nd 0.5\nPm 0.25\nPr 0.75\n\nnewmtl blue\nKd 0 0 1\nmap_Kd x.png\nNs 0\n"
               "newmtl red\nKd 0 1 0\n");
  const auto scene = open(folder.write("a.obj", grouped));
  ASSERT_EQ(scene->parts(), (std::vector<std::string>{"one", "two"}));
  const SurfaceMesh one = part_of(*scene, 0);
  EXPECT_EQ(one.positions.size(), 3u);
  EXPECT_EQ(one.triangles.size(), 2u);
  EXPECT_TRUE(one.colours.empty());
  const auto& nodes = scene->scene().nodes;
  EXPECT_EQ(nodes[0].name, "one");
  EXPECT_EQ(scene->scene().materials[nodes[0].material],
            (SceneMaterial{"red", {255, 0, 0, 128}, 0.25f, 0.75f, false}));
  const SurfaceMesh two = part_of(*scene, 1);
  ASSERT_EQ(two.colours.size(), 6u);  // positions shared by two colours are two vertices
  EXPECT_EQ(two.positions[0], (Vec3d{5, 0, 0}));
  EXPECT_EQ(two.colours[0], (Rgba8{255, 0, 0, 128}));
  EXPECT_EQ(two.colours[5], (Rgba8{0, 0, 255, 255}));
  EXPECT_EQ(scene->files().size(), 2u);
  EXPECT_EQ(scene->warnings().size(), 1u);  // one texture
}

TEST(ObjScene, ObjectsArePartsAndGroupsInThemAreNot) {
  const ScratchFolder folder;
  const auto scene = open(folder.write(
      "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\no same\ng x\nf 1 2 3\ng y\nf 1 3 2\no same\nf 1 2 3\n"));
  EXPECT_EQ(scene->parts(), (std::vector<std::string>{"same", "same"}));
  EXPECT_EQ(part_of(*scene, 0).triangles.size(), 2u);
  EXPECT_EQ(part_of(*scene, 1).triangles.size(), 1u);
}

TEST(ObjScene, MaterialsOutsideItsFolderAreNotRead) {
  const ScratchFolder folder;
  const auto scene =
      open(folder.write("a.obj", "mtllib ../secret.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  EXPECT_EQ(scene->files().size(), 1u);
  EXPECT_EQ(scene->warnings().size(), 1u);
  EXPECT_EQ(scene->parts().size(), 1u);
}

TEST(FolderScene, FilesArePartsAndFoldersAreNodes) {
  const ScratchFolder folder;
  const std::string triangle = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  std::filesystem::create_directories(folder / "wing/deep");
  std::filesystem::create_directories(folder / "none");
  folder.write("b.off", triangle);
  folder.write("a.off", triangle);
  folder.write("notes.txt", "no mesh");
  folder.write("wing/deep/c.off", triangle);
  const auto scene = open(folder / "");
  EXPECT_EQ(scene->parts(), (std::vector<std::string>{"a", "b", "c"}));
  const auto& nodes = scene->scene().nodes;
  ASSERT_EQ(nodes.size(), 5u);
  EXPECT_EQ(nodes[2].name, "wing");
  EXPECT_EQ(nodes[4].parent, 3u);
  EXPECT_EQ(part_of(*scene, 2).triangles.size(), 1u);
  EXPECT_EQ(open_scene(folder / "none", test_memory).error().code, ErrorCode::invalid_input);
  EXPECT_EQ(open_scene(folder / "missing", test_memory).error().code, ErrorCode::not_found);
}

std::string xz_of(const std::string& plain) {
  std::string packed(plain.size() + 1024, '\0');
  std::size_t size = 0;
  EXPECT_EQ(lzma_easy_buffer_encode(6, LZMA_CHECK_CRC64, nullptr,
                                    reinterpret_cast<const std::uint8_t*>(plain.data()), plain.size(),
                                    reinterpret_cast<std::uint8_t*>(packed.data()), &size, packed.size()),
            LZMA_OK);
  packed.resize(size);
  return packed;
}

TEST(CompressedScene, XzAndZipAreReadAndCutOnesAreErrors) {
  const ScratchFolder folder;
  const std::string plain = test::triangle_glb(R"([{"mesh":0}])", "");
  const std::string xz = xz_of(plain);
  EXPECT_EQ(open(folder.write("a.glb.xz", xz))->parts().size(), 1u);
  for (std::size_t n = 6; n < xz.size(); n += 3)
    EXPECT_FALSE(open_scene(folder.write("cut.glb.xz", xz.substr(0, n)), test_memory)) << n;
  zip_t* zip = zip_open((folder / "a.glb.zip").c_str(), ZIP_CREATE, nullptr);
  ASSERT_TRUE(zip);
  zip_file_add(zip, "inner/name.glb", zip_source_buffer(zip, plain.data(), plain.size(), 0), 0);
  ASSERT_EQ(zip_close(zip), 0);
  EXPECT_EQ(open(folder / "a.glb.zip")->parts().size(), 1u);
  EXPECT_TRUE(load_mesh(folder / "a.glb.zip", test_memory));
}

TEST(SurveyPart, EqualContentsAreEqualWhateverTheirNames) {
  const ScratchFolder folder;
  const auto scene = open(folder.write(
      "a.obj",
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no a\nf 1 2 3\no b\nf 1 2 3\no c\nf 1 2 4\no d\nf 2 3 1\n"));
  std::vector<std::string> contents;
  for (std::uint32_t p = 0; p < 4; ++p) contents.push_back(survey_part(*scene, p)->content);
  EXPECT_EQ(contents[0], contents[1]);
  EXPECT_NE(contents[0], contents[2]);
  EXPECT_NE(contents[0], contents[3]);
}

struct RealScene {
  const char* name;
  std::size_t nodes, instances, parts, materials;
};

class RealScenes : public testing::TestWithParam<RealScene> {};

TEST_P(RealScenes, HaveTheirCounts) {
  const RealScene& expected = GetParam();
  CUESTA_NEED_SHARED(path, std::string("scene/") + expected.name);
  const auto scene = open(path);
  ASSERT_TRUE(scene);
  const auto& nodes = scene->scene().nodes;
  EXPECT_EQ(nodes.size(), expected.nodes);
  EXPECT_EQ(std::count_if(nodes.begin(), nodes.end(), [](const SceneNode& n) { return n.part != no_index; }),
            static_cast<std::ptrdiff_t>(expected.instances));
  EXPECT_EQ(scene->parts().size(), expected.parts);
  EXPECT_EQ(scene->scene().materials.size(), expected.materials);
}

INSTANTIATE_TEST_SUITE_P(Shared, RealScenes,
                         testing::Values(RealScene{"LHCb_all.glb.xz", 28754, 12916, 1024, 13},
                                         RealScene{"LHCb.glb.zip", 28754, 12916, 1024, 13},
                                         RealScene{"ldraw_10283_space_shuttle.glb", 2321, 2320, 317, 1},
                                         RealScene{"2CylinderEngine.glb", 82, 67, 29, 35},
                                         RealScene{"cms.gltf", 6, 2, 2, 2}));

}  // namespace
}  // namespace cuesta
