// Builds in many chunks: the same bytes whatever the memory, the threads and the interruptions; and nothing
// lost when disks are full or fail.

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cerrno>
#include <random>

#include "hierarchy/verify_file.h"
#include "ooc/file_handle.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

/// About 20 chunks of a few cells each.
constexpr BuildWith many_chunks{.chunk_triangles = 400};

BuildOptions tiny_cells() {
  BuildOptions options;
  options.cell_triangles = 128;
  return options;
}

SurfaceMesh surface() {
  return bumpy_sphere(32);
}

const std::string& reference() {
  static const std::string bytes = [] {
    TemporaryFolder folder;
    build_file(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
    return bytes_of(folder / "a.cuesta");
  }();
  return bytes;
}

/// "" or where a file first differs from the reference.
std::string difference(const std::string& bytes) {
  const std::string& expected = reference();
  const auto [a, b] = std::mismatch(expected.begin(), expected.end(), bytes.begin(), bytes.end());
  if (a == expected.end() && b == bytes.end()) return "";
  return "byte " + std::to_string(a - expected.begin()) + " of " + std::to_string(expected.size()) +
         ", found " + std::to_string(bytes.size()) + " bytes";
}

/// Throws the order of vertices and faces away.
SurfaceMesh shuffled(SurfaceMesh mesh) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> place(mesh.positions.size());
  for (std::uint32_t v = 0; v < place.size(); ++v) place[v] = v;
  std::shuffle(place.begin(), place.end(), random);
  SurfaceMesh out = mesh;
  for (std::size_t v = 0; v < place.size(); ++v) out.positions[place[v]] = mesh.positions[v];
  for (auto& t : out.triangles) t = {place[t[0]], place[t[1]], place[t[2]]};
  std::shuffle(out.triangles.begin(), out.triangles.end(), random);
  return out;
}

void expect_sound(const CuestaFile& file) {
  const auto report = verify_file(file);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->ok()) << report->findings.front().text;
}

TEST(OutOfCore, many_chunks_verify) {
  TemporaryFolder folder;
  for (const SurfaceMesh& mesh : {surface(), shuffled(surface())}) {
    build_file(mesh, folder / "a.cuesta", tiny_cells(), many_chunks);
    const auto file = CuestaFile::open(folder / "a.cuesta");
    ASSERT_TRUE(file);
    EXPECT_GE(file->directory().pages.back().round, 3u);
    EXPECT_EQ(file->directory().triangles, mesh.triangles.size());
    expect_sound(*file);
  }
}

TEST(OutOfCore, same_bytes_for_any_threads) {
  TemporaryFolder folder;
  for (const std::size_t threads : {1u, 2u, 4u}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    build_file(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
    EXPECT_EQ(difference(bytes_of(folder / "a.cuesta")), "") << threads;
  }
}

TEST(OutOfCore, same_bytes_for_any_memory) {
  TemporaryFolder folder;
  for (const std::uint64_t mebibytes : {100, 300, 3000}) {
    BuildWith with = many_chunks;
    with.memory_bytes = mebibytes << 20;
    with.block_vertices = mebibytes;  // hundreds of vertices: most triangles reach over several blocks
    build_file(surface(), folder / "a.cuesta", tiny_cells(), with);
    EXPECT_EQ(difference(bytes_of(folder / "a.cuesta")), "") << mebibytes;
  }
}

TEST(OutOfCore, too_little_memory_is_refused_with_what_is_needed) {
  TemporaryFolder folder;
  BuildWith with = many_chunks;
  with.memory_bytes = 1u << 20;
  const auto built = try_build(surface(), folder / "a.cuesta", tiny_cells(), with);
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().code, ErrorCode::out_of_budget);
  EXPECT_NE(built.error().message.find("--memory"), std::string::npos) << built.error().text();
}

/// Stops at every few reports of progress, and goes on.
TEST(OutOfCore, same_bytes_after_interruptions) {
  for (const int patience : {1, 3, 7}) {
    TemporaryFolder folder;
    int runs = 0;
    for (bool done = false; !done; ++runs) {
      ASSERT_LT(runs, 200);
      int calls = 0;
      const auto built =
          try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks,
                    [&](std::string_view, std::uint64_t, std::uint64_t) { return ++calls <= patience; });
      done = built.has_value();
      if (done) break;
      ASSERT_EQ(built.error().code, ErrorCode::cancelled);
      EXPECT_FALSE(std::filesystem::exists(folder / "a.cuesta"));
    }
    EXPECT_GT(runs, 1);
    EXPECT_EQ(difference(bytes_of(folder / "a.cuesta")), "") << patience;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.cuesta.work"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.cuesta.part"));
  }
}

/// One access of all, by number and kind, that fails.
struct Fault {
  static inline std::atomic<int> countdown{-1};
  static inline std::atomic<bool> of_writes{true};
  static inline std::atomic<int> number{ENOSPC};

  static int hook(bool is_write, const std::filesystem::path&, std::uint64_t, std::uint64_t) {
    if (is_write != of_writes) return 0;
    return countdown-- == 0 ? number.load() : 0;
  }
};

