#pragma once
/// Quadric cost: orders substitutions, bounds nothing.
/// Source: Garland, Heckbert, "Surface Simplification Using Quadric Error Metrics", SIGGRAPH 1997, §4, kept
/// about the vertex's own position instead of a common origin: no cancellation, so `float` suffices at any
/// distance.

#include "ooc/vec.h"

namespace cuesta {

/// q(d) = dᵀ A d + 2 bᵀ d + c for an offset d from the position the quadric is kept about. 44 bytes.
struct Quadric {
  float xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  float bx = 0, by = 0, bz = 0;
  float c = 0;
  float weight = 0;  ///< sum of the plane weights (areas)

  /// Plane through the reference position with unit normal n.
  void add_plane(Vec3f n, float w) {
    xx += w * n.x * n.x;
    xy += w * n.x * n.y;
    xz += w * n.x * n.z;
    yy += w * n.y * n.y;
    yz += w * n.y * n.z;
    zz += w * n.z * n.z;
    weight += w;
  }

  float at(Vec3f d) const {
    const float rx = xx * d.x + xy * d.y + xz * d.z + 2 * bx;
    const float ry = xy * d.x + yy * d.y + yz * d.z + 2 * by;
    const float rz = xz * d.x + yz * d.y + zz * d.z + 2 * bz;
    const float q = rx * d.x + ry * d.y + rz * d.z + c;
    return q > 0 ? q : 0;
  }

  /// Adds `other`, which is kept about a position at offset `d` from this one's.
  void add(const Quadric& other, Vec3f d) {
    const float ax = other.xx * d.x + other.xy * d.y + other.xz * d.z;
    const float ay = other.xy * d.x + other.yy * d.y + other.yz * d.z;
    const float az = other.xz * d.x + other.yz * d.y + other.zz * d.z;
    xx += other.xx;
    xy += other.xy;
    xz += other.xz;
    yy += other.yy;
    yz += other.yz;
    zz += other.zz;
    c += other.c + ax * d.x + ay * d.y + az * d.z - 2 * (other.bx * d.x + other.by * d.y + other.bz * d.z);
    bx += other.bx - ax;
    by += other.by - ay;
    bz += other.bz - az;
    weight += other.weight;
  }
};

}  // namespace cuesta
