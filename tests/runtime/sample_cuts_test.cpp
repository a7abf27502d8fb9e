/// I1 crack_free and I5 honest_error: uniform and view-dependent cuts, generated surfaces and real scans.

#include <gtest/gtest.h>

#include "apps/verify/sample_cuts.h"
#include "hierarchy/verify_file.h"
#include "ooc/mesh_reader.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"
#include "tests/shared_data.h"

namespace cuesta::test {
namespace {

/// The bound is above the measured distance, and at the median no more than this times it.
constexpr double loosest_bound = 3;

void expect_honest(const std::filesystem::path& path) {
  const auto file = CuestaFile::open(path);
  ASSERT_TRUE(file);
  VerifyReport report = verify_file(*file).value();
  const auto done = verify::verify_cuts(*file, {}, report);
  ASSERT_TRUE(done) << done.error().text();
  for (const Finding& f : report.findings) ADD_FAILURE() << name(f.check) << ": " << f.text;
  EXPECT_TRUE(report.skipped.empty());
  EXPECT_GT(report.cuts, 8u);
  EXPECT_LE(report.median_bound_ratio, loosest_bound);
}

class SampleCuts : public testing::TestWithParam<NamedSurface> {};

TEST_P(SampleCuts, crack_free_and_honest_error) {
  TemporaryFolder folder;
  build_file(GetParam().make(), folder / "a.cuesta");
  expect_honest(folder / "a.cuesta");
}

INSTANTIATE_TEST_SUITE_P(of, SampleCuts, testing::ValuesIn(surfaces()),
                         [](const auto& s) { return s.param.name; });

class RealCuts : public testing::TestWithParam<const char*> {};

TEST_P(RealCuts, crack_free_and_honest_error) {
  CUESTA_NEED_SHARED(path, std::string("mesh/") + GetParam());
  auto mesh = load_mesh(path, std::uint64_t{1} << 30);
  ASSERT_TRUE(mesh) << mesh.error().text();
  TemporaryFolder folder;
  BuildOptions options;
  options.cell_triangles = 8192;
  build_file(std::move(*mesh), folder / "a.cuesta", options);
  expect_honest(folder / "a.cuesta");
}

INSTANTIATE_TEST_SUITE_P(of, RealCuts,
                         testing::Values("bun_zipper.ply", "fandisk.obj", "cow.obj", "gears.stl",
                                         "Laurana50k.ply", "blade.off"));

}  // namespace
}  // namespace cuesta::test
