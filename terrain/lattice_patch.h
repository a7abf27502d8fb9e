#pragma once
/// The triangles that the postings of a square of lattice make, and how many vertices each posting is.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace cuesta {

/// Which rows of a square are at a pole.
struct PoleRows {
  static constexpr std::int64_t none = -2;
  std::int64_t north = none, south = none;
};

/// Postings are (x, y) from the square's first one; x to the east or whatever columns run to, y with rows.
/// Cell (x, y) is between (x, y) and (x + 1, y + 1): with 4 postings that have heights it makes 2 triangles,
/// with 3 one.
///
/// A posting at which cells with triangles meet only in their corners is a vertex for each of the fans, so
/// that the surface is a manifold: where voids touch, fans 0, 1, …, numbered from the north-east cell round
/// to the south-east.
///
/// Postings of a row at a pole are one place: cells there make the one triangle that their other two postings
/// make with it. How many fans meet at the pole no patch can tell.
class LatticePatch {
 public:
  static constexpr std::uint32_t most_fans = 4;

  /// A corner of a triangle. 0 ≤ x ≤ width, 0 ≤ y ≤ height.
  struct Corner {
    std::uint32_t x = 0, y = 0, fan = 0;
  };

  /// @param has_height  of postings -1 … width + 1 by -1 … height + 1, row by row; not 0: there is one
  LatticePatch(std::uint32_t width, std::uint32_t height, std::span<const std::uint8_t> has_height,
               PoleRows poles = {});

  /// Calls add(corners) for each triangle of the square's own cells, counter-clockwise when rows run from the
  /// north. A corner at a pole is the cell's western one, its fan of no meaning.
  template <class Add>
  void for_triangles(Add add) const {
    for (std::uint32_t y = 0; y < height_; ++y)
      for (std::uint32_t x = 0; x < width_; ++x) add_cell(x, y, add);
  }
  /// Fans of a posting that is at no pole, 0 if it is in no triangle. 0 ≤ x ≤ width, 0 ≤ y ≤ height.
  std::uint32_t fans(std::uint32_t x, std::uint32_t y) const;
  bool has(std::int64_t x, std::int64_t y) const {
    return has_height_[static_cast<std::size_t>((y + 1) * (std::int64_t{width_} + 3) + x + 1)] != 0;
  }

 private:
  /// Cells around a posting, counter-clockwise from the north-east.
  enum Quarter : std::uint32_t { north_east, north_west, south_west, south_east };
  bool is_pole(std::int64_t y) const { return y == poles_.north || y == poles_.south; }
  /// Whether a cell makes a triangle.
  bool is_in(std::int64_t x, std::int64_t y) const {
    const int north = has(x, y) + has(x + 1, y), south = has(x, y + 1) + has(x + 1, y + 1);
    if (is_pole(y)) return south == 2 && north > 0;
    if (is_pole(y + 1)) return north == 2 && south > 0;
    return north + south >= 3;
  }
  /// The fan of each quarter; 0xFF where it makes no triangle with the posting.
  std::array<std::uint8_t, 4> fans_of_quarters(std::int64_t x, std::int64_t y, std::uint32_t& count) const;
  Corner corner(std::uint32_t x, std::uint32_t y, Quarter quarter) const;

  template <class Add>
  void add_cell(std::uint32_t x, std::uint32_t y, Add add) const {
    if (!is_in(x, y)) return;
    const bool nw = has(x, y), ne = has(x + 1, y), sw = has(x, y + 1), se = has(x + 1, y + 1);
    const auto at = [&](bool east, bool south) {
      const Quarter quarter = south ? (east ? north_west : north_east) : (east ? south_west : south_east);
      return corner(x + east, y + south, quarter);
    };
    if (is_pole(y)) return add(std::array{at(false, false), at(false, true), at(true, true)});
    if (is_pole(y + 1)) return add(std::array{at(false, false), at(false, true), at(true, false)});
    if (!nw) return add(std::array{at(true, false), at(false, true), at(true, true)});
    if (!ne) return add(std::array{at(false, false), at(false, true), at(true, true)});
    if (!sw) return add(std::array{at(false, false), at(true, true), at(true, false)});
    add(std::array{at(false, false), at(false, true), at(true, false)});
    if (se) add(std::array{at(true, false), at(false, true), at(true, true)});
  }

  std::uint32_t width_, height_;
  PoleRows poles_;
  std::span<const std::uint8_t> has_height_;
  bool is_full_ = false;  // nothing is missing but what is beyond a straight rim
};

}  // namespace cuesta
