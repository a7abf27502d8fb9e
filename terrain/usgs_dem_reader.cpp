/// USGS .dem: text in records of 1024 bytes; a header, then profiles from south to north, each from where the
/// quadrangle begins. Opening reads the heads of all profiles; the first read unpacks them to a temporary
/// file. Source: USGS, "Standards for Digital Elevation Models", part 2 (1998), appendix 2-A. Byte positions
/// in this file are counted from 0, those of the standard from 1.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "ooc/text_cursor.h"
#include "terrain/raster_readers.h"
#include "terrain/sample_file.h"

namespace cuesta {
namespace {

constexpr std::uint64_t record_bytes = 1024;
constexpr std::uint64_t heights_in_first = 146, heights_in_next = 170;  // records of a profile
constexpr std::uint64_t profile_head_bytes = 144;
constexpr std::int32_t void_height = -32767;
/// How far from the lattice the beginning of a profile may be, in spacings: they are written in few digits.
constexpr double most_uneven_steps = 0.05;
/// The rectangle around a quadrangle has this many times its postings at most; real ones about 1.1.
constexpr std::uint64_t most_empty = 8;

std::optional<std::int64_t> whole(std::string_view text, std::uint64_t at, std::uint64_t width = 6) {
  if (at + width > text.size()) return std::nullopt;
  TextCursor cursor{text.data() + at, text.data() + at + width};
  cursor.skip_spaces();
  const auto value = cursor.integer();
  return value && cursor.at_word_end() ? value : std::nullopt;
}

/// A Fortran real, whose exponent may follow a D.
std::optional<double> real(std::string_view text, std::uint64_t at, std::uint64_t width) {
  if (at + width > text.size()) return std::nullopt;
  std::string digits(text.substr(at, width));
  std::ranges::replace(digits, 'D', 'E');
  TextCursor cursor{digits.data(), digits.data() + digits.size()};
  cursor.skip_spaces();
  const auto value = cursor.real();
  return value && cursor.at_word_end() && std::isfinite(*value) ? value : std::nullopt;
}

struct Header {
  std::int64_t system = 0, zone = 0, ground_unit = 0, height_unit = 0, datum = 0, vertical_datum = 0;
  double dx = 0, dy = 0, dz = 0;  ///< steps, of x and y in the file's units
  std::uint64_t profiles = 0;
};

std::optional<Header> header_of(std::string_view text) {
  if (text.size() < 2 * record_bytes) return std::nullopt;
  const auto pattern = whole(text, 150), system = whole(text, 156), zone = whole(text, 162),
             ground = whole(text, 528), height = whole(text, 534), sides = whole(text, 540),
             rows = whole(text, 852), columns = whole(text, 858);
  const auto dx = real(text, 816, 12), dy = real(text, 828, 12), dz = real(text, 840, 12);
  if (!pattern || !system || !zone || !ground || !height || !sides || !rows || !columns || !dx || !dy ||
      !dz || *sides != 4 || *rows != 1 || *columns < 1)
    return std::nullopt;
  return Header{.system = *system,
                .zone = *zone,
                .ground_unit = *ground,
                .height_unit = *height,
                .datum = whole(text, 890, 2).value_or(0),  // not in files of the old format
                .vertical_datum = whole(text, 888, 2).value_or(0),
                .dx = *dx,
                .dy = *dy,
                .dz = *dz,
                .profiles = static_cast<std::uint64_t>(*columns)};
}

struct Profile {
  std::uint64_t offset = 0, count = 0;  ///< bytes; heights
  std::uint64_t column = 0, row = 0;    ///< row of the southernmost posting, counted from the south
};

struct Quadrangle {
  std::vector<Profile> profiles;
  double x0 = 0, y0 = 0;  ///< of the south-western corner of the rectangle, in the file's units
  std::uint64_t width = 0, height = 0;
};

std::uint64_t records_of(std::uint64_t heights) {
  return heights <= heights_in_first
             ? 1
             : 1 + (heights - heights_in_first + heights_in_next - 1) / heights_in_next;
}

/// Steps from `first`, if it is a whole number of them.
std::optional<std::uint64_t> steps(double value, double first, double step) {
  const double count = (value - first) / step, nearest = std::round(count);
  if (!(nearest >= 0 && nearest < double(most_postings_per_side)) ||
      std::abs(count - nearest) > most_uneven_steps)
    return std::nullopt;
  return static_cast<std::uint64_t>(nearest);
}

Result<Quadrangle> read_profile_heads(const RasterFile& file, const Header& header) {
  const std::string_view text = file.text();
  struct Begin {
    double x, y;
  };
  std::vector<Begin> begins;
  Quadrangle out;
  std::uint64_t at = record_bytes;
  for (std::uint64_t i = 0; i < header.profiles; ++i) {
    const auto broken = [&](const char* expected) {
      return file.error(ErrorCode::corrupt, fmt::format("byte {}", at),
                        fmt::format("expected {} of profile {} of {}", expected, i + 1, header.profiles));
    };
    const auto count = whole(text, at + 12);
    if (!count || *count < 1 || *count > std::int64_t(most_postings_per_side))
      return broken("the number of heights");
    const auto x = real(text, at + 24, 24), y = real(text, at + 48, 24), base = real(text, at + 72, 24);
    if (!x || !y || !base) return broken("the place");
    if (*base != 0)
      return file.error(ErrorCode::unsupported_version, fmt::format("byte {}", at),
                        "profiles with a local datum of their own are not read");
    const auto heights = static_cast<std::uint64_t>(*count);
    // The last record may be cut off after its last height.
    const std::uint64_t full = records_of(heights),
                        in_last = full == 1 ? profile_head_bytes + 6 * heights
                                            : 6 * (heights - heights_in_first - (full - 2) * heights_in_next);
    if (at + (full - 1) * record_bytes + in_last > text.size()) return broken("all heights");
    out.profiles.push_back({.offset = at, .count = heights});
    begins.push_back({*x, *y});
    at += full * record_bytes;
  }
  out.x0 = std::ranges::min(begins, {}, &Begin::x).x;
  out.y0 = std::ranges::min(begins, {}, &Begin::y).y;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const auto column = steps(begins[i].x, out.x0, header.dx), row = steps(begins[i].y, out.y0, header.dy);
    if (!column || !row)
      return file.error(ErrorCode::corrupt, fmt::format("byte {}", out.profiles[i].offset),
                        fmt::format("profile {} does not begin on the lattice of the others", i + 1));
    out.profiles[i].column = *column;
    out.profiles[i].row = *row;
    out.width = std::max(out.width, *column + 1);
    out.height = std::max(out.height, *row + out.profiles[i].count);
  }
  return out;
}

/// Rows of i32 from the north, into a file without a name.
Result<MappedFile> unpack_profiles(const RasterFile& file, const Quadrangle& quadrangle,
                                   const std::filesystem::path& temp) {
  std::vector<std::int32_t> samples(quadrangle.width * quadrangle.height, void_height);
  const std::string_view text = file.text();
  for (const Profile& profile : quadrangle.profiles) {
    std::uint64_t at = profile.offset + profile_head_bytes, left = heights_in_first;
    for (std::uint64_t i = 0; i < profile.count; ++i, at += 6, --left) {
      if (left == 0) {
        at += (record_bytes - (at - profile.offset) % record_bytes) % record_bytes;
        left = heights_in_next;
      }
      const auto height = whole(text, at);
      if (!height || *height < -1'000'000 || *height > 1'000'000)
        return file.error(ErrorCode::corrupt, fmt::format("byte {}", at),
                          "expected a height, found " + quote_word(text.substr(at, 6)));
      const std::uint64_t row = quadrangle.height - 1 - (profile.row + i);
      samples[row * quadrangle.width + profile.column] = static_cast<std::int32_t>(*height);
    }
  }
  CUESTA_TRY(file.map.check_unchanged());
  auto out = TempFile::create(temp);
  if (!out) return fail(std::move(out).error());
  const std::span<const char> bytes(reinterpret_cast<const char*>(samples.data()),
                                    samples.size() * sizeof(samples[0]));
  CUESTA_TRY(out->expect(bytes.size()));
  CUESTA_TRY(out->write(bytes));
  return out->map();
}

/// EPSG codes of geographic coordinates, and of UTM zones counted from 0, by the standard's number of the
/// datum.
struct Datum {
  std::int64_t number;
  std::uint32_t geographic, north, south;
};
constexpr Datum datums[] = {{0, 4326, 32600, 32700},  // not named
                            {1, 4267, 26700, 0},      // NAD27
                            {2, 4322, 32200, 32300},  // WGS 72
                            {3, 4326, 32600, 32700},  // WGS 84
                            {4, 4269, 26900, 0}};     // NAD83

Result<void> read_system(const RasterFile& file, const Header& header, RasterInfo& info) {
  const auto datum = std::ranges::find(datums, header.datum, &Datum::number);
  const auto zone =
      static_cast<std::uint32_t>(std::min<std::uint64_t>(std::uint64_t(std::abs(header.zone)), 99));
  const std::uint32_t zones = datum == std::end(datums) ? 0 : header.zone < 0 ? datum->south : datum->north;
  if (header.system == 0 && datum != std::end(datums))
    info.crs = {.kind = CrsDescription::Kind::epsg, .epsg = datum->geographic};
  else if (header.system == 1 && zones != 0 && zone >= 1 && zone <= 60)
    info.crs = {.kind = CrsDescription::Kind::epsg, .epsg = zones + zone};
  else
    return file.error(
        ErrorCode::unsupported_version, "byte 156",
        fmt::format("reference system {}, zone {}, datum {} is not read; expected geographic or UTM",
                    header.system, header.zone, header.datum));
  if (header.datum == 0)
    info.warnings.push_back(
        "the file does not name its datum, and is taken as WGS 84; old ones of the USGS are in NAD27, "
        "up to 200 m away");
  return {};
}

Result<RasterInfo> info_of(const RasterFile& file, const Header& header, const Quadrangle& quadrangle) {
  RasterInfo info{.width = quadrangle.width,
                  .height = quadrangle.height,
                  .is_placed = true,
                  .vertical_datum = VerticalDatum::orthometric,
                  .type = SampleType::i32,
                  .format = "USGS DEM"};
  info.files = {file.path.string()};
  const double unit = header.ground_unit == 3 ? 1.0 / 3600 : 1;  // seconds of arc to degrees
  info.map = {.x0 = quadrangle.x0 * unit,
              .y0 = (quadrangle.y0 + double(quadrangle.height - 1) * header.dy) * unit,
              .x_per_column = header.dx * unit,
              .y_per_row = -header.dy * unit};
  if ((header.system == 1) != (header.ground_unit == 2) || (header.system == 0) != (header.ground_unit == 3))
    return file.error(
        ErrorCode::unsupported_version, "byte 528",
        fmt::format("expected metres of UTM or seconds of arc, found unit {}", header.ground_unit));
  if (header.height_unit != 1 && header.height_unit != 2)
    return file.error(
        ErrorCode::corrupt, "byte 534",
        fmt::format("expected heights in feet (1) or metres (2), found {}", header.height_unit));
  info.vertical_name = header.vertical_datum == 2   ? "NGVD 29"
                       : header.vertical_datum == 3 ? "NAVD 88"
                                                    : "mean sea level";
  info.meaning = {
      .no_data = {double(void_height)}, .scale = header.dz, .unit_m = header.height_unit == 1 ? 0.3048 : 1};
  CUESTA_TRY(read_system(file, header, info));
  return info;
}

}  // namespace

