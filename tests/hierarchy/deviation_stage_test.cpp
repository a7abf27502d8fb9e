// Substitutions that are measured while the next ones are chosen.
#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include "apps/measure/surface_distance.h"
#include "hierarchy/build_tom.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

/// Enough for several batches, with components that go between them.
SurfaceMesh sphere_among_pebbles() {
  return joined(bumpy_sphere(36), pebbles());
}

Tom tom_on(int threads, const SurfaceMesh& mesh) {
  return tbb::task_arena(threads).execute([&] {
    auto tom = build_tom(mesh);
    EXPECT_TRUE(tom) << tom.error().text();
    return std::move(*tom);
  });
}

TEST(DeviationStage, same_order_and_errors_on_any_number_of_threads) {
  const SurfaceMesh mesh = sphere_among_pebbles();
  const Tom one = tom_on(1, mesh), four = tom_on(4, mesh);
  EXPECT_EQ(one.substitute, four.substitute);
  EXPECT_EQ(one.triangles, four.triangles);
  EXPECT_EQ(one.errors, four.errors);
  EXPECT_GT(four.errors.size(), 10u);
}

TEST(DeviationStage, errors_bound_what_is_measured) {
  const SurfaceMesh mesh = sphere_among_pebbles();
  const Tom tom = tom_on(2, mesh);
  for (const Resolution n :
       {tom.full() - 100, tom.full() - 1024, tom.full() - 1025, tom.full() / 2, tom.full() / 9}) {
    const auto measured = measure::vertex_distance(mesh, measure::make_tree(surface_at(tom, n)));
    EXPECT_GT(measured.percentiles.max, 0) << n;
    EXPECT_LE(measured.percentiles.max, error_at(tom, n) + tom.snap_error + 1e-12) << n;
  }
}

}  // namespace
}  // namespace cuesta::test
