#include "terrain/fill_postings.h"

#include <cmath>
#include <vector>

namespace cuesta {
namespace {

constexpr std::uint64_t none = ~std::uint64_t{0};

/// The data next to a place on a line of postings, on both sides. Places are asked for by rising index.
struct Neighbours {
  std::uint64_t before = none;  ///< the last posting with data before the place
  std::uint64_t after = 0;      ///< the first one at or after it, once it was looked for; the length: none

  /// @param has_data  of an index below `length`.
  template <class HasData>
  void look_after(std::uint64_t place, std::uint64_t length, HasData&& has_data) {
    if (after < place) after = place;
    while (after < length && !has_data(after)) ++after;
  }
};

/// Sums of heights and weights of the data on both sides.
struct Mean {
  double heights = 0, weights = 0;
  void add(double before, double distance_before, double after, double distance_after) {
    heights += before / distance_before + after / distance_after;
    weights += 1 / distance_before + 1 / distance_after;
  }
};

}  // namespace

std::uint64_t fill_postings(std::span<const double> field, std::uint64_t width, std::uint64_t height,
                            const FieldBorder& border, std::uint32_t reach, std::span<double> inner) {
  const std::uint64_t inner_width = width - border.west - border.east;
  std::vector<Neighbours> of_columns(width);
  std::uint64_t filled = 0;
  const auto at = [&](std::uint64_t column, std::uint64_t row) { return field[row * width + column]; };
  const auto add = [&](Mean& mean, const Neighbours& near, std::uint64_t place, std::uint64_t length,
                       auto&& height_at) {
    if (near.before == none || near.after >= length || place - near.before > reach ||
        near.after - place > reach)
      return;
    mean.add(height_at(near.before), double(place - near.before), height_at(near.after),
             double(near.after - place));
  };
  for (std::uint64_t row = 0; row < height - border.south; ++row) {
    Neighbours of_row;
    for (std::uint64_t column = 0; column < width - border.east; ++column) {
      Neighbours& of_column = of_columns[column];
      if (!std::isnan(at(column, row))) {
        of_column.before = row;
        of_row.before = column;
        continue;
      }
      if (row < border.north || column < border.west) continue;
      of_row.look_after(column, width, [&](std::uint64_t c) { return !std::isnan(at(c, row)); });
      of_column.look_after(row, height, [&](std::uint64_t r) { return !std::isnan(at(column, r)); });
      Mean mean;
      add(mean, of_row, column, width, [&](std::uint64_t c) { return at(c, row); });
      add(mean, of_column, row, height, [&](std::uint64_t r) { return at(column, r); });
      if (mean.weights == 0) continue;
      inner[(row - border.north) * inner_width + column - border.west] = mean.heights / mean.weights;
      ++filled;
    }
  }
  return filled;
}

}  // namespace cuesta
