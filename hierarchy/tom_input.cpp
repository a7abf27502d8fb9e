#include "hierarchy/tom_input.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "ooc/choose_grid.h"
#include "ooc/spatial_order.h"

namespace cuesta {
namespace {

/// f32 positions are exact multiples of the step, and differences of any two are, too.
constexpr double max_steps = 1 << 23;

bool finite(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

template <class T>
bool equal_bits(const std::vector<T>& values, std::uint32_t a, std::uint32_t b) {
  return values.empty() || std::memcmp(&values[a], &values[b], sizeof(T)) == 0;
}

class Preparation {
 public:
  Preparation(const SurfaceMesh& mesh, TomReport& report)
      : mesh_(mesh), report_(report), vertex_(mesh.positions.size(), kNone) {}

  Result<TomInput> run(double step) {
    keep_finite_triangles();
    auto grid = choose_grid(box_, edge_lengths(), step);
    if (!grid) return fail(grid.error());
    input_.grid = *grid;
    const Vec3d extent = box_.empty() ? Vec3d{} : (box_.hi - grid->origin) / grid->step;
    if (!(std::max({extent.x, extent.y, extent.z}) + 1 < max_steps))
      return fail(ErrorCode::invalid_input, "", "",
                  "the mesh is more than 2^23 grid steps long; use a larger step");
    number_vertices();
    number_triangles();
    return std::move(input_);
  }

 private:
  void keep_finite_triangles() {
    for (const Triangle& t : mesh_.triangles) {
      if (!std::all_of(t.begin(), t.end(), [this](std::uint32_t v) { return finite(mesh_.positions[v]); })) {
        ++report_.bad_triangles;
        continue;
      }
      kept_.push_back(t);
      for (std::uint32_t v : t) {
        box_.add(mesh_.positions[v]);
        vertex_[v] = 0;
      }
    }
  }

  std::vector<double> edge_lengths() const {
    std::vector<double> lengths;
    const std::size_t stride = kept_.size() / kEdgeSampleTriangles + 1;
    for (std::size_t t = 0; t < kept_.size(); t += stride)
      for (std::size_t i = 0; i < 3; ++i)
        lengths.push_back(length(mesh_.positions[kept_[t][i]] - mesh_.positions[kept_[t][(i + 1) % 3]]));
    return lengths;
  }

  /// Used vertices along the curve; those of one place follow each other, lowest number first.
  std::vector<CurveEntry> ordered_vertices() {
    std::vector<CurveEntry> order;
    for (std::uint32_t v = 0; v < vertex_.size(); ++v) {
      if (vertex_[v] == kNone) {
        ++report_.unused_vertices;
        continue;
      }
      const Vec3i g = input_.grid.snap(mesh_.positions[v]);
      order.push_back({morton_key({g.x >> 2, g.y >> 2, g.z >> 2}), v});
    }
    sort_by_key(order);
    for (auto first = order.begin(), last = first; first != order.end(); first = last) {
      last = std::find_if(first, order.end(), [&](const CurveEntry& e) { return e.key != first->key; });
      std::stable_sort(first, last, [this](const CurveEntry& a, const CurveEntry& b) {
        return input_.grid.snap(mesh_.positions[a.index]) < input_.grid.snap(mesh_.positions[b.index]);
      });
    }
    return order;
  }

  void number_vertices() {
    auto& cell = input_.cell;
    for (const CurveEntry& e : ordered_vertices()) {
      const Vec3i g = input_.grid.snap(mesh_.positions[e.index]);
      const auto next = static_cast<std::uint32_t>(cell.positions.size());
      const bool new_point = next == 0 || cell.positions.back() != g;
      if (new_point) input_.first_vertex.push_back(next);
      vertex_[e.index] = new_point ? next : same_wedge(e.index, input_.first_vertex.back());
      if (vertex_[e.index] != next) {
        ++report_.welded_vertices;
        continue;
      }
      cell.positions.push_back(g);
      cell.wedge_group.push_back(input_.first_vertex.back());
      input_.source.push_back(e.index);
    }
    input_.first_vertex.push_back(static_cast<std::uint32_t>(cell.positions.size()));
    cell.locked.assign(cell.positions.size(), 0);
  }

  /// The wedge from `first` on with the attributes of this vertex of the mesh; the next number if it is new.
  std::uint32_t same_wedge(std::uint32_t v, std::uint32_t first) const {
    std::uint32_t w = first;
    for (; w < input_.source.size(); ++w) {
      const std::uint32_t other = input_.source[w];
      if (equal_bits(mesh_.normals, v, other) && equal_bits(mesh_.colours, v, other) &&
          equal_bits(mesh_.texcoords, v, other))
        break;
    }
    return w;
  }

  /// In the order of their lowest vertices: what is near in space is near in the array.
  void number_triangles() {
    auto& cell = input_.cell;
    for (const Triangle& t : kept_) {
      const Triangle n{vertex_[t[0]], vertex_[t[1]], vertex_[t[2]]};
      const auto point = [&](std::size_t i) { return cell.wedge_group[n[i]]; };
      if (point(0) == point(1) || point(1) == point(2) || point(2) == point(0))
        ++report_.degenerate_triangles;
      else
        cell.triangles.push_back(n);
    }
    sort_by_lowest_vertex(cell.triangles, cell.positions.size());
  }

  const SurfaceMesh& mesh_;
  TomReport& report_;
  TomInput input_;
  Box3d box_;
  std::vector<Triangle> kept_;
  std::vector<std::uint32_t>
      vertex_;  // per vertex of the mesh: kNone if no triangle uses it, else its number
};

}  // namespace

Result<TomInput> tom_input(const SurfaceMesh& mesh, double step, TomReport& report) {
  return Preparation(mesh, report).run(step);
}

}  // namespace cuesta
