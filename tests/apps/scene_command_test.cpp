/// Scenes as a user builds, looks at and exports them.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "ooc/mesh_reader.h"
#include "ooc/mesh_writer.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"
#include "tests/ooc/gltf_files.h"

namespace cuesta::test {
namespace {

using nlohmann::json;

constexpr std::uint64_t memory = std::uint64_t{64} << 20;

class SceneCommand : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  /// The triangle, shown twice, once mirrored and moved, with a clip.
  std::string two_triangles() {
    return write(
        "two.glb",
        triangle_glb(R"([{"mesh":0,"name":"still"},{"mesh":0,"matrix":[-1,0,0,0,0,1,0,0,0,0,1,0,5,0,0,1]}])",
                     ""));
  }
  Outcome run_words(std::vector<std::string> words) { return run(folder_, std::move(words)); }
  TestFolder folder_;
};

TEST_F(SceneCommand, builds_tells_verifies_and_exports) {
  const std::string out = folder_ / "two.cuesta", ply = folder_ / "two.ply";
  const auto built = run_words({"build", two_triangles(), "--type", "scene", "-o", out, "--quiet"});
  ASSERT_EQ(built.status, 0) << built.err;
  EXPECT_NE(built.out.find("2 instances of 1 parts"), std::string::npos) << built.out;
  const auto info = run_words({"info", out, "--json", "--parts"});
  ASSERT_EQ(info.status, 0) << info.err;
  const json told = json::parse(info.out);
  EXPECT_EQ(told["kind"], "scene");
  EXPECT_EQ(told["instances"], 2);
  EXPECT_EQ(told["triangles"], 1);
  EXPECT_EQ(told["instanced_triangles"], 2);
  EXPECT_EQ(told["part_list"][0]["kind"], "tom");
  EXPECT_EQ(told["metadata"]["options"]["type"], "scene");
  EXPECT_NEAR(told["bounds"]["hi"][0].get<double>(), 5, 1e-6);
  EXPECT_EQ(run_words({"verify", out}).status, 0);
  const auto exported = run_words({"export", out, "--full", "-o", ply});
  ASSERT_EQ(exported.status, 0) << exported.err;
  const auto mesh = load_mesh(ply, memory);
  ASSERT_TRUE(mesh);
  ASSERT_EQ(mesh->triangles.size(), 2u);
  for (const auto& t : mesh->triangles) {  // both look along +z, also the mirrored one
    const auto& p = mesh->positions;
    EXPECT_GT(cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]).z, 0);
    EXPECT_GT(mesh->normals[t[0]].z, 0.99f);
  }
}

TEST_F(SceneCommand, exports_what_a_name_says) {
  const std::string in = write(
      "named.glb", triangle_glb(
                       R"([{"name":"group","translation":[0,0,7],"children":[1,2]},{"name":"a","mesh":0},
      {"name":"b","mesh":0,"translation":[5,0,0]},{"name":"a","mesh":0,"translation":[0,9,0]}])",
                       ""));
  const std::string out = folder_ / "named.cuesta", ply = folder_ / "named.ply";
  ASSERT_EQ(run_words({"build", in, "-o", out, "--quiet"}).status, 0);
  const auto box = [&](std::vector<std::string> words) {
    std::vector<std::string> all{"export", out, "--full", "-o", ply};
    all.insert(all.end(), words.begin(), words.end());
    const auto exported = run_words(all);
    EXPECT_EQ(exported.status, 0) << exported.err;
    const auto mesh = load_mesh(ply, memory);
    Box3d around;
    for (const Vec3d& p : mesh.value().positions) around.add(p);
    return around;
  };
  EXPECT_EQ(box({}).hi, (Vec3d{6, 10, 7}));
  EXPECT_LT(length(box({"--node", "b"}).lo - Vec3d{5, 0, 7}), 1e-9);
  EXPECT_EQ(box({"--node", "b"}).hi, (Vec3d{6, 1, 7}));
  EXPECT_EQ(box({"--node", "group"}).hi, (Vec3d{6, 1, 7})) << "and what is below it";
  EXPECT_EQ(box({"--node", "a"}).hi, (Vec3d{1, 10, 7})) << "all of this name";
  const auto none = run_words({"export", out, "--full", "-o", ply, "--node", "nothing"});
  EXPECT_EQ(none.status, 5);
  EXPECT_NE(none.err.find("\"nothing\""), std::string::npos) << none.err;
}

