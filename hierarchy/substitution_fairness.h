#pragma once
/// Fairness predicates of the greedy framework (greedy_substitution.h): what a substitution costs.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "hierarchy/substitution_kernel.h"

namespace cuesta {

/// Distance from the planes that the vertex stands for. Source: Garland, Heckbert, SIGGRAPH 1997 (quadric.h).
class QuadricFairness {
 public:
  explicit QuadricFairness(const SubstitutionKernel& kernel) : kernel_(kernel) {}
  static constexpr bool never_falls = true;
  void costs(PointId u, std::span<const PointId> targets, std::span<float> out) const {
    for (std::size_t i = 0; i < targets.size(); ++i) out[i] = kernel_.cost(u, targets[i]);
  }
  void applied(PointId, PointId) {}

 private:
  const SubstitutionKernel& kernel_;
};

/// Change of volume, of area times length, of normals. Source: TOM §4.1.
class MemorylessFairness {
 public:
  explicit MemorylessFairness(const SubstitutionKernel& kernel) : kernel_(kernel) {}

  static constexpr bool never_falls = false;

  void costs(PointId u, std::span<const PointId> targets, std::span<float> out) {
    const auto at = kernel_.positions();
    const Vec3f pu = at[u];
    sides_.clear();
    Vec3f normal;
    float area = 0;
    for (const TriangleId t : kernel_.star(u)) {
      const auto& c = kernel_.corners(t);
      const int i = c[0] == u ? 0 : c[1] == u ? 1 : 2;
      Side s{c[(i + 1) % 3], c[(i + 2) % 3], at[c[(i + 1) % 3]] - pu, at[c[(i + 2) % 3]] - pu, {}};
      s.normal = cross(s.from, s.to);
      normal = normal + s.normal;
      area += length(s.normal);
      sides_.push_back(s);
    }
    normal = normalized(normal);
    for (std::size_t i = 0; i < targets.size(); ++i) out[i] = cost(targets[i], at[targets[i]] - pu, normal, area);
  }
  void applied(PointId, PointId) {}

 private:
  static constexpr float inversion_weight = 100, normal_weight = 0.1f;
  /// A triangle around u: its other corners, and where they are from u.
  struct Side {
    PointId a, b;
    Vec3f from, to, normal;
  };

  /// @param way  from u to v
  float cost(PointId v, Vec3f way, Vec3f normal_before, float area_before) const {
    float volume = 0, area = 0, turned = 0;
    Vec3f normal;
    for (const Side& s : sides_) {
      if (s.a == v || s.b == v) continue;
      const Vec3f after = cross(s.from - way, s.to - way);
      const float size = length(after);
      normal = normal + after;
      volume += std::abs(dot(s.normal, way));
      area += size;
      if (dot(s.normal, after) < 0) turned += size;
    }
    const float l = length(way);
    return volume / 6 + l * std::abs(area - area_before) / 2 + inversion_weight * l * turned +
           normal_weight * l * l * l * (1 - std::min(1.0f, dot(normal_before, normalized(normal))));
  }

  const SubstitutionKernel& kernel_;
  std::vector<Side> sides_;
};

}  // namespace cuesta
