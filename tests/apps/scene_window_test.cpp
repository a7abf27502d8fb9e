/// cuesta view of scenes on a screen in memory: what render shows, policies, clips, parts that are moved,
/// recordings.

#include <fmt/format.h>

#include <chrono>
#include <sstream>
#include <thread>

#include "ooc/mesh_writer.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"
#include "tests/apps/x_display.h"
#include "tests/ooc/gltf_files.h"

namespace cuesta::test {
namespace {

constexpr const char* size = "400x300";

/// Two spheres, 3 apart.
class SceneWindow : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    display = new XDisplay;
    folder = new TestFolder;
    if (!display->running()) return;
    std::filesystem::create_directory(*folder / "parts");
    SurfaceMesh mesh = bumpy_sphere(60, 60);
    ASSERT_TRUE(write_mesh(*folder / "parts/a.ply", mesh));
    for (Vec3d& p : mesh.positions) p.x += 3;
    ASSERT_TRUE(write_mesh(*folder / "parts/b.ply", mesh));
    ASSERT_EQ(cuesta({"build", *folder / "parts", "--type", "scene", "-o", file(), "--quiet"}).status, 0);
    std::filesystem::current_path(folder->path());  // where the viewer saves
  }
  static void TearDownTestSuite() {
    std::filesystem::current_path("/");
    delete folder;
    delete display;
  }
  void SetUp() override {
    if (!display->running()) GTEST_SKIP() << "Xvfb is not installed";
  }

