#include "apps/measure/vertical_error.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "apps/measure/percentiles.h"
#include "apps/measure/posting_bins.h"
#include "ooc/check.h"

namespace cuesta::measure {
namespace {

constexpr double uncovered = -1;  // a distance that is not known
using Range = tbb::blocked_range<std::size_t>;
using Corners = std::array<std::uint32_t, 3>;

/// A posting and its up line.
struct Upright {
  Vec3d at, up;
};

/// On which side of the line the edge from corner a to corner b passes, times twice an area. The edge's two
/// triangles get the same bits with opposite signs: it is always computed from the lower number to the
/// higher.
double side(const Upright& line, const SurfaceMesh& mesh, std::uint32_t a, std::uint32_t b) {
  if (a > b) return -side(line, mesh, b, a);
  return dot(line.up, cross(mesh.positions[a] - line.at, mesh.positions[b] - line.at));
}

/// How far the triangle is along the line; none where the line passes it.
std::optional<double> height_m(const Upright& line, const SurfaceMesh& mesh, const Corners& t) {
  const double w[3] = {side(line, mesh, t[1], t[2]), side(line, mesh, t[2], t[0]),
                       side(line, mesh, t[0], t[1])};
  const auto [least, most] = std::minmax({w[0], w[1], w[2]});
  const double area = w[0] + w[1] + w[2];
  if (area == 0 || (least < 0 && most > 0)) return {};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += w[k] * dot(line.up, mesh.positions[t[k]] - line.at);
  return sum / area;
}

/// The point of a triangle's outline that passes the line most closely.
struct Beside {
  double off_m = 0, height_m = 0;
};

/// None if that is farther than reach_m.
std::optional<Beside> beside(const Upright& line, const SurfaceMesh& mesh, const Corners& t, double reach_m) {
  const auto flattened = [&](Vec3d v) { return v - line.up * dot(line.up, v); };
  std::optional<Beside> nearest;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d from = mesh.positions[t[k]] - line.at,
                edge = mesh.positions[t[(k + 1) % 3]] - mesh.positions[t[k]];
    const Vec3d a = flattened(from), e = flattened(edge);
    const double along = dot(e, e) > 0 ? std::clamp(-dot(a, e) / dot(e, e), 0.0, 1.0) : 0;
    const double off_m = length(a + e * along);
    if (off_m > reach_m || (nearest && off_m >= nearest->off_m)) continue;
    nearest = {off_m, dot(line.up, from + edge * along)};
  }
  return nearest;
}

/// Of the point of the triangle's outline that passes the line most closely; none if that is farther than
/// slack_m.
std::optional<double> height_within(const Upright& line, const SurfaceMesh& mesh, const Corners& t,
                                    double slack_m) {
  if (const auto height = height_m(line, mesh, t)) return height;
  const auto at = beside(line, mesh, t, slack_m);
  return at ? std::optional(at->height_m) : std::nullopt;
}

/// shared = better(shared, candidate) ? candidate : shared, for any number of threads.
template <class Better>
void improve(double& distance, double candidate, const Better& better) {
  std::atomic_ref<double> shared(distance);
  double seen = shared.load(std::memory_order_relaxed);
  while (better(candidate, seen) &&
         !shared.compare_exchange_weak(seen, candidate, std::memory_order_relaxed)) {
  }
}

class Checker {
 public:
  Checker(const SurfaceMesh& mesh, std::span<const Vec3d> postings_m, const UpAt& up)
      : mesh_(mesh),
        postings_m_(postings_m),
        posting_up_(ups(postings_m, up)),
        corner_up_(ups(mesh.positions, up)) {}

  /// Into distances_m, for `ids`: the largest distance along their up lines.
  void measure_exactly(std::span<const std::uint32_t> ids, std::vector<double>& distances_m) const {
    visit_pairs(ids, 0, [&](const Upright& line, const Corners& t, std::uint32_t id) {
      if (const auto h = height_m(line, mesh_, t))
        improve(distances_m[id], std::abs(*h), [](double a, double b) { return a > b; });
    });
  }

  /// The same with slack: the least distance of the triangles within it.
  void measure_with_slack(std::span<const std::uint32_t> ids, double slack_m,
                          std::vector<double>& distances_m) const {
    for (const std::uint32_t id : ids) distances_m[id] = uncovered;
    visit_pairs(ids, slack_m, [&](const Upright& line, const Corners& t, std::uint32_t id) {
      if (const auto h = height_within(line, mesh_, t, slack_m))
        improve(distances_m[id], std::abs(*h), is_nearer);
    });
  }

