#include "apps/measure/surface_distance.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/measure/spatial_order.h"
#include "ooc/check.h"

namespace cuesta::measure {
namespace {

/// Queries that share hints and one partial sum: sums are added in this grouping whatever the number of
/// threads.
constexpr std::uint64_t chunk_size = 1024;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double not_measured = std::numeric_limits<double>::quiet_NaN();

struct Sum {
  double distance = 0, square = 0, max = -1;
  Vec3d worst;

  void add(double d, Vec3d p) {
    distance += d;
    square += d * d;
    if (d <= max) return;
    max = d;
    worst = p;
  }
  void add(const Sum& other) {
    distance += other.distance;
    square += other.square;
    if (other.max <= max) return;
    max = other.max;
    worst = other.worst;
  }
};

/// Calls body(chunk, first, last) for the chunks of [0, n).
template <class Body>
void for_chunks(std::uint64_t n, Body body) {
  tbb::parallel_for(std::uint64_t{0}, (n + chunk_size - 1) / chunk_size, [&](std::uint64_t chunk) {
    body(chunk, chunk * chunk_size, std::min(n, (chunk + 1) * chunk_size));
  });
}

/// Triangles along a space-filling curve, with the area before each.
struct AreaTable {
  std::vector<std::uint32_t> order;
  std::vector<double> before;  ///< one more than order
};

AreaTable area_table(const SurfaceMesh& mesh) {
  AreaTable table;
  std::vector<Vec3d> centres(mesh.triangles.size());
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const auto& t = mesh.triangles[i];
    centres[i] = (mesh.positions[t[0]] + mesh.positions[t[1]] + mesh.positions[t[2]]) / 3.0;
  }
  table.order = spatial_order(centres);
  table.before.assign(table.order.size() + 1, 0);
  for (std::size_t i = 0; i < table.order.size(); ++i) {
    const auto& t = mesh.triangles[table.order[i]];
    const Vec3d a = mesh.positions[t[0]];
    const double area = length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a)) / 2;
    table.before[i + 1] = table.before[i] + area;
  }
  return table;
}

double unit_interval(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// SplitMix64's finaliser.
std::uint64_t mixed(std::uint64_t x) {
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ x >> 27) * 0x94d049bb133111ebull;
  return x ^ x >> 31;
}

/// Sample i of a mesh, uniform in its stratum of the area. Inside the triangle: Roberts' R2 sequence, folded.
class Sampler {
 public:
  Sampler(const SurfaceMesh& mesh, const SamplingOptions& options)
      : mesh_(mesh),
        table_(area_table(mesh)),
        options_(options),
        start_(mixed(options.seed + 0x9e3779b97f4a7c15ull)) {}

  double area() const { return table_.before.back(); }

  /// @param place  last triangle used in this chunk, as an index into the table; starts at first_place().
  Vec3d sample(std::uint64_t i, std::size_t& place) const {
    const double jitter = unit_interval(mixed(start_ + i));
    const double at = (static_cast<double>(i) + jitter) / static_cast<double>(options_.samples) * area();
    while (place + 2 < table_.before.size() && table_.before[place + 1] <= at) ++place;
    double u = unit_interval(start_ + i * 0xc13fa9a902a6328full),
           v = unit_interval(mixed(start_) + i * 0x91e10da5c79e7b1dull);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& t = mesh_.triangles[table_.order[place]];
    const Vec3d a = mesh_.positions[t[0]];
    return a + (mesh_.positions[t[1]] - a) * u + (mesh_.positions[t[2]] - a) * v;
  }

  std::size_t first_place(std::uint64_t i) const {
    const double at = static_cast<double>(i) / static_cast<double>(options_.samples) * area();
    const auto above = std::upper_bound(table_.before.begin(), table_.before.end() - 1, at);
    return static_cast<std::size_t>(std::max<std::ptrdiff_t>(above - table_.before.begin() - 1, 0));
  }

 private:
  const SurfaceMesh& mesh_;
  AreaTable table_;
  SamplingOptions options_;
  std::uint64_t start_;
};

Sum sample_area(const SurfaceMesh& from, const TriangleTree& to, const SamplingOptions& options,
                std::uint64_t& samples) {
  const Sampler sampler(from, options);
  samples = sampler.area() > 0 ? options.samples : 0;
  std::vector<Sum> partial((samples + chunk_size - 1) / chunk_size);
  for_chunks(samples, [&](std::uint64_t chunk, std::uint64_t first, std::uint64_t last) {
    std::size_t place = sampler.first_place(first);
    std::uint32_t hint = no_triangle;
    for (std::uint64_t i = first; i < last; ++i) {
      const Vec3d p = sampler.sample(i, place);
      const NearestPoint found = to.nearest(p, hint);
      hint = found.slot;
      partial[chunk].add(std::sqrt(found.distance_sq), p);
    }
  });
  Sum sum;
  for (const Sum& s : partial) sum.add(s);
  return sum;
}

