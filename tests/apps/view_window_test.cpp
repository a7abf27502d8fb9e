/// cuesta view on a screen in memory: it opens, flies, takes pictures, listens to keys, rests, and ends
/// tidily.

#include <fmt/format.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "ooc/mesh_writer.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/png_file.h"
#include "runtime/flight_file.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"
#include "tests/apps/x_display.h"

namespace cuesta::test {
namespace {

constexpr const char* size = "400x300";

class ViewWindow : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    display = new XDisplay;
    folder = new TestFolder;
    if (!display->running()) return;
    SurfaceMesh mesh = bumpy_sphere(100, 100);
    ASSERT_TRUE(write_mesh(*folder / "sphere.ply", mesh));
    for (Vec3d& p : mesh.positions) p.x += 3;
    ASSERT_TRUE(write_mesh(*folder / "moved.ply", mesh));
    for (const char* name : {"sphere", "moved"}) {
      const std::string base = *folder / name;
      ASSERT_EQ(
          run(*folder, {"build", base + ".ply", "-o", base + ".cuesta", "--cell", "2048", "--quiet"}).status,
          0);
    }
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

  static std::string file() { return *folder / "sphere.cuesta"; }
  static Outcome cuesta(std::vector<std::string> words) { return run(*folder, std::move(words)); }

