/// Real scenes: built, opened again, and counted.

#include <gtest/gtest.h>

#include "hierarchy/build_scene.h"
#include "hierarchy/scene_file.h"
#include "hierarchy/scene_tom.h"
#include "tests/hierarchy/built_file.h"
#include "tests/shared_data.h"

namespace cuesta::test {
namespace {

struct RealScene {
  const char* name;
  std::uint64_t instances, parts_read;
  std::uint64_t triangles_read, triangles_clean;  ///< of all instances
};

class RealSceneBuild : public testing::TestWithParam<RealScene> {};

TEST_P(RealSceneBuild, opens_with_its_counts) {
  const RealScene& expected = GetParam();
  CUESTA_NEED_SHARED(path, std::string("scene/") + expected.name);
  const TemporaryFolder folder;
  auto source = open_scene(path, std::uint64_t{256} << 20);
  ASSERT_TRUE(source) << source.error().text();
  auto work = WorkFolder::open(folder / "work", "test");
  ASSERT_TRUE(work);
  MemoryBudget memory(std::uint64_t{256} << 20);
  const auto report = build_scene(**source, folder / "a.cuesta", {}, *work, memory);
  ASSERT_TRUE(report) << report.error().text();
  EXPECT_EQ(report->instances, expected.instances);
  EXPECT_EQ(report->parts_read, expected.parts_read);
  EXPECT_EQ(report->instanced_read, expected.triangles_read);
  EXPECT_EQ(report->instanced_triangles, expected.triangles_clean);
  const CleanReport& c = report->clean;
  EXPECT_EQ(report->triangles + c.faces_degenerate + c.faces_duplicate + c.faces_nonfinite,
            report->read.triangles);
  const auto file = SceneFile::open(folder / "a.cuesta");
  ASSERT_TRUE(file) << file.error().text();
  EXPECT_EQ(file->instances().size(), expected.instances);
  EXPECT_EQ(file->parts().size() + report->parts_equal + report->parts_empty, expected.parts_read);
  std::uint64_t triangles = 0;
  for (std::uint32_t p = 0; p < file->parts().size(); ++p) {
    const auto segments = static_cast<std::uint32_t>(file->parts()[p].segments.size());
    const auto tom = read_tom(*file, p, segments);
    ASSERT_TRUE(tom) << tom.error().text();
    EXPECT_TRUE(is_consistent(*tom));
    triangles += tom->triangles.size();
  }
  EXPECT_EQ(triangles, report->triangles);
  RecordProperty("file_bytes", static_cast<int>(report->file_bytes));
}

INSTANTIATE_TEST_SUITE_P(Shared, RealSceneBuild,
                         testing::Values(RealScene{"LHCb_all.glb.xz", 12916, 1024, 747729, 730586},
                                         RealScene{"ldraw_10283_space_shuttle.glb", 2320, 317, 1290661,
                                                   1290653},
                                         RealScene{"2CylinderEngine.glb", 67, 29, 121496, 110316},
                                         RealScene{"cms.gltf", 2, 2, 10344, 9890}));

}  // namespace
}  // namespace cuesta::test