/// Fails at the n-th access for many n; each time the next run goes on and gives the same bytes.
void expect_survival(bool writes, int error_number, ErrorCode code) {
  Fault::of_writes = writes;
  Fault::number = error_number;
  int failures = 0;
  for (int n = 0; n < 400; n += 1 + n / 4) {
    TemporaryFolder folder;
    Fault::countdown = n;
    set_file_fault(&Fault::hook);
    const auto failed = try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
    set_file_fault(nullptr);
    if (failed) break;  // fewer accesses than that
    ++failures;
    EXPECT_EQ(failed.error().code, code) << failed.error().text();
    EXPECT_FALSE(failed.error().file.empty()) << failed.error().text();
    EXPECT_FALSE(std::filesystem::exists(folder / "a.cuesta")) << n;
    build_file(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
    EXPECT_EQ(difference(bytes_of(folder / "a.cuesta")), "") << n;
  }
  EXPECT_GT(failures, 8);
}

TEST(OutOfCore, a_full_disk_loses_nothing) {
  expect_survival(true, ENOSPC, ErrorCode::out_of_budget);
}

TEST(OutOfCore, a_failing_disk_loses_nothing) {
  expect_survival(true, EIO, ErrorCode::io);
  expect_survival(false, EIO, ErrorCode::io);
}

TEST(OutOfCore, a_lost_part_is_told) {
  TemporaryFolder folder;
  int calls = 0;
  const auto stopped = try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks,
                                 [&](std::string_view stage, std::uint64_t, std::uint64_t) {
                                   return !stage.starts_with("round 0") || ++calls < 3;
                                 });
  ASSERT_FALSE(stopped);
  ASSERT_TRUE(std::filesystem::remove(folder / "a.cuesta.part"));
  const auto lost = try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
  ASSERT_FALSE(lost);
  EXPECT_NE(lost.error().text().find("start over"), std::string::npos) << lost.error().text();
}

/// Every sixteenth byte of the work file changed: what was written is not what is read.
void damage(const std::filesystem::path& path) {
  std::string bytes = bytes_of(path);
  ASSERT_FALSE(bytes.empty()) << path;
  for (std::size_t i = 0; i < bytes.size(); i += 16) bytes[i] = static_cast<char>(bytes[i] ^ 0x10);
  put_bytes(path, bytes);
}

TEST(OutOfCore, damaged_work_files_are_told) {
  for (const std::string name : {"chunks", "survivors.1"}) {
    TemporaryFolder folder;
    int calls = 0;
    const auto stopped = try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks,
                                   [&](std::string_view stage, std::uint64_t, std::uint64_t) {
                                     return !stage.starts_with("round 0") || ++calls < 3;
                                   });
    ASSERT_FALSE(stopped);
    damage(folder / "a.cuesta.work" / name);
    const auto refused = try_build(surface(), folder / "a.cuesta", tiny_cells(), many_chunks);
    ASSERT_FALSE(refused) << name;
    EXPECT_EQ(refused.error().code, ErrorCode::corrupt) << name;
    EXPECT_NE(refused.error().text().find(name), std::string::npos) << refused.error().text();
    EXPECT_NE(refused.error().text().find("start over"), std::string::npos) << refused.error().text();
  }
}

/// Fewer triangles are left than a cell has, of what was read into many chunks: still one base page.
TEST(OutOfCore, what_is_little_after_cleaning_has_one_base_page) {
  TemporaryFolder folder;
  SurfaceMesh mesh = bumpy_sphere(4);
  const auto once = mesh.triangles;
  for (int copy = 0; copy < 20; ++copy) mesh.triangles.insert(mesh.triangles.end(), once.begin(), once.end());
  build_file(mesh, folder / "a.cuesta", tiny_cells(), many_chunks);
  const auto file = CuestaFile::open(folder / "a.cuesta");
  ASSERT_TRUE(file);
  EXPECT_EQ(file->directory().triangles, once.size());
  expect_sound(*file);
}

TEST(OutOfCore, a_folder_that_is_not_ours_is_left_alone) {
  TemporaryFolder folder;
  std::filesystem::create_directory(folder / "a.work");
  put_bytes(folder / "a.work/letter.txt", "mine");
  const auto refused = WorkFolder::open(folder / "a.work", "one", false);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::invalid_input);
  EXPECT_TRUE(std::filesystem::exists(folder / "a.work/letter.txt"));
}

TEST(OutOfCore, a_work_folder_of_another_build_is_emptied) {
  TemporaryFolder folder;
  const auto path = folder / "a.work";
  {
    auto first = WorkFolder::open(path, "one");
    ASSERT_TRUE(first);
    ASSERT_TRUE(first->journal().record("stage", 0, {}));
    put_bytes(path / "left", "something");
  }
  EXPECT_TRUE(WorkFolder::open(path, "one")->journal().is_resumed());
  const auto other = WorkFolder::open(path, "two");
  ASSERT_TRUE(other);
  EXPECT_FALSE(std::filesystem::exists(path / "left"));
  const auto busy = WorkFolder::open(path, "two");
  ASSERT_FALSE(busy);
  EXPECT_NE(busy.error().message.find("another process"), std::string::npos) << busy.error().text();
}

}  // namespace
}  // namespace cuesta::test
