/// The whole way through the built executable: mesh in, .cuesta file, cuts and pictures out.

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "ooc/mesh_writer.h"
#include "runtime/draw/png_file.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"

namespace cuesta::test {
namespace {

using nlohmann::json;

/// A sphere of 19,800 triangles, built once for all tests of this file.
class CuestaCommand : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder = new TestFolder;
    ASSERT_TRUE(write_mesh(mesh_path(), bumpy_sphere(100, 100)));
    built = run(*folder, {"build", mesh_path(), "-o", file(), "--cell", "2048", "--threads", "2"});
    ASSERT_EQ(built.status, 0) << built.err;
  }
  static void TearDownTestSuite() { delete folder; }

  static std::string mesh_path() { return *folder / "sphere.ply"; }
  static std::string file() { return *folder / "sphere.cuesta"; }
  static Outcome cuesta(std::vector<std::string> words) { return run(*folder, std::move(words)); }
  /// Runs `words`, which must succeed, and parses what they print.
  static json cuesta_json(std::vector<std::string> words) {
    words.push_back("--json");
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return json::parse(outcome.out, nullptr, false);
  }
  static json exported(const std::string& name, std::vector<std::string> how) {
    std::vector<std::string> words{"export", file(), "-o", *folder / name};
    words.insert(words.end(), how.begin(), how.end());
    return cuesta_json(std::move(words));
  }
  static json measured(const std::string& name) {
    return cuesta_json({"measure", mesh_path(), *folder / name, "--samples", "20000"});
  }
  static std::size_t drawn_pixels(const std::string& name) {
    const auto picture = read_png(*folder / name);
    if (!picture) return 0;
    return static_cast<std::size_t>(
        std::count_if(picture->pixels.begin(), picture->pixels.end(), [](const Rgba8& p) {
          return p != Rgba8{255, 255, 255, 255};
        }));
  }

  static TestFolder* folder;
  static Outcome built;
};

TestFolder* CuestaCommand::folder = nullptr;
Outcome CuestaCommand::built;

TEST_F(CuestaCommand, BuildTellsASummaryAndInfoTheSame) {
  EXPECT_NE(built.out.find("19,800 triangles"), std::string::npos) << built.out;
  const json info = cuesta_json({"info", file(), "--pages"});
  EXPECT_EQ(info["triangles"], 19800);
  EXPECT_EQ(info["vertices"], 9902);
  EXPECT_GE(info["rounds"].size(), 2u);
  EXPECT_EQ(info["pages"].size(), info["page_count"]);
  EXPECT_EQ(info["metadata"]["inputs"][0]["name"], "sphere.ply");
  EXPECT_EQ(info["metadata"]["read"]["triangles"], 19800);
  EXPECT_EQ(info["file_bytes"], std::filesystem::file_size(file()));
  EXPECT_NEAR(info["bounds"]["lo"][0], 8.95, 0.1);
}

TEST_F(CuestaCommand, ProgressOnNoTerminalIsPlainLines) {
  EXPECT_EQ(built.err.find('\r'), std::string::npos);
  EXPECT_EQ(built.err.find('\x1b'), std::string::npos);
  for (const char* stage : {"read", "clean", "build"})
    EXPECT_NE(built.err.find(stage), std::string::npos) << stage;
  EXPECT_EQ(cuesta({"build", mesh_path(), "-o", *folder / "quiet.cuesta", "--quiet"}).err, "");
}

