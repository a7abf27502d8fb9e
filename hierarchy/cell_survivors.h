#pragma once
/// What is left of a cell when it has been simplified, with the samples that go on to the next round.

#include "hierarchy/cell_mesh.h"
#include "hierarchy/substitution_kernel.h"
#include "hierarchy/surface_samples.h"

namespace cuesta {

/// Without the balls of births. A triangle's samples are those that SampleChoice keeps, and of a field of
/// heights all at its edges on a rim or beyond them: others may be found again above and below triangles, but
/// these are above and below none.
CellSurvivors survivors_of(const SubstitutionKernel& kernel, const SurfaceSamples& samples);

}  // namespace cuesta
