#include "terrain/tiff_placement.h"

#include <fmt/format.h>

#include <cmath>

namespace cuesta {

Result<std::optional<PostingMap>> tiff_placement(const TiffHandle& handle, std::span<const GeoKey> keys) {
  const auto matrix = handle.doubles(tiff_tag::transformation), scale = handle.doubles(tiff_tag::pixel_scale),
             ties = handle.doubles(tiff_tag::tie_points);
  // Tags speak of raster space, in which a pixel that is an area has its middle at ½.
  const double shift = short_key(keys, geo_key::raster_type).value_or(1) == 2 ? 0.0 : 0.5;
  if (scale.size() >= 2 && ties.size() >= 6) {
    const double dx = std::abs(scale[0]), dy = std::abs(scale[1]);
    return std::optional<PostingMap>(PostingMap{.x0 = ties[3] + (shift - ties[0]) * dx,
                                                .y0 = ties[4] - (shift - ties[1]) * dy,
                                                .x_per_column = dx,
                                                .y_per_row = -dy});
  }
  if (matrix.size() >= 16)
    return std::optional<PostingMap>(PostingMap{.x0 = matrix[3] + shift * (matrix[0] + matrix[1]),
                                                .y0 = matrix[7] + shift * (matrix[4] + matrix[5]),
                                                .x_per_column = matrix[0],
                                                .y_per_column = matrix[4],
                                                .x_per_row = matrix[1],
                                                .y_per_row = matrix[5]});
  if (ties.size() > 6)
    return handle.file().error(ErrorCode::unsupported_version, "georeference",
                               fmt::format("{} ground control points without a transformation are not read; "
                                           "rectify the file first",
                                           ties.size() / 6));
  return std::optional<PostingMap>();
}

}  // namespace cuesta