std::vector<bool> used_vertices(const SurfaceMesh& mesh) {
  std::vector<bool> used(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) used[v] = true;
  }
  return used;
}

void finish(VertexDistances& result) {
  std::vector<double> counted;
  counted.reserve(result.distances.size());
  double sum = 0, squares = 0, max = -1;
  for (std::size_t v = 0; v < result.distances.size(); ++v) {
    const double d = result.distances[v];
    if (std::isnan(d)) continue;
    counted.push_back(d);
    sum += d;
    squares += d * d;
    if (d > max) result.worst = static_cast<std::uint32_t>(v);
    max = std::max(max, d);
  }
  if (counted.empty()) return;
  result.mean = sum / static_cast<double>(counted.size());
  result.rms = std::sqrt(squares / static_cast<double>(counted.size()));
  result.percentiles = percentiles(std::move(counted));
}

}  // namespace

TriangleTree make_tree(const SurfaceMesh& mesh) {
  CUESTA_CHECK(is_consistent(mesh));
  return TriangleTree(mesh.positions, mesh.triangles);
}

std::vector<double> point_distances(std::span<const Vec3d> points, const TriangleTree& to) {
  const std::vector<std::uint32_t> order = spatial_order(points);
  std::vector<double> distances(points.size(), not_measured);
  for_chunks(order.size(), [&](std::uint64_t, std::uint64_t first, std::uint64_t last) {
    std::uint32_t hint = no_triangle;
    for (std::uint64_t i = first; i < last; ++i) {
      const NearestPoint found = to.nearest(points[order[i]], hint);
      hint = found.slot;
      distances[order[i]] = std::sqrt(found.distance_sq);
    }
  });
  return distances;
}

VertexDistances vertex_distance(const SurfaceMesh& from, const TriangleTree& to) {
  CUESTA_CHECK(is_consistent(from));
  VertexDistances result;
  result.distances = point_distances(from.positions, to);
  const std::vector<bool> used = used_vertices(from);
  for (std::size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) result.distances[v] = not_measured;
  }
  finish(result);
  return result;
}

DistanceStats surface_distance(const SurfaceMesh& from, const TriangleTree& to,
                               const SamplingOptions& options) {
  DistanceStats stats;
  const VertexDistances vertices = vertex_distance(from, to);
  if (vertices.percentiles.count == 0) return stats;
  const Sum sum = sample_area(from, to, options, stats.samples);
  if (stats.samples > 0) {
    stats.mean = sum.distance / static_cast<double>(stats.samples);
    stats.rms = std::sqrt(sum.square / static_cast<double>(stats.samples));
  }
  const bool at_vertex = vertices.percentiles.max >= sum.max;
  stats.max = at_vertex ? vertices.percentiles.max : sum.max;
  stats.worst = at_vertex ? from.positions[vertices.worst] : sum.worst;
  return stats;
}

SymmetricDistance symmetric_distance(const SurfaceMesh& a, const SurfaceMesh& b,
                                     const SamplingOptions& options) {
  SymmetricDistance d;
  d.forward = surface_distance(a, make_tree(b), options);
  d.backward = surface_distance(b, make_tree(a), options);
  d.mean = (d.forward.mean + d.backward.mean) / 2;
  d.rms = std::sqrt((d.forward.rms * d.forward.rms + d.backward.rms * d.backward.rms) / 2);
  d.max = std::max(d.forward.max, d.backward.max);
  return d;
}

double bounding_diagonal(const SurfaceMesh& mesh) {
  Box3d box;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) box.add(mesh.positions[v]);
  }
  return box.empty() ? 0 : length(box.hi - box.lo);
}

DistanceStats percent_of(const DistanceStats& stats, double diagonal) {
  const double scale = diagonal > 0 ? 100 / diagonal : 0;
  DistanceStats percent = stats;
  percent.mean *= scale;
  percent.rms *= scale;
  percent.max *= scale;
  return percent;
}

SymmetricDistance percent_of(const SymmetricDistance& distance, double diagonal) {
  const double scale = diagonal > 0 ? 100 / diagonal : 0;
  return {percent_of(distance.forward, diagonal), percent_of(distance.backward, diagonal),
          distance.mean * scale, distance.rms * scale, distance.max * scale};
}

}  // namespace cuesta::measure
