#pragma once
/// Which postings may lie above or below a triangle: their up lines, sorted into bins by where they point.
///
/// On a plane an up line is a point (x, y). On the globe it is a direction, and falls on one of the six faces
/// of a cube about all directions, projected from its centre: there the shadows of a sphere's straight edges
/// are straight.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "ooc/vec.h"

namespace cuesta::measure {

/// Corners with the up vectors there; `up` is not looked at on a plane.
struct UprightTriangle {
  std::array<Vec3d, 3> at, up;
};

/// 8 bytes per posting, and 2 per posting for the bins.
class PostingBins {
 public:
  /// @param ups  as long as `positions`, or empty for (0, 0, 1) everywhere.
  /// @param ids  of the postings that are sorted: indices into positions, which are finite.
  PostingBins(std::span<const Vec3d> positions, std::span<const Vec3d> ups,
              std::span<const std::uint32_t> ids);

  /// Calls visit(id) for all postings whose up line meets the triangle, or passes it by at most `slack_m`;
  /// and for others nearby. Threads: concurrent.
  template <class Visit>
  void visit_near(const UprightTriangle& triangle, double slack_m, const Visit& visit) const {
    for (const Face& face : faces_) {
      const Shadow shadow = shadow_of(triangle, face, slack_m);
      for (std::uint32_t row = shadow.first_row; row < shadow.end_row; ++row) {
        const auto [first, end] = run(face, shadow, row);
        for (std::uint32_t i = first; i < end; ++i) visit(order_[i]);
      }
    }
  }

 private:
  using Point = std::array<double, 2>;
  struct Face {
    int axis = 2;                                    ///< of the cube; the next two, cyclically, are x and y
    double sign = 1;                                 ///< which end of the axis
    Point lo{}, hi{};                                ///< of the shadows of its postings
    double bin = 1;                                  ///< side of a bin
    std::uint32_t columns = 0, rows = 0, first = 0;  ///< number of its first bin
  };
  struct Shadow {
    std::array<Point, 3> corner{};
    double pad = 0;           ///< how far beyond the corners' triangle its shadow may reach
    bool everywhere = false;  ///< too large to have corners on this face
    std::uint32_t first_row = 0, end_row = 0;
  };
  struct Run {
    std::uint32_t first, end;
  };

  bool on_plane() const { return ups_.empty(); }
  Point point_of(std::uint32_t id, const Face& face) const;
  std::size_t face_of(std::uint32_t id) const;
  void lay_out(Face& face, std::uint64_t postings, std::uint32_t first_bin);
  std::uint32_t bin_of(std::uint32_t id) const;
  Shadow shadow_of(const UprightTriangle& triangle, const Face& face, double slack_m) const;
  Run run(const Face& face, const Shadow& shadow, std::uint32_t row) const;

  std::span<const Vec3d> positions_, ups_;
  std::vector<Face> faces_;
  std::vector<std::uint32_t> begin_, order_;  // order_[begin_[b], begin_[b + 1]): the postings of bin b
};

}  // namespace cuesta::measure