  /// Runs the viewer up to its screenshot, and closes it.
  static Picture viewed(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"view", "--size", size, "--screenshot", *folder / name, "--exit"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    auto picture = read_png(*folder / name);
    EXPECT_TRUE(picture) << outcome.err;
    return picture ? *picture : Picture{1, 1, {{}}};
  }
  static Picture rendered(const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"render", file(), "--size", size, "-o", *folder / name, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    auto picture = read_png(*folder / name);
    EXPECT_TRUE(picture);
    return picture ? *picture : Picture{1, 1, {{}}};
  }
  static void expect_same(const Picture& a, const Picture& b) {
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    const auto difference = compare(a, b);
    EXPECT_GE(difference.fraction_within(8), 0.99);
    EXPECT_GE(difference.ssim, 0.98);
  }
  static bool wait_for(const std::filesystem::path& path) {
    for (int i = 0; i < 600; ++i) {
      if (std::filesystem::exists(path)) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
    return false;
  }
  /// Processor time of a process so far.
  static double cpu_seconds(pid_t id) {
    std::istringstream fields(read_text(fmt::format("/proc/{}/stat", id)));
    std::string field;
    double ticks = 0;
    for (int i = 1; i <= 15 && fields >> field; ++i)
      if (i >= 14) ticks += std::stod(field);
    return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
  }

  static TestFolder* folder;
  static XDisplay* display;
};

TestFolder* ViewWindow::folder = nullptr;
XDisplay* ViewWindow::display = nullptr;

TEST_F(ViewWindow, OpensFliesAndShowsWhatRenderDraws) {
  const std::string path = *folder / "zoom.json";
  ASSERT_EQ(
      cuesta({"flight", file(), "--kind", "zoom-in", "--frames", "15", "--size", size, "-o", path}).status,
      0);
  auto flight = read_flight(path);
  ASSERT_TRUE(flight);
  flight->keyframes.resize(flight->keyframes.size() * 2 / 3);  // the end is nearer than pixels are useful
  ASSERT_TRUE(write_flight(path, *flight));
  const Keyframe& last = flight->keyframes.back();
  const auto text = [](Vec3d p) { return fmt::format("{:.17g},{:.17g},{:.17g}", p.x, p.y, p.z); };
  const Picture flown = viewed("flown.png", {file(), "--flight", path, "--tau", "2"});
  const Picture still = rendered(
      "still.png", {"--camera", "eye " + text(last.eye) + " target " + text(last.target), "--tau", "2"});
  expect_same(flown, still);
  EXPECT_LT(compare(flown, rendered("start.png", {"--tau", "2"})).fraction_within(8), 0.9) << "it has flown";
}

TEST_F(ViewWindow, FirstPictureIsRendersFirstPicture) {
  expect_same(viewed("first.png", {file()}), rendered("first_rendered.png", {}));
}

TEST_F(ViewWindow, KeysChangeWhatIsShown) {
  expect_same(viewed("wire.png", {file(), "--press", "x h i"}),
              rendered("wire_rendered.png", {"--shading", "wireframe"}));
  expect_same(viewed("coarse.png", {file(), "--press", "] ] ] ] x"}),
              rendered("coarse_rendered.png", {"--tau", "4", "--shading", "wireframe"}));
  expect_same(viewed("normals.png", {file(), "--shading", "pages", "--press", "n"}),
              rendered("normals_rendered.png", {"--shading", "normals"}));
}

TEST_F(ViewWindow, SeveralFilesAreOneWorld) {
  const Picture both = viewed("both.png", {file(), *folder / "moved.cuesta"});
  // The camera fits both: each covers a part of the picture, with the background between and around.
  int runs = 0;
  bool inside = false;
  for (int x = 0; x < both.width_px; ++x) {
    bool drawn = false;
    for (int y = 0; y < both.height_px; ++y)
      drawn =
          drawn || both.pixels[static_cast<std::size_t>(y * both.width_px + x)] != Rgba8{255, 255, 255, 255};
    runs += drawn && !inside;
    inside = drawn;
  }
  EXPECT_EQ(runs, 2);
}

TEST_F(ViewWindow, RestsAndSavesARecordingWhenItIsStopped) {
  Program viewer(*folder, {"view", file(), "--size", size, "--press", "r k"});
  ASSERT_TRUE(wait_for(*folder / "sphere-view-001.png"));
  // The start takes a while on a busy machine; a viewer that draws all the time never rests.
  double used_s = 1;
  for (int i = 0; i < 10 && used_s > 0.1; ++i) {
    const double before = cpu_seconds(viewer.id());
    std::this_thread::sleep_for(std::chrono::seconds(2));
    used_s = cpu_seconds(viewer.id()) - before;
  }
  EXPECT_LE(used_s, 0.1) << "a still picture takes no time";
  ASSERT_EQ(kill(viewer.id(), SIGINT), 0);
  const Outcome outcome = viewer.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  const auto flight = read_flight(*folder / "sphere-flight-001.json");
  ASSERT_TRUE(flight) << outcome.out << outcome.err;
  EXPECT_GE(flight->keyframes.back().time_s, 1.9);
}

TEST_F(ViewWindow, MouseAndKeysOfAPerson) {
  if (std::system("command -v xdotool >/dev/null 2>&1") != 0) GTEST_SKIP() << "xdotool is not installed";
  std::filesystem::remove(*folder / "moved-view-001.png");
  Program viewer(*folder, {"view", *folder / "moved.cuesta", "--size", size, "--press", "k"});
  ASSERT_TRUE(wait_for(*folder / "moved-view-001.png"));
  const int done = std::system(
      "xdotool mousemove 200 150 sleep 0.2 mousedown 1 sleep 0.2 mousemove_relative 80 0 sleep 0.2 mouseup 1 "
      "sleep 0.2 click 4 click 4 sleep 0.3 key k");
  EXPECT_EQ(done, 0);
  const bool saved = wait_for(*folder / "moved-view-002.png");
  EXPECT_EQ(std::system("xdotool keydown ctrl key q keyup ctrl"), 0);
  const Outcome outcome = viewer.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  ASSERT_TRUE(saved);
  const auto before = read_png(*folder / "moved-view-001.png"),
             after = read_png(*folder / "moved-view-002.png");
  ASSERT_TRUE(before && after);
  const auto drawn = [](const Picture& p) {
    return static_cast<double>(p.pixels.size()) -
           static_cast<double>(std::ranges::count(p.pixels, Rgba8{255, 255, 255, 255}));
  };
  EXPECT_GT(drawn(*after), 1.2 * drawn(*before)) << "the wheel brought it nearer";
  EXPECT_LT(compare(*before, *after).fraction_within(8), 0.9);
}

TEST_F(ViewWindow, WithoutADisplayItSaysWhatToDo) {
  const std::string name = std::getenv("DISPLAY");
  unsetenv("DISPLAY");
  const Outcome outcome = cuesta({"view", file()});
  setenv("DISPLAY", name.c_str(), 1);
  EXPECT_EQ(outcome.status, 6) << outcome.err;
  EXPECT_NE(outcome.err.find("cuesta render"), std::string::npos) << outcome.err;
}

TEST_F(ViewWindow, RefusalsComeBeforeAnyWindow) {
  EXPECT_EQ(cuesta({"view", *folder / "nothing.cuesta"}).status, 2);
  EXPECT_EQ(cuesta({"view", file(), "--press", "f99"}).status, 5);
  EXPECT_EQ(cuesta({"view", file(), "--flight", *folder / "nothing.json"}).status, 2);
}

}  // namespace
}  // namespace cuesta::test
