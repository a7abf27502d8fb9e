#pragma once
/// What one cell of a round is given, and the script that simplifying it yields: the pure task of a build.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "hierarchy/error_code.h"
#include "ooc/vec.h"
#include "ooc/vertical.h"

namespace cuesta {

/// Error and ball of the fan that last changed a triangle; zero error for one of the original surface.
struct Birth {
  float error = 0;
  Sphere sphere;
};

/// A triangle takes at most this many samples from one round into the next; which, SampleChoice says. Of a
/// field of heights all those beside or on its rim, too.
inline constexpr std::uint32_t max_triangle_samples = 64;

/// Samples of the original surface that triangles stand for: sample i of triangle t is
/// points[begin[t] + i], grid units. `begin` has one element more than there are triangles.
struct TriangleSamples {
  std::vector<std::uint32_t> begin;
  std::vector<Vec3i> points;
};

/// A cell's triangles at the start of a round, in local numbers. Vertices of one wedge group are consecutive.
struct CellMesh {
  std::vector<Vec3i> positions;
  std::vector<std::uint32_t> wedge_group;  ///< first vertex of the vertex's group
  std::vector<std::uint8_t> locked;        ///< 1: its star is not wholly inside the cell
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Birth> births;  ///< one per triangle; none where nobody asks for balls and earlier errors
  TriangleSamples samples;
  std::optional<Vertical> vertical =
      {};  ///< grid units, of a field of heights: what deviations are measured along
};

/// One substitution of a fan: `vertex` → `target`. Wedges of one group follow each other with `joined` set on
/// all but the first: they are substituted together or not at all.
struct Child {
  std::uint32_t vertex;
  std::uint32_t target;
  ErrorCode8 error;
  bool joined = false;
};

/// An ordered run of substitutions into one centre; errors do not fall along it.
struct Fan {
  std::uint32_t centre;  ///< first vertex of the centre's wedge group
  std::uint32_t first_child;
  std::uint32_t child_count;  ///< entries of `children`, joined ones included
  SphereCode sphere;
};

/// No fan has more children: the runtime counts them in 16 bits.
inline constexpr std::uint32_t max_fan_children = 0xFFFF;

/// Fans in an order in which they can be applied. The first `strict_fans` of them satisfy the link condition;
/// after them the surface is mostly handles and holes, and topology is let go. (0 where a finer page has done
/// so.)
struct Script {
  std::vector<Fan> fans;
  std::vector<Child> children;
  std::uint32_t strict_fans = 0;
};

/// What is left of a cell: surviving triangles (ascending local numbers) with their corners, births and
/// samples, max_triangle_samples at most each and those of rims.
struct CellSurvivors {
  std::vector<std::uint32_t> triangles;
  std::vector<std::array<std::uint32_t, 3>> corners;
  std::vector<Birth> births;
  TriangleSamples samples;
};

}  // namespace cuesta