  static std::string file() { return *folder / "scene.cuesta"; }
  static Outcome cuesta(std::vector<std::string> words) { return run(*folder, std::move(words)); }
  static Picture picture_of(const std::string& name) {
    auto picture = read_png(*folder / name);
    EXPECT_TRUE(picture) << name;
    return picture ? *picture : Picture{1, 1, {{}}};
  }
  /// Runs the viewer up to its screenshot, and closes it.
  static Picture viewed(const std::string& name, std::vector<std::string> more,
                        const std::string& scene = file()) {
    std::vector<std::string> words{"view",         scene,    "--size",        size,  "--screenshot",
                                   *folder / name, "--exit", "--deadline-ms", "5000"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return picture_of(name);
  }
  static Picture rendered(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"render", file(), "--size", size, "-o", *folder / name, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return picture_of(name);
  }
  static void expect_same(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    EXPECT_GE(compare(a, b).fraction_within(8), 0.99);
  }
  /// Pixels of a part of the picture, in columns, that are not background.
  static std::ptrdiff_t drawn(const Picture& p, int from, int to) {
    std::ptrdiff_t count = 0;
    for (int y = 0; y < p.height_px; ++y)
      for (int x = from; x < to; ++x)
        count += p.pixels[static_cast<std::size_t>(y * p.width_px + x)] != Rgba8{255, 255, 255, 255};
    return count;
  }
  static bool wait_for(const std::filesystem::path& path) {
    for (int i = 0; i < 600; ++i) {
      if (std::filesystem::exists(path)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }

  static TestFolder* folder;
  static XDisplay* display;
};

TestFolder* SceneWindow::folder = nullptr;
XDisplay* SceneWindow::display = nullptr;

TEST_F(SceneWindow, FirstPictureIsRendersFirstPicture) {
  expect_same(viewed("first.png", {}), rendered("first_rendered.png", {}));
}

TEST_F(SceneWindow, KeysChangeWhatIsShown) {
  expect_same(viewed("wire.png", {"--press", "x i"}),
              rendered("wire_rendered.png", {"--shading", "wireframe"}));
  const Picture fine = viewed("fine.png", {"--tau", "0.1", "--press", "x"});
  const Picture coarse = viewed("coarse.png", {"--tau", "0.1", "--press", "x ] ] ] ] ] ] ] ] ] ] ] ] ] ]"});
  EXPECT_LT(compare(fine, coarse).fraction_within(8), 0.95) << "tau is 128 times as large";
}

TEST_F(SceneWindow, ARecordingIsAFlightAndATableOfItsFrames) {
  const Outcome outcome = cuesta({"view", file(), "--size", size, "--press", "r v v ; v r", "--exit"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto flight = read_flight(*folder / "scene-flight-001.json");
  ASSERT_TRUE(flight) << outcome.out << outcome.err;
  std::istringstream csv(read_text(*folder / "scene-flight-001.csv"));
  std::string head, row;
  std::getline(csv, head);
  for (const char* column : {"visible_triangles", "drawn_triangles", "desired_ms", "predicted_ms",
                             "optimisation_ms", "actual_ms", "outcome"})
    EXPECT_NE(head.find(column), std::string::npos) << column;
  int rows = 0, heuristic = 0;
  bool shortened = false;
  for (; std::getline(csv, row); ++rows) {
    shortened = shortened || row.find(",23.33") != std::string::npos;
    heuristic += row.find("heuristic") != std::string::npos;
  }
  EXPECT_TRUE(shortened) << "; makes 33 ms 23.3";
  EXPECT_GE(rows, 4);
  EXPECT_GE(heuristic, 1) << "V has switched to policies of another kind";
  EXPECT_LT(heuristic, rows) << "and back";
}

TEST_F(SceneWindow, AFlightIsFlown) {
  const std::string path = *folder / "orbit.json";
  ASSERT_EQ(cuesta({"flight", file(), "--frames", "10", "--size", size, "-o", path}).status, 0);
  auto flight = read_flight(path);
  ASSERT_TRUE(flight);
  flight->keyframes.resize(flight->keyframes.size() / 2);
  ASSERT_TRUE(write_flight(path, *flight));
  const Keyframe& last = flight->keyframes.back();
  const auto text = [](Vec3d p) { return fmt::format("{:.17g},{:.17g},{:.17g}", p.x, p.y, p.z); };
  const Picture flown = viewed("flown.png", {"--flight", path});
  expect_same(flown,
              rendered("still.png", {"--camera", "eye " + text(last.eye) + " target " + text(last.target)}));
  EXPECT_LT(compare(flown, viewed("start.png", {})).fraction_within(8), 0.9) << "it has flown";
}

TEST_F(SceneWindow, AClipMovesWhatItMoves) {
  // The triangle goes 4 to the right within 4000 seconds; the second clip is over at once, 4 to the right.
  std::string binary = triangle_binary();
  binary += bytes_of<float>({0, 4000, 0, 0, 0, 4, 0, 0, 0, 1e-6f});
  const std::string json =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":84}],"bufferViews":[{"buffer":0,"byteLength":36},
      {"buffer":0,"byteOffset":36,"byteLength":6},{"buffer":0,"byteOffset":44,"byteLength":8},
      {"buffer":0,"byteOffset":52,"byteLength":24},{"buffer":0,"byteOffset":76,"byteLength":8}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"},
      {"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"},
      {"bufferView":2,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[4000]},
      {"bufferView":3,"componentType":5126,"count":2,"type":"VEC3"},
      {"bufferView":4,"componentType":5126,"count":2,"type":"SCALAR","min":[0],"max":[1e-6]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "nodes":[{"mesh":0},{"mesh":0,"translation":[0,2,0]},{"mesh":0,"translation":[5,0,0]}],
      "animations":[{"name":"slow","channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],
      "samplers":[{"input":2,"output":3}]},
      {"name":"fast","channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],
      "samplers":[{"input":4,"output":3}]}],"scenes":[{"nodes":[0,1,2]}],"scene":0})";
  std::ofstream(*folder / "moving.glb", std::ios::binary) << glb(json, binary);
  const std::string scene = *folder / "moving.cuesta";
  ASSERT_EQ(cuesta({"build", *folder / "moving.glb", "-o", scene, "--quiet"}).status, 0);
  const Picture held = viewed("held.png", {"--press", "o o"}, scene);
  const Picture played = viewed("played.png", {"--press", "m m"}, scene);
  EXPECT_LT(compare(held, played).fraction_within(8), 0.995) << "the clip has put it 2 down";
}

TEST_F(SceneWindow, APartIsMovedWithTheMouse) {
  if (std::system("command -v xdotool >/dev/null 2>&1") != 0) GTEST_SKIP() << "xdotool is not installed";
  Program viewer(*folder, {"view", file(), "--size", size, "--up", "y", "--camera",
                           "eye 11.5,20,36 target 11.5,20,30", "--deadline-ms", "5000", "--press", "k"});
  ASSERT_TRUE(wait_for(*folder / "scene-view-001.png"));
  // The left ball is at a quarter of the picture; the window is at the screen's corner.
  const int done = std::system(
      "xdotool mousemove 135 150 sleep 0.3 keydown ctrl mousedown 1 sleep 0.2 mousemove_relative 0 60 sleep "
      "0.2 "
      "mousemove_relative 0 60 sleep 0.3 mouseup 1 keyup ctrl sleep 0.5 key k");
  EXPECT_EQ(done, 0);
  const bool saved = wait_for(*folder / "scene-view-002.png");
  EXPECT_EQ(std::system("xdotool keydown ctrl key q keyup ctrl"), 0);
  EXPECT_EQ(viewer.wait().status, 0);
  ASSERT_TRUE(saved);
  const Picture before = picture_of("scene-view-001.png"), after = picture_of("scene-view-002.png");
  const auto upper = [](const Picture& p, int from, int to) {
    std::ptrdiff_t count = 0;
    for (int y = 0; y < 150; ++y)
      for (int x = from; x < to; ++x)
        count += p.pixels[static_cast<std::size_t>(y * p.width_px + x)] != Rgba8{255, 255, 255, 255};
    return count;
  };
  EXPECT_GT(upper(before, 0, 200), 1500);
  EXPECT_LT(upper(after, 0, 200), 0.5 * static_cast<double>(upper(before, 0, 200))) << "it has gone down";
  EXPECT_NEAR(static_cast<double>(upper(after, 200, 400)) / static_cast<double>(upper(before, 200, 400)), 1,
              0.05)
      << "the other one has not";
}

TEST_F(SceneWindow, ASceneIsShownByItself) {
  const Outcome outcome = cuesta({"view", file(), file()});
  EXPECT_EQ(outcome.status, 5);
  EXPECT_NE(outcome.err.find("by itself"), std::string::npos) << outcome.err;
  EXPECT_EQ(cuesta({"view", file(), "--shading", "relief"}).status, 5);
}

}  // namespace
}  // namespace cuesta::test
