#include "ooc/crease_normals.h"

#include <algorithm>
#include <numeric>

namespace cuesta {
namespace {

/// A corner, 3 · triangle + k, and one of the two edges that leave it: by the point at the other end.
struct CornerEdge {
  std::uint32_t to = 0;
  std::uint32_t corner = 0;  ///< place among the corners of the point
};

class CreaseNormals {
 public:
  CreaseNormals(SurfaceMesh& mesh, std::span<const std::uint32_t> point)
      : mesh_(mesh), given_(mesh.triangles), point_(point), vertices_(mesh.positions.size()) {}

  void run() {
    if (mesh_.normals.empty()) mesh_.normals.resize(vertices_);
    measure_faces();
    const auto starts = corners_by_point();
    for (std::size_t p = 0; p + 1 < starts.size(); ++p)
      smooth_point(std::span(corners_).subspan(starts[p], starts[p + 1] - starts[p]));
  }

 private:
  Vec3d position(std::uint32_t corner) const { return mesh_.positions[vertex(corner)]; }
  std::uint32_t vertex(std::uint32_t corner) const { return given_[corner / 3][corner % 3]; }

  void measure_faces() {
    face_normals_.reserve(given_.size());
    for (std::uint32_t c = 0; c < 3 * given_.size(); c += 3)
      face_normals_.push_back(
          normalized(cross(position(c + 1) - position(c), position(c + 2) - position(c))));
  }

  /// @return where the corners of each point begin in corners_, and the end
  std::vector<std::uint32_t> corners_by_point() {
    std::vector<std::uint32_t> starts(vertices_ + 1, 0);
    for (const Triangle& t : given_)
      for (const std::uint32_t v : t) ++starts[point_[v] + 1];
    counts_to_starts(starts);
    corners_.resize(3 * given_.size());
    auto next = starts;
    for (std::uint32_t c = 0; c < corners_.size(); ++c) corners_[next[point_[vertex(c)]]++] = c;
    return starts;
  }

  void smooth_point(std::span<const std::uint32_t> corners) {
    const bool is_needed = std::any_of(corners.begin(), corners.end(),
                                       [this](std::uint32_t c) { return has_no_normal(vertex(c)); });
    if (!is_needed) return;
    find_sheets(corners);
    sum_normals(corners);
    give_vertices(corners);
  }

  bool has_no_normal(std::uint32_t v) const { return mesh_.normals[v] == Vec3f{}; }

  /// Which corners are smooth with each other: those of faces that meet gently in an edge, and so on.
  void find_sheets(std::span<const std::uint32_t> corners) {
    sheet_.resize(corners.size());
    std::iota(sheet_.begin(), sheet_.end(), 0u);
    edges_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      for (const std::uint32_t other : {next_half_edge(corners[i]), prev_half_edge(corners[i])})
        edges_.push_back({point_[vertex(other)], i});
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const CornerEdge& a, const CornerEdge& b) { return a.to < b.to; });
    for (std::size_t e = 1; e < edges_.size(); ++e) {
      const CornerEdge &a = edges_[e - 1], &b = edges_[e];
      if (a.to != b.to) continue;
      if (dot(face_normals_[corners[a.corner] / 3], face_normals_[corners[b.corner] / 3]) >= kCreaseCosine)
        join(a.corner, b.corner);
    }
    for (std::uint32_t& s : sheet_) s = root(s);
  }
  std::uint32_t root(std::uint32_t i) {
    while (sheet_[i] != i) i = sheet_[i] = sheet_[sheet_[i]];
    return i;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    a = root(a);
    b = root(b);
    sheet_[std::max(a, b)] = std::min(a, b);
  }

  double angle(std::uint32_t corner) const {
    const Vec3d at = position(corner);
    const Vec3d a = normalized(position(next_half_edge(corner)) - at);
    const Vec3d b = normalized(position(prev_half_edge(corner)) - at);
    return std::acos(std::clamp(dot(a, b), -1.0, 1.0));
  }

  void sum_normals(std::span<const std::uint32_t> corners) {
    sums_.assign(corners.size(), {});
    for (std::size_t i = 0; i < corners.size(); ++i)
      sums_[sheet_[i]] = sums_[sheet_[i]] + face_normals_[corners[i] / 3] * angle(corners[i]);
  }

  /// The first sheet of each vertex keeps it, others get copies.
  void give_vertices(std::span<const std::uint32_t> corners) {
    order_.clear();
    for (std::uint32_t i = 0; i < corners.size(); ++i)
      if (has_no_normal(vertex(corners[i]))) order_.push_back(i);
    std::stable_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::pair(vertex(corners[a]), sheet_[a]) < std::pair(vertex(corners[b]), sheet_[b]);
    });
    std::uint32_t from = kNone, sheet = kNone, to = kNone;
    for (const std::uint32_t i : order_) {
      const std::uint32_t v = vertex(corners[i]);
      if (v != from || sheet_[i] != sheet) to = v != from ? v : copy(v);
      from = v;
      sheet = sheet_[i];
      normals_.push_back({to, vec_cast<float>(normalized(sums_[sheet]))});
      targets_.push_back({corners[i], to});
    }
    for (const auto& [v, normal] : normals_) mesh_.normals[v] = normal;
    for (const auto& [corner, v] : targets_) mesh_.triangles[corner / 3][corner % 3] = v;
    normals_.clear();
    targets_.clear();
  }

  std::uint32_t copy(std::uint32_t v) {
    mesh_.positions.push_back(Vec3d(mesh_.positions[v]));
    mesh_.normals.push_back({});
    if (!mesh_.colours.empty()) mesh_.colours.push_back(Rgba8(mesh_.colours[v]));
    if (!mesh_.texcoords.empty()) mesh_.texcoords.push_back(TexCoord(mesh_.texcoords[v]));
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  SurfaceMesh& mesh_;
  const std::vector<Triangle> given_;  ///< as they were: corners of those in mesh_ become copies
  std::span<const std::uint32_t> point_;
  std::size_t vertices_;  ///< before there were copies
  std::vector<Vec3d> face_normals_;
  std::vector<std::uint32_t> corners_;
  // Of the point at work:
  std::vector<std::uint32_t> sheet_;  ///< per corner: the first corner that it is smooth with
  std::vector<CornerEdge> edges_;
  std::vector<Vec3d> sums_;  ///< per sheet
  std::vector<std::uint32_t> order_;
  std::vector<std::pair<std::uint32_t, Vec3f>> normals_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> targets_;
};

}  // namespace

void add_crease_normals(SurfaceMesh& mesh, std::span<const std::uint32_t> point) {
  CreaseNormals(mesh, point).run();
}

}  // namespace cuesta
