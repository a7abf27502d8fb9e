/// I2 legal, I3 saturated, I6 deterministic, and complete source tables, on every kind of surface.

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include "hierarchy/verify_file.h"
#include "hierarchy/verify_script.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

std::string text_of(const VerifyReport& report) {
  std::string text;
  for (const Finding& f : report.findings)
    text += std::string(name(f.check)) + " page " + std::to_string(f.page) + ": " + f.text + "\n";
  return text;
}

class Invariant : public testing::TestWithParam<NamedSurface> {
 protected:
  VerifyReport verified(const BuildOptions& options = small_cells()) {
    build_file(GetParam().make(), folder_ / "a.cuesta", options);
    const auto file = CuestaFile::open(folder_ / "a.cuesta");
    EXPECT_TRUE(file);
    return file ? verify_file(*file).value() : VerifyReport{};
  }
  std::uint64_t found(const VerifyReport& r, Check check) { return r.found[static_cast<std::size_t>(check)]; }
  TemporaryFolder folder_;
};

TEST_P(Invariant, legal) {
  const auto report = verified();
  EXPECT_EQ(found(report, Check::legal), 0u) << text_of(report);
  EXPECT_GE(report.least_cosine, least_turn_cosine);
}

TEST_P(Invariant, saturated) {
  const auto report = verified();
  EXPECT_EQ(found(report, Check::saturated), 0u) << text_of(report);
}

TEST_P(Invariant, complete) {
  const auto report = verified();
  EXPECT_TRUE(report.ok()) << text_of(report);
  EXPECT_TRUE(report.skipped.empty());
}

/// Any cell size gives a right file, also one in which a cell has next to nothing to do.
TEST_P(Invariant, any_cell_size) {
  for (const std::uint32_t cell : {100u, 1500u, 1u << 15}) {
    BuildOptions options;
    options.cell_triangles = cell;
    const auto report = verified(options);
    EXPECT_TRUE(report.ok()) << "cells of " << cell << '\n' << text_of(report);
  }
}

TEST_P(Invariant, deterministic) {
  const tbb::global_control four(tbb::global_control::max_allowed_parallelism, 4);
  std::string first;
  for (const int threads : {1, 2, 4}) {
    tbb::task_arena arena(threads);
    arena.execute([&] { build_file(GetParam().make(), folder_ / "t.cuesta"); });
    const std::string bytes = bytes_of(folder_ / "t.cuesta");
    if (first.empty()) first = bytes;
    EXPECT_EQ(bytes == first, true) << threads << " threads give other bytes";
  }
}

INSTANTIATE_TEST_SUITE_P(of, Invariant, testing::ValuesIn(surfaces()),
                         [](const auto& surface) { return surface.param.name; });

TEST(Build, several_rounds_where_there_is_work) {
  TemporaryFolder folder;
  build_file(bumpy_sphere(28), folder / "a.cuesta");
  const auto file = CuestaFile::open(folder / "a.cuesta");
  ASSERT_TRUE(file);
  EXPECT_GE(file->directory().pages.back().round, 2u);
  EXPECT_EQ(file->directory().triangles, 8u * 28 * 28);
}

TEST(Build, cancelled_leaves_no_file) {
  TemporaryFolder folder;
  const auto built = try_build(bumpy_sphere(20), folder / "a.cuesta", small_cells(), {},
                               [](std::string_view, std::uint64_t, std::uint64_t) { return false; });
  ASSERT_FALSE(built);
  EXPECT_EQ(built.error().code, ErrorCode::cancelled);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.cuesta"));
}

}  // namespace
}  // namespace cuesta::test