TEST_F(SceneCommand, exports_a_part_in_its_own_frame) {
  std::filesystem::create_directory(folder_ / "parts");
  write("parts/one.obj", "v 1 0 0\nv 2 0 0\nv 1 1 0\nf 1 2 3\n");
  write("parts/two.obj", "v 1 0 5\nv 4 0 5\nv 1 1 5\nf 1 2 3\n");
  const std::string out = folder_ / "parts.cuesta", obj = folder_ / "part.obj";
  ASSERT_EQ(run_words({"build", folder_ / "parts", "-o", out, "--quiet"}).status, 0);
  const json told = json::parse(run_words({"info", out, "--json", "--parts"}).out);
  const std::string name = told["part_list"][1]["name"];
  const auto exported = run_words({"export", out, "--full", "-o", obj, "--part", name});
  ASSERT_EQ(exported.status, 0) << exported.err;
  const auto mesh = load_mesh(obj, memory);
  ASSERT_TRUE(mesh);
  EXPECT_EQ(mesh->triangles.size(), 1u);
  Box3d box;
  for (const Vec3d& p : mesh->positions) box.add(p);
  EXPECT_NEAR(box.hi.x - box.lo.x, 3, 1e-6);
  EXPECT_EQ(run_words({"export", out, "--full", "-o", obj, "--part", "three"}).status, 5);
}

TEST_F(SceneCommand, is_up_to_date_until_a_byte_changes) {
  const std::string in = two_triangles(), out = folder_ / "two.cuesta";
  ASSERT_EQ(run_words({"build", in, "-o", out, "--quiet"}).status, 0);
  EXPECT_NE(run_words({"build", in, "-o", out, "--quiet"}).out.find("up to date"), std::string::npos);
  write("two.glb", triangle_glb(R"([{"mesh":0},{"mesh":0}])", ""));
  EXPECT_EQ(run_words({"build", in, "-o", out, "--quiet"}).out.find("up to date"), std::string::npos);
  EXPECT_EQ(run_words({"build", in, "-o", out, "--largest-tom", "5", "--quiet"}).out.find("up to date"),
            std::string::npos);
}

TEST_F(SceneCommand, the_type_is_seen_where_it_is_not_said) {
  const std::string out = folder_ / "x.cuesta";
  const auto kind_of = [&](const std::vector<std::string>& words) -> std::string {
    std::vector<std::string> build{"build", "-o", out, "--quiet", "--force"};
    build.insert(build.end(), words.begin(), words.end());
    const auto built = run_words(build);
    EXPECT_EQ(built.status, 0) << built.err;
    return json::parse(run_words({"info", out, "--json"}).out).value("kind", "surface");
  };
  const std::string two = two_triangles();
  const std::string one = write("one.glb", triangle_glb(R"([{"mesh":0}])", ""));
  EXPECT_EQ(kind_of({two}), "scene");
  EXPECT_EQ(kind_of({two, "--type", "surface"}), "surface");
  EXPECT_EQ(kind_of({one}), "surface");
  EXPECT_EQ(kind_of({one, "--type", "scene"}), "scene");
  std::filesystem::create_directories(folder_ / "parts");
  std::filesystem::copy(one, folder_ / "parts/a.glb");
  EXPECT_EQ(kind_of({folder_ / "parts"}), "scene");
}

TEST_F(SceneCommand, large_parts_are_verified_by_sample_cuts) {
  std::filesystem::create_directory(folder_ / "parts");
  ASSERT_TRUE(write_mesh(folder_ / "parts/large.ply", bumpy_sphere(60, 60)));
  ASSERT_TRUE(write_mesh(folder_ / "parts/small.ply", bumpy_sphere(10, 10)));
  const std::string out = folder_ / "large.cuesta";
  const auto built = run_words({"build", folder_ / "parts", "--largest-tom", "1000", "-o", out, "--quiet"});
  ASSERT_EQ(built.status, 0) << built.err;
  const auto verified = run_words({"verify", out, "--json"});
  ASSERT_EQ(verified.status, 0) << verified.out;
  const json all = json::parse(verified.out),
             quick = json::parse(run_words({"verify", out, "--json", "--quick"}).out);
  EXPECT_EQ(all["surfaces"], 1);
  EXPECT_EQ(all["toms"], 1);
  EXPECT_GT(all["sample_cuts"], 8);
  EXPECT_TRUE(all["skipped"].empty());
  EXPECT_EQ(quick["sample_cuts"], 0);
}

TEST_F(SceneCommand, what_cannot_be_is_told) {
  const std::string two = two_triangles(), out = folder_ / "two.cuesta";
  EXPECT_EQ(run_words({"build", two, two, "--type", "scene", "-o", out}).status, 5);
  ASSERT_EQ(run_words({"build", two, "-o", out, "--quiet"}).status, 0);
  const auto camera =
      run_words({"export", out, "-o", folder_ / "a.ply", "--camera", "eye 0,0,1 target 0,0,0"});
  EXPECT_EQ(camera.status, 5);
  std::filesystem::resize_file(out, std::filesystem::file_size(out) - 1);
  EXPECT_EQ(run_words({"verify", out}).status, 3);
  EXPECT_EQ(run_words({"info", out}).status, 0);
}

}  // namespace
}  // namespace cuesta::test
