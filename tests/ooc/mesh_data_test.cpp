/// Real meshes: the raw numbers of vertices and triangles that other programs found in them.

#include "tests/ooc/mesh_files.h"
#include "tests/shared_data.h"

namespace cuesta {
namespace {

struct Known {
  const char* name;
  std::uint64_t vertices, triangles;
};

void expect_counts(const Known& known, std::uint64_t memory_bytes) {
  CUESTA_NEED_SHARED(path, known.name);
  test::CheckingSink sink;
  const auto report = read_mesh(path, sink, memory_bytes);
  ASSERT_TRUE(report) << report.error().text();
  EXPECT_EQ(sink.vertex_count, known.vertices);
  EXPECT_EQ(sink.triangle_count, known.triangles);
  EXPECT_EQ(report->faces_out_of_range + report->faces_too_small, 0u);
  sink.expect_in_range();
}

class MeshData : public testing::TestWithParam<Known> {};

TEST_P(MeshData, HasItsKnownCounts) {
  expect_counts(GetParam(), test::test_memory);
}

INSTANTIATE_TEST_SUITE_P(
    All, MeshData,
    testing::Values(Known{"mesh/Laurana50k.ply", 27861, 49954}, Known{"mesh/armadillo.obj", 43243, 86482},
                    Known{"mesh/blade.off", 8231, 16222}, Known{"mesh/bun_zipper.ply", 35947, 69451},
                    Known{"mesh/cheese.off", 8629, 17786}, Known{"mesh/cow.obj", 2903, 5804},
                    Known{"mesh/elephant.off", 2775, 5558}, Known{"mesh/fandisk.obj", 6475, 12946},
                    Known{"mesh/gears.stl", 58278, 19426}, Known{"mesh/hand.off", 1197, 2390},
                    Known{"mesh/head.stl", 353082, 117694}, Known{"mesh/igea.ply", 134345, 268686},
                    Known{"mesh/lucy_100k.ply", 49987, 99970}, Known{"mesh/nefertiti_100k.obj", 49971, 99938},
                    Known{"mesh/rangemap_lato000.ply", 44461, 86766},
                    Known{"mesh/turbineblade.ply", 99519, 199034},
                    Known{"mesh/flightgear_hawaii_tin.drc", 414468, 822242},
                    Known{"mesh/flightgear_oahu_tin.drc", 246344, 488765},
                    Known{"mesh/kamakura_buddha_photogrammetry.drc", 165441, 255646},
                    Known{"scene/2CylinderEngine.glb", 84657, 121496}, Known{"scene/cms.gltf", 31032, 10344},
                    Known{"scene/ldraw_10283_space_shuttle.glb", 812732, 1290661}));

}  // namespace
}  // namespace cuesta
