/// cuesta render of scenes: a picture, a flight under a deadline, damage.

#include <algorithm>
#include <sstream>

#include "ooc/mesh_writer.h"
#include "runtime/draw/png_file.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"

namespace cuesta::test {
namespace {

/// Two spheres, 3 apart, from a folder of files.
class SceneRender : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directory(folder_ / "parts");
    SurfaceMesh mesh = bumpy_sphere(60, 60);
    ASSERT_TRUE(write_mesh(folder_ / "parts/a.ply", mesh));
    for (Vec3d& p : mesh.positions) p.x += 3;
    ASSERT_TRUE(write_mesh(folder_ / "parts/b.ply", mesh));
    const auto built = run_words({"build", folder_ / "parts", "--type", "scene", "-o", file(), "--quiet"});
    ASSERT_EQ(built.status, 0) << built.err;
  }
  std::string file() const { return folder_ / "scene.cuesta"; }
  Outcome run_words(std::vector<std::string> words) const { return run(folder_, std::move(words)); }
  Outcome render(std::vector<std::string> more) const {
    std::vector<std::string> words{"render", file(), "--size", "200x120", "--context", "osmesa"};
    words.insert(words.end(), more.begin(), more.end());
    return run_words(std::move(words));
  }
  /// Rows of frames.csv by column.
  std::vector<double> column(const std::string& name) const {
    std::istringstream in(read_text(folder_ / "frames/frames.csv"));
    std::string line, cell;
    std::getline(in, line);
    std::istringstream head(line);
    std::size_t at = 0;
    while (std::getline(head, cell, ',') && cell != name) ++at;
    std::vector<double> values;
    while (std::getline(in, line)) {
      std::istringstream row(line);
      for (std::size_t i = 0; i <= at; ++i) std::getline(row, cell, ',');
      values.push_back(std::stod(cell));
    }
    return values;
  }
  TestFolder folder_;
};

TEST_F(SceneRender, APictureShowsBothParts) {
  const Outcome outcome = render({"-o", folder_ / "still.png", "--tau", "0.1"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("in 2 objects"), std::string::npos) << outcome.out;
  const auto picture = read_png(folder_ / "still.png");
  ASSERT_TRUE(picture);
  const auto drawn = [&](int from, int to) {
    int count = 0;
    for (int y = 0; y < 120; ++y)
      for (int x = from; x < to; ++x)
        count += picture->pixels[static_cast<std::size_t>(y * 200 + x)] != Rgba8{255, 255, 255, 255} ? 1 : 0;
    return count;
  };
  EXPECT_GT(drawn(0, 100), 1500);
  EXPECT_GT(drawn(100, 200), 1500);
}

TEST_F(SceneRender, AFlightTellsOfEachFrame) {
  for (const std::string policy : {"predictive", "stress", "static"}) {
    const Outcome outcome =
        render({"--orbit", "8", "--policy", policy, "--deadline-ms", "500", "-o", folder_ / "frames"});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find(policy + ", 500 ms"), std::string::npos) << outcome.out;
    EXPECT_TRUE(std::filesystem::exists(folder_ / "frames/frame-00007.png"));
    EXPECT_NE(read_text(folder_ / "frames/frames.svg").find("visible"), std::string::npos);
    ASSERT_EQ(column("actual_ms").size(), 8u);
    for (const double ms : column("actual_ms")) EXPECT_GT(ms, 0);
    for (const double ms : column("desired_ms")) EXPECT_EQ(ms, 500);
    for (const double triangles : column("visible_triangles")) EXPECT_GT(triangles, 10'000);
    const auto drawn = column("drawn_triangles"), visible = column("visible_triangles");
    for (std::size_t i = 0; i < 8; ++i) EXPECT_LE(drawn[i], visible[i]);
  }
}

TEST_F(SceneRender, StatisticsAloneDrawNothing) {
  const Outcome outcome = render({"--orbit", "4", "--stats-only", "-o", folder_ / "frames"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(column("drawn_triangles").size(), 4u);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "frames/frame-00000.png"));
}

TEST_F(SceneRender, APartThatIsDamagedIsAnErrorAndTheRestIsDrawn) {
  std::string bytes = read_text(file());
  for (std::size_t i = bytes.size() - 200; i < bytes.size() - 100; ++i)
    bytes[i] = static_cast<char>(~bytes[i]);
  std::ofstream(file(), std::ios::binary) << bytes;
  const Outcome outcome = render({"-o", folder_ / "still.png", "--tau", "0.001"});
  EXPECT_EQ(outcome.status, 3) << outcome.err;
  EXPECT_NE(outcome.err.find("part "), std::string::npos) << outcome.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "still.png"));
}

}  // namespace
}  // namespace cuesta::test