bool looks_like_usgs_dem(std::string_view text) {
  const auto header = header_of(text);
  return header && whole(text, record_bytes) == 1 && whole(text, record_bytes + 6) == 1;
}

RasterResult open_usgs_dem(RasterFile file, const RasterOptions& options) {
  const auto header = header_of(file.text());
  if (!header || !(header->dx > 0 && header->dy > 0 && header->dz > 0))
    return file.error(ErrorCode::corrupt, "byte 0", "expected the header of a USGS DEM, 1024 bytes of text");
  auto quadrangle = read_profile_heads(file, *header);
  if (!quadrangle) return fail(std::move(quadrangle).error());
  auto info = info_of(file, *header, *quadrangle);
  if (!info) return fail(std::move(info).error());
  apply_options(*info, options);
  CUESTA_TRY(check_info(*info, file));
  if (info->width * info->height > most_empty * (file.size() / 6))
    return file.error(ErrorCode::corrupt, "", "the profiles lie too far apart");
  CUESTA_TRY(file.map.check_unchanged());
  // std::function wants to be copied; the reading itself is under the raster's mutex.
  const auto shared = std::make_shared<const RasterFile>(std::move(file));
  const auto profiles = std::make_shared<const Quadrangle>(std::move(*quadrangle));
  return make_unpacked_raster(
      std::move(*info),
      [shared, profiles, temp = options.temp] { return unpack_profiles(*shared, *profiles, temp); },
      {.type = SampleType::i32});
}

}  // namespace cuesta
