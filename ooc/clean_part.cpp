#include "ooc/clean_part.h"

#include <algorithm>
#include <numeric>

#include "ooc/choose_grid.h"
#include "ooc/crease_normals.h"
#include "ooc/face_filter.h"
#include "ooc/weld.h"

namespace cuesta {
namespace {

class PartCleaner {
 public:
  explicit PartCleaner(SurfaceMesh mesh) { out_.mesh = std::move(mesh); }

  Result<CleanPart> run(double step, bool make_normals) {
    drop_nonfinite();
    if (mesh().triangles.empty()) return std::move(out_);
    const auto grid = choose_grid(box_of_used(), edge_lengths(), step);
    if (!grid) return fail(grid.error());
    out_.grid = *grid;
    const auto point = snap();
    drop_faults(point);
    if (make_normals) add_crease_normals(mesh(), point);
    return std::move(out_);
  }

 private:
  SurfaceMesh& mesh() { return out_.mesh; }

  void drop_nonfinite() {
    auto& positions = mesh().positions;
    out_.report.nonfinite_vertices = static_cast<std::uint64_t>(
        std::count_if(positions.begin(), positions.end(), [](Vec3d p) { return !is_finite(p); }));
    out_.report.faces_nonfinite = std::erase_if(mesh().triangles, [&](const Triangle& t) {
      return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return !is_finite(positions[v]); });
    });
  }

  Box3d box_of_used() {
    Box3d box;
    for (const Triangle& t : mesh().triangles)
      for (const std::uint32_t v : t) box.add(mesh().positions[v]);
    return box;
  }

  std::vector<double> edge_lengths() {
    std::vector<double> lengths;
    const auto& triangles = mesh().triangles;
    const std::size_t stride = triangles.size() / kEdgeSampleTriangles + 1;
    for (std::size_t t = 0; t < triangles.size(); t += stride)
      for (std::size_t k = 0; k < 3; ++k)
        lengths.push_back(
            length(mesh().positions[triangles[t][k]] - mesh().positions[triangles[t][(k + 1) % 3]]));
    return lengths;
  }

  /// @return per vertex: the number of its point on the grid. Unused vertices go to the first used one's.
  std::vector<std::uint32_t> snap() {
    auto& positions = mesh().positions;
    std::vector<std::uint8_t> used(positions.size(), 0);
    for (const Triangle& t : mesh().triangles)
      for (const std::uint32_t v : t) used[v] = 1;
    const Vec3d somewhere = positions[mesh().triangles.front()[0]];
    VertexTable table;
    table.positions.reserve(positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) {
      if (!used[v]) positions[v] = somewhere;
      out_.report.vertices_unused += !used[v];
      table.positions.push_back(out_.grid.snap(positions[v]));
      const Vec3d snapped = out_.grid.world(table.positions.back());
      out_.snap_error = std::max(out_.snap_error, length(snapped - positions[v]));
      positions[v] = snapped;
    }
    return weld(table).of;
  }

  void drop_faults(const std::vector<std::uint32_t>& point) {
    std::vector<Triangle> corners;
    corners.reserve(mesh().triangles.size());
    for (const Triangle& t : mesh().triangles) corners.push_back({point[t[0]], point[t[1]], point[t[2]]});
    std::vector<std::uint32_t> self(point.size());
    std::iota(self.begin(), self.end(), 0u);
    const auto faults = face_faults(corners, self);
    std::size_t kept = 0;
    for (std::size_t t = 0; t < faults.size(); ++t) {
      out_.report.faces_degenerate += faults[t] == FaceFault::degenerate;
      out_.report.faces_duplicate += faults[t] == FaceFault::duplicate;
      if (faults[t] == FaceFault::none) mesh().triangles[kept++] = mesh().triangles[t];
    }
    mesh().triangles.resize(kept);
  }

  CleanPart out_;
};

}  // namespace

Result<CleanPart> clean_part(SurfaceMesh mesh, double step, bool make_normals) {
  return PartCleaner(std::move(mesh)).run(step, make_normals);
}

}  // namespace cuesta