TEST_F(CuestaCommand, SameBytesForAnyThreadsAndMemory) {
  const auto other = *folder / "other.cuesta";
  const auto outcome = cuesta(
      {"build", mesh_path(), "-o", other, "--cell", "2048", "--threads", "1", "--memory", "1G", "--quiet"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(read_text(other) == read_text(file()));
}

TEST_F(CuestaCommand, SameBytesFromAnyFolder) {
  const auto elsewhere = *folder / "elsewhere";
  std::filesystem::create_directory(elsewhere);
  std::filesystem::copy_file(mesh_path(), elsewhere / "sphere.ply");
  const std::string other = *folder / "from_elsewhere.cuesta";
  ASSERT_EQ(
      cuesta({"build", elsewhere / "sphere.ply", "-o", other, "--cell", "2048", "--temp", elsewhere}).status,
      0);
  EXPECT_TRUE(read_text(other) == read_text(file()));
}

TEST_F(CuestaCommand, ABuildThatWouldChangeNothingIsNotDone) {
  const std::string mesh = *folder / "again.ply", out = *folder / "again.cuesta";
  ASSERT_TRUE(write_mesh(mesh, bumpy_sphere(20, 20)));
  const auto build = [&](std::vector<std::string> more) {
    std::vector<std::string> words{"build", mesh, "-o", out};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(std::move(words));
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome;
  };
  const auto is_done = [](const Outcome& outcome) {
    return outcome.out.find("up to date") == std::string::npos;
  };
  const Outcome first = build({});
  EXPECT_TRUE(is_done(first));
  EXPECT_NE(first.err.find("fingerprint"), std::string::npos) << first.err;
  const std::string bytes = read_text(out);
  EXPECT_FALSE(is_done(build({})));
  EXPECT_FALSE(is_done(build({"--threads", "1", "--memory", "1G"})));
  EXPECT_TRUE(read_text(out) == bytes);
  EXPECT_TRUE(is_done(build({"--force"})));
  EXPECT_TRUE(read_text(out) == bytes);

  EXPECT_TRUE(is_done(build({"--cell", "256"})));
  EXPECT_TRUE(is_done(build({"--no-normals"})));
  EXPECT_TRUE(is_done(build({})));
  const auto long_ago = std::filesystem::file_time_type::clock::now() - std::chrono::hours(24 * 365 * 20);
  std::filesystem::last_write_time(out, long_ago);
  EXPECT_TRUE(is_done(build({}))) << "the program is newer";
  ASSERT_TRUE(write_mesh(mesh, bumpy_sphere(20, 21)));
  EXPECT_TRUE(is_done(build({})));
  EXPECT_FALSE(is_done(build({})));
  std::filesystem::resize_file(out, std::filesystem::file_size(out) - 1);
  EXPECT_TRUE(is_done(build({}))) << "the output is damaged";
}

TEST_F(CuestaCommand, InputsThatNameOtherFilesAreAlwaysBuilt) {
  const std::string gltf = *folder / "named.gltf", out = *folder / "named.cuesta";
  std::ofstream(*folder / "named.bin", std::ios::binary) << std::string(
      "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0"
      "\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0",
      36);
  std::ofstream(gltf)
      << R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "buffers":[{"uri":"named.bin","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  for (int i = 0; i < 2; ++i) {
    const Outcome outcome = cuesta({"build", gltf, "-o", out});
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.out.find("up to date"), std::string::npos);
  }
  EXPECT_FALSE(cuesta_json({"info", out})["metadata"].contains("fingerprint"));
}

/// The northern and the southern half of a sphere; only one of them has colours, only the other normals.
void write_halves(const std::string& north, const std::string& south) {
  SurfaceMesh mesh = bumpy_sphere(40, 40), half = mesh;
  mesh.normals.clear();
  mesh.colours.assign(mesh.positions.size(), Rgba8{200, 10, 10, 255});
  half.normals.assign(half.positions.size(), Vec3f{0, 0, 1});
  const std::size_t middle = mesh.triangles.size() / 2;
  half.triangles.erase(half.triangles.begin(), half.triangles.begin() + static_cast<std::ptrdiff_t>(middle));
  mesh.triangles.resize(middle);
  half.colours.clear();
  ASSERT_TRUE(write_mesh(north, mesh));
  ASSERT_TRUE(write_mesh(south, half));
}

TEST_F(CuestaCommand, SeveralInputsAreOneSurface) {
  const std::string north = *folder / "north.ply", south = *folder / "south.ply",
                    out = *folder / "halves.cuesta";
  write_halves(north, south);
  const std::size_t all = bumpy_sphere(40, 40).triangles.size();
  EXPECT_EQ(cuesta({"build", north, south}).status, 1);
  const Outcome missing = cuesta({"build", north, *folder / "nothing.ply", "-o", out});
  EXPECT_EQ(missing.status, 2);
  EXPECT_NE(missing.err.find("nothing.ply"), std::string::npos) << missing.err;
  EXPECT_FALSE(std::filesystem::exists(out + ".work")) << "told before the first is read";
  EXPECT_EQ(cuesta({"build", north, south, "-o", south}).status, 5);
  const Outcome outcome = cuesta({"build", north, south, "-o", out});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("2 files"), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("without colours: white"), std::string::npos) << outcome.out;
  const json info = cuesta_json({"info", out});
  EXPECT_EQ(info["triangles"], all);
  const json& metadata = info["metadata"];
  EXPECT_EQ(metadata["inputs"][1]["name"], "south.ply");
  EXPECT_EQ(metadata["inputs"][1]["bytes"], std::filesystem::file_size(south));
  EXPECT_EQ(metadata["inputs"][0]["triangles"].get<std::size_t>() +
                metadata["inputs"][1]["triangles"].get<std::size_t>(),
            all);
  EXPECT_EQ(metadata["missing"]["colours"], metadata["inputs"][1]["vertices"]);
  EXPECT_EQ(metadata["missing"]["normals"], metadata["inputs"][0]["vertices"]);
  EXPECT_EQ(metadata["missing"]["texcoords"], 0);
}

TEST_F(CuestaCommand, ExportByErrorKeepsIt) {
  for (const char* error : {"0.05", "0.01", "0.002"}) {
    const json cut = exported("error.ply", {"--error", error});
    EXPECT_LE(cut["error_bound"], std::stod(error) * (1 + 1e-12));
    EXPECT_LE(measured("error.ply")["vertices_of_a_max"], cut["error_bound"]) << error;
    EXPECT_LT(cut["triangles"], 19800);
  }
}

TEST_F(CuestaCommand, ExportByTrianglesKeepsTheCountAndTheBound) {
  for (const int triangles : {300, 2000, 10000}) {
    const json cut = exported("count.ply", {"--triangles", std::to_string(triangles)});
    EXPECT_LE(cut["triangles"], triangles);
    EXPECT_GE(cut["triangles"], triangles * 9 / 10);
    EXPECT_LE(measured("count.ply")["vertices_of_a_max"], cut["error_bound"]) << triangles;
  }
}

TEST_F(CuestaCommand, FullExportIsTheInputOnTheGrid) {
  const json cut = exported("full.ply", {"--full"});
  EXPECT_EQ(cut["triangles"], 19800);
  EXPECT_EQ(cut["error_bound"], cut["snapping_error"]);
  EXPECT_LE(measured("full.ply")["symmetric"]["max"], cut["snapping_error"].get<double>() * 1.001);
}

TEST_F(CuestaCommand, ExportOfAViewIsFinerNearTheEye) {
  const json near = exported("view.glb", {"--camera", "eye 10,20,31.5 target 10,20,30", "--tau", "0.5"});
  const json far = exported("view.obj", {"--camera", "eye 10,20,60 target 10,20,30", "--tau", "0.5"});
  EXPECT_LE(near["error_bound_px"], 0.5);
  EXPECT_GT(near["triangles"], far["triangles"]);
}

TEST_F(CuestaCommand, RenderDrawsTheModelInTheMiddle) {
  const auto outcome =
      cuesta({"render", file(), "-o", *folder / "still.png", "--size", "320x200", "--quiet"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto picture = read_png(*folder / "still.png");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width_px, 320);
  EXPECT_NE(picture->pixels[100 * 320 + 160], (Rgba8{255, 255, 255, 255}));
  EXPECT_EQ(picture->pixels[0], (Rgba8{255, 255, 255, 255}));
  // A sphere that fills the height but for a margin covers about 40 % of this picture.
  EXPECT_GT(drawn_pixels("still.png"), 320u * 200 / 4);
  EXPECT_LT(drawn_pixels("still.png"), 320u * 200 / 2);
}

TEST_F(CuestaCommand, FlightGivesFramesStatisticsAndAPlot) {
  const std::string flight = *folder / "zoom.json", frames = *folder / "zoom";
  ASSERT_EQ(cuesta({"flight", file(), "--kind", "zoom-in", "--frames", "6", "-o", flight}).status, 0);
  const auto outcome = cuesta({"render", file(), "--flight", flight, "-o", frames, "--size", "160x100",
                               "--triangles", "3000", "--adapt-ms", "50"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (int i = 0; i < 6; ++i) EXPECT_GT(drawn_pixels("zoom/frame-0000" + std::to_string(i) + ".png"), 1000u);
  const std::string csv = read_text(frames + "/frames.csv");
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 7);
  EXPECT_TRUE(csv.starts_with("frame,time_s,triangles,adapt_ms,"));
  EXPECT_NE(read_text(frames + "/frames.svg").find("<svg"), std::string::npos);
}

TEST_F(CuestaCommand, StatsOnlyDrawsNothing) {
  const std::string frames = *folder / "stats";
  ASSERT_EQ(cuesta({"render", file(), "--orbit", "5", "--stats-only", "-o", frames, "--quiet"}).status, 0);
  EXPECT_FALSE(std::filesystem::exists(frames + "/frame-00000.png"));
  EXPECT_TRUE(std::filesystem::exists(frames + "/frames.csv"));
}

TEST_F(CuestaCommand, ADamagedPageIsToldAndDrawnCoarser) {
  const auto damaged = *folder / "damaged.cuesta";
  const json info = cuesta_json({"info", file(), "--pages"});
  std::string bytes = read_text(file());
  bytes[info["pages"][0]["offset"].get<std::size_t>() + 100] ^= 0x55;
  std::ofstream(damaged, std::ios::binary) << bytes;
  const std::string picture = *folder / "damaged.png";
  const auto rendered = cuesta({"render", damaged, "-o", picture, "--tau", "0", "--size", "160x100"});
  EXPECT_EQ(rendered.status, 3) << rendered.err;
  EXPECT_NE(rendered.err.find("page 0"), std::string::npos) << rendered.err;
  EXPECT_GT(drawn_pixels("damaged.png"), 1000u);
  EXPECT_EQ(cuesta({"export", damaged, "-o", *folder / "damaged.ply", "--full"}).status, 3);
  EXPECT_FALSE(std::filesystem::exists(*folder / "damaged.ply"));
}

TEST_F(CuestaCommand, ExitStatusesAreThoseDocumented) {
  const std::string nothing = *folder / "nothing", out = *folder / "out.ply";
  EXPECT_EQ(cuesta({}).status, 1);
  EXPECT_EQ(cuesta({"fly"}).status, 1);
  EXPECT_EQ(cuesta({"build"}).status, 1);
  EXPECT_EQ(cuesta({"build", mesh_path(), "--memory", "lots"}).status, 1);
  EXPECT_EQ(cuesta({"export", file(), "-o", out}).status, 1);
  EXPECT_EQ(cuesta({"export", file(), "-o", out, "--full", "--error", "1"}).status, 1);
  EXPECT_EQ(cuesta({"render", file(), "--camera", "eye 1,2,3"}).status, 1);
  EXPECT_EQ(cuesta({"build", nothing}).status, 2);
  EXPECT_EQ(cuesta({"info", nothing}).status, 2);
  EXPECT_EQ(cuesta({"render", nothing}).status, 2);
  EXPECT_EQ(cuesta({"measure", nothing, mesh_path()}).status, 2);
  EXPECT_EQ(cuesta({"info", mesh_path()}).status, 3);
  EXPECT_EQ(cuesta({"export", file(), "-o", *folder / "out.txt", "--full"}).status, 5);
  EXPECT_EQ(cuesta({"build", mesh_path(), "-o", out, "--memory", "2M"}).status, 5);
  EXPECT_EQ(cuesta({"--version"}).status, 0);
  EXPECT_EQ(cuesta({"--help"}).status, 0);
}

TEST_F(CuestaCommand, EveryCommandHelpsWithAnExample) {
  for (const char* command : {"build", "info", "render", "flight", "export", "measure"}) {
    const auto outcome = cuesta({command, "--help"});
    EXPECT_EQ(outcome.status, 0);
    EXPECT_NE(outcome.out.find("cuesta " + std::string(command) + " "), std::string::npos) << command;
    EXPECT_NE(outcome.out.find("Example"), std::string::npos) << command;
  }
}

/// A larger mesh that is built with interruptions, and the bytes that it gives without.
class InterruptedBuild : public CuestaCommand {
 protected:
  void SetUp() override {
    if (!expected.empty()) return;
    ASSERT_TRUE(write_mesh(mesh(), bumpy_sphere(300, 300)));
    const Outcome whole = cuesta(command());
    ASSERT_EQ(whole.status, 0) << whole.err;
    expected = read_text(out());
    TearDown();
  }
  void TearDown() override {
    for (const std::string& left : {out(), part(), work()}) std::filesystem::remove_all(left);
  }
  static std::string mesh() { return *folder / "large.ply"; }
  static std::string out() { return *folder / "large.cuesta"; }
  static std::string part() { return out() + ".part"; }
  static std::string work() { return out() + ".work"; }
  static std::vector<std::string> command() {
    return {"build", mesh(), "-o", out(), "--cell", "1024", "--threads", "1", "--force"};
  }
  static bool has_bytes(const std::string& path) {
    std::error_code failed;
    const auto bytes = std::filesystem::file_size(path, failed);
    return !failed && bytes > 0;
  }
  /// Starts the build and sends it the signal as soon as `path` is a file with something in it.
  static Outcome interrupted(int signal, const std::string& path) {
    Program program(*folder, command());
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!has_bytes(path) && std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_EQ(kill(program.id(), signal), 0);
    return program.wait();
  }
  static void expect_kept() {
    EXPECT_FALSE(std::filesystem::exists(out()));
    EXPECT_TRUE(has_bytes(work() + "/journal.sqlite"));
  }
  /// The build to its end, from what is there.
  static void expect_the_same(bool resumed, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = command();
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(words);
    ASSERT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("going on") != std::string::npos, resumed) << outcome.err;
    EXPECT_TRUE(read_text(out()) == expected);
    EXPECT_FALSE(std::filesystem::exists(part()));
    EXPECT_FALSE(std::filesystem::exists(work()));
  }

  static std::string expected;
};

std::string InterruptedBuild::expected;

TEST_F(InterruptedBuild, AStopKeepsWhatIsDoneAndTheNextRunGoesOn) {
  const Outcome outcome = interrupted(SIGINT, part());
  EXPECT_EQ(outcome.status, 8) << outcome.err;
  EXPECT_NE(outcome.err.find("cancelled"), std::string::npos) << outcome.err;
  EXPECT_NE(outcome.err.find("goes on from here"), std::string::npos) << outcome.err;
  EXPECT_TRUE(has_bytes(part()));
  expect_kept();
  expect_the_same(true);
}

TEST_F(InterruptedBuild, ResumeNeverStartsOver) {
  EXPECT_EQ(interrupted(SIGINT, part()).status, 8);
  expect_kept();
  expect_the_same(false, {"--resume", "never"});
}

TEST_F(InterruptedBuild, KilledThreeTimesGivesTheSameBytes) {
  for (const std::string& moment : {work() + "/positions", work() + "/chunks", part()}) {
    EXPECT_EQ(interrupted(SIGKILL, moment).status, -SIGKILL) << moment;
    expect_kept();
  }
  expect_the_same(true);
}

/// Files may not grow beyond `bytes` in a program that is started meanwhile, as under `ulimit -f`.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  rlimit before_{};
};

TEST_F(InterruptedBuild, AFileSizeLimitIsToldAndLosesNothing) {
  const auto limited = [](rlim_t bytes) {
    std::optional<FileSizeLimit> limit(bytes);
    Program program(*folder, command());
    limit.reset();
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 7) << outcome.err;
    EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
    return outcome.err;
  };
  // Too little for the vertices that were read; then for the triangles with their corners.
  EXPECT_NE(limited(500'000).find("positions"), std::string::npos);
  expect_kept();
  EXPECT_NE(limited(4'000'000).find("soup"), std::string::npos);
  expect_kept();
  // Too little for the file itself.
  EXPECT_EQ(interrupted(SIGINT, part()).status, 8);
  EXPECT_NE(limited(std::filesystem::file_size(part()) + 1000).find(part()), std::string::npos);
  expect_kept();
  expect_the_same(true);
}

TEST_F(CuestaCommand, AnInputThatIsCutWhileItIsReadIsToldAndNothingIsLost) {
  const std::string mesh = *folder / "cut.stl", out = *folder / "cut.cuesta", work = out + ".work";
  const std::uint32_t triangles = 8'000'000;
  {
    std::ofstream file(mesh, std::ios::binary);
    file << std::string(80, ' ');
    file.write(reinterpret_cast<const char*>(&triangles), 4);
  }
  std::filesystem::resize_file(mesh, 84 + std::uintmax_t{50} * triangles);  // a hole: no disk
  Program program(*folder, {"build", mesh, "-o", out, "--threads", "1"});
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  std::error_code failed;
  for (std::uintmax_t bytes = 0; bytes == 0 || failed;
       bytes = std::filesystem::file_size(work + "/positions", failed)) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::filesystem::resize_file(mesh, 10'000);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 6) << outcome.err;
  EXPECT_NE(outcome.err.find(mesh + ": the file became shorter while it was read"), std::string::npos)
      << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(out));
  EXPECT_TRUE(std::filesystem::exists(work + "/journal.sqlite"));
  std::filesystem::remove_all(work);
}

/// 60 by 60 quads from `x` on.
SurfaceMesh tile(double x) {
  SurfaceMesh mesh;
  constexpr std::uint32_t n = 60;
  for (std::uint32_t i = 0; i <= n; ++i)
    for (std::uint32_t j = 0; j <= n; ++j) mesh.positions.push_back({x + j, double(i), std::sin(0.2 * i)});
  for (std::uint32_t i = 0; i < n; ++i)
    for (std::uint32_t j = 0; j < n; ++j) {
      const std::uint32_t a = i * (n + 1) + j, c = a + n + 1;
      mesh.triangles.push_back({a, a + 1, c + 1});
      mesh.triangles.push_back({a, c + 1, c});
    }
  return mesh;
}

TEST_F(CuestaCommand, WeldJoinsBordersOfTilesWithTheSameBytes) {
  const std::string west = *folder / "west.ply", east = *folder / "east.ply";
  ASSERT_TRUE(write_mesh(west, tile(0)));
  ASSERT_TRUE(write_mesh(east, tile(60.02)));
  const auto build = [&](const std::string& name, std::vector<std::string> more) {
    std::vector<std::string> words{"build", west, east, "-o", *folder / name, "--cell", "512"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = cuesta(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.out;
  };
  const auto bytes = [&](const std::string& name) { return read_text(*folder / name); };
  build("cracked.cuesta", {});
  build("zero.cuesta", {"--weld", "0"});
  EXPECT_TRUE(bytes("zero.cuesta") == bytes("cracked.cuesta"));
  const std::string told = build("welded.cuesta", {"--weld", "0.05"});
  EXPECT_NE(told.find("61 of 480 border points welded within 0.05"), std::string::npos) << told;
  build("again.cuesta", {"--weld", "0.05", "--threads", "3", "--memory", "256M", "--temp", folder->path()});
  EXPECT_TRUE(bytes("again.cuesta") == bytes("welded.cuesta"));
  EXPECT_NE(build("again.cuesta", {"--weld", "0.05"}).find("up to date"), std::string::npos);
  EXPECT_EQ(build("again.cuesta", {"--weld", "0.04"}).find("up to date"), std::string::npos);
  const json info = cuesta_json({"info", *folder / "welded.cuesta"});
  EXPECT_EQ(info["vertices"], 2 * 61 * 61 - 61);
  EXPECT_EQ(info["metadata"]["options"]["weld"], 0.05);
  EXPECT_EQ(info["metadata"]["clean"]["border_points_welded"], 61);
  for (const char* tolerance : {"-1", "nan", "inf", "wide"})
    EXPECT_EQ(cuesta({"build", west, "--weld=" + std::string(tolerance)}).status, 1) << tolerance;
  const Outcome large = cuesta({"build", west, east, "-o", *folder / "large.cuesta", "--weld", "5"});
  EXPECT_EQ(large.status, 5);
  EXPECT_NE(large.err.find("too large"), std::string::npos) << large.err;
}

}  // namespace
}  // namespace cuesta::test
