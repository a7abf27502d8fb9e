/// SRTM .hgt: n × n big-endian i16 from the north-west, no header; the name is the south-west posting.
/// Neighbours share a row or column of postings. Source: USGS, "SRTM Quick Guide" and "SRTM Topography".

#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "ooc/read_job.h"
#include "terrain/raster_readers.h"
#include "terrain/sample_file.h"

namespace cuesta {
namespace {

struct Corner {
  int latitude_deg = 0, longitude_deg = 0;
};

/// "N42E001", "s29w072.SRTMGL1": letter, 2 digits, letter, 3 digits.
std::optional<Corner> corner_of(std::string_view name) {
  if (name.size() < 7) return std::nullopt;
  const auto digits = [&](std::size_t at, std::size_t count) {
    int value = 0;
    for (std::size_t i = at; i < at + count; ++i) {
      if (name[i] < '0' || name[i] > '9') return -1;
      value = value * 10 + (name[i] - '0');
    }
    return value;
  };
  const char ns = static_cast<char>(std::toupper(static_cast<unsigned char>(name[0])));
  const char ew = static_cast<char>(std::toupper(static_cast<unsigned char>(name[3])));
  const int latitude = digits(1, 2), longitude = digits(4, 3);
  if ((ns != 'N' && ns != 'S') || (ew != 'E' && ew != 'W') || latitude < 0 || longitude < 0)
    return std::nullopt;
  const Corner corner{ns == 'N' ? latitude : -latitude, ew == 'E' ? longitude : -longitude};
  const bool on_earth = corner.latitude_deg >= -90 && corner.latitude_deg < 90 &&
                        corner.longitude_deg >= -180 && corner.longitude_deg <= 180;
  return on_earth ? std::optional(corner) : std::nullopt;
}

/// n of n · n samples of 2 bytes; 0 if there is none.
std::uint64_t side_of(std::uint64_t bytes) {
  const auto n = static_cast<std::uint64_t>(std::llround(std::sqrt(static_cast<double>(bytes / 2))));
  return n >= 2 && n * n * 2 == bytes ? n : 0;
}

}  // namespace

RasterResult open_hgt(RasterFile file, const RasterOptions& options) {
  const std::uint64_t n = side_of(file.size());
  if (n == 0)
    return file.error(
        ErrorCode::corrupt, fmt::format("byte {}", file.size()),
        fmt::format("expected n × n samples of 2 bytes (2,884,802 bytes of 3\", 25,934,402 of 1\"), "
                    "found {} bytes; the file may be cut off",
                    file.size()));
  std::optional<Corner> corner = corner_of(file.inner_name);
  if (!corner) corner = corner_of(file.path.filename().string());
  if (!corner && !options.placement)
    return file.error(
        ErrorCode::invalid_input, "name",
        "expected a name like N42E001.hgt, which says where the tile lies; rename it or give its "
        "placement");
  RasterInfo info{.width = n, .height = n, .is_placed = true, .type = SampleType::i16, .format = "SRTM"};
  if (corner) {
    const double spacing = 1.0 / static_cast<double>(n - 1);
    info.map = map_of({.x = double(corner->longitude_deg),
                       .y = corner->latitude_deg + 1.0,
                       .x_spacing = spacing,
                       .y_spacing = spacing});
  }
  info.crs.kind = CrsDescription::Kind::geographic_wgs84;
  info.vertical_datum = VerticalDatum::orthometric;
  info.vertical_name = "EGM96";
  info.meaning.no_data = {-32768};
  info.files = {file.path.string()};
  apply_options(info, options);
  CUESTA_TRY(check_info(info, file));
  return make_sample_raster(std::move(info), std::move(file),
                            {.type = SampleType::i16, .order = ByteOrder::big});
}

}  // namespace cuesta