  /// Into distances_m, for `ids`, which are uncovered: the least distance from the outlines of triangles.
  void measure_beside(std::span<const std::uint32_t> ids, double rim_m,
                      std::vector<double>& distances_m) const {
    visit_pairs(ids, rim_m, [&](const Upright& line, const Corners& t, std::uint32_t id) {
      if (const auto at = beside(line, mesh_, t, rim_m))
        improve(distances_m[id], std::hypot(at->off_m, at->height_m), is_nearer);
    });
  }

 private:
  static bool is_nearer(double a, double b) { return a < b || b == uncovered; }
  static std::vector<Vec3d> ups(std::span<const Vec3d> positions, const UpAt& up) {
    std::vector<Vec3d> out(up ? positions.size() : 0);
    tbb::parallel_for(Range(0, out.size(), 1024), [&](const Range& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) out[i] = up(positions[i]);
    });
    return out;
  }
  UprightTriangle upright(const Corners& t) const {
    UprightTriangle out{};
    for (std::size_t k = 0; k < 3; ++k) {
      out.at[k] = mesh_.positions[t[k]];
      if (!corner_up_.empty()) out.up[k] = corner_up_[t[k]];
    }
    return out;
  }

  /// visit(line, triangle, id) for all that may meet, in parallel over triangles.
  template <class Visit>
  void visit_pairs(std::span<const std::uint32_t> ids, double slack_m, const Visit& visit) const {
    const PostingBins bins(postings_m_, posting_up_, ids);
    tbb::parallel_for(Range(0, mesh_.triangles.size(), 1024), [&](const Range& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const Corners& t = mesh_.triangles[i];
        bins.visit_near(upright(t), slack_m, [&](std::uint32_t id) {
          visit(Upright{postings_m_[id], posting_up_.empty() ? Vec3d{0, 0, 1} : posting_up_[id]}, t, id);
        });
      }
    });
  }

  const SurfaceMesh& mesh_;
  std::span<const Vec3d> postings_m_;
  std::vector<Vec3d> posting_up_, corner_up_;
};

VerticalDeviation summary(std::span<const std::uint32_t> ids, const std::vector<double>& distances_m,
                          double bound_m) {
  VerticalDeviation all;
  std::vector<double> covered;
  covered.reserve(ids.size());
  for (const std::uint32_t id : ids) {
    const double d = distances_m[id];
    if (d == uncovered) {
      ++all.uncovered;
      continue;
    }
    if (covered.empty() || d > all.max_m) {
      all.max_m = d;
      all.worst = id;
    }
    all.beyond += d > bound_m;
    covered.push_back(d);
  }
  all.p999_m = percentiles(std::move(covered)).p999;
  return all;
}

}  // namespace

VerticalError vertical_error(const SurfaceMesh& mesh, std::span<const Vec3d> postings_m,
                             const VerticalOptions& options) {
  CUESTA_CHECK(postings_m.size() < 0xFFFFFFFFu, postings_m.size());
  CUESTA_CHECK(options.slack_m >= 0, options.slack_m);
  std::vector<std::uint32_t> ids;
  ids.reserve(postings_m.size());
  for (std::uint32_t i = 0; i < postings_m.size(); ++i)
    if (is_finite(postings_m[i])) ids.push_back(i);
  const Checker checker(mesh, postings_m, options.up);
  std::vector<double> distances_m(postings_m.size(), uncovered);
  checker.measure_exactly(ids, distances_m);
  VerticalError error;
  error.postings = ids.size();
  error.exact = error.with_slack = summary(ids, distances_m, options.bound_m);
  if (options.rim_m > 0) {
    std::vector<std::uint32_t> open;
    std::copy_if(ids.begin(), ids.end(), std::back_inserter(open),
                 [&](std::uint32_t id) { return distances_m[id] == uncovered; });
    std::vector<double> beside_m(postings_m.size(), uncovered);
    checker.measure_beside(open, options.rim_m, beside_m);
    error.beside = summary(open, beside_m, options.bound_m);
  }
  if (options.slack_m == 0) return error;
  std::vector<std::uint32_t> doubtful;
  std::copy_if(ids.begin(), ids.end(), std::back_inserter(doubtful), [&](std::uint32_t id) {
    return distances_m[id] == uncovered || distances_m[id] > options.bound_m;
  });
  checker.measure_with_slack(doubtful, options.slack_m, distances_m);
  error.with_slack = summary(ids, distances_m, options.bound_m);
  return error;
}

}  // namespace cuesta::measure
