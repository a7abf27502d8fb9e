#include "terrain/image_drape.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "ooc/check.h"
#include "ooc/read_job.h"
#include "terrain/image_pixels.h"

namespace cuesta {
namespace {

struct PixelPoint {
  double column = 0, row = 0;  ///< whole numbers are middles
};

/// Weighted sum of colours whose alpha is multiplied in.
struct ColourSum {
  std::array<double, 4> sum{};

  void add(Rgba8 colour, double weight) {
    for (std::size_t i = 0; i < 4; ++i) sum[i] += weight * colour[i];
  }
  Rgba8 colour() const {
    if (sum[3] < 0.5) return {0, 0, 0, 0};
    Rgba8 out{};
    for (std::size_t i = 0; i < 3; ++i) out[i] = byte(sum[i] * 255 / sum[3]);
    out[3] = byte(sum[3]);
    return out;
  }
  static std::uint8_t byte(double value) {
    return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0l, 255l));
  }
};

bool has_area(const GeoBox& b) {
  return std::abs(b.west_deg) <= 360 && b.west_deg < b.east_deg && b.east_deg - b.west_deg <= 360 + 1e-9 &&
         b.south_deg >= -90 && b.south_deg < b.north_deg && b.north_deg <= 90;
}

PicturePlace place_between(const GeoBox& b, const ImagePixels& pixels) {
  const double dx = (b.east_deg - b.west_deg) / pixels.width,
               dy = (b.north_deg - b.south_deg) / pixels.height;
  const PostingMap map{
      .x0 = b.west_deg + dx / 2, .y0 = b.north_deg - dy / 2, .x_per_column = dx, .y_per_row = -dy};
  return {map, Crs::from_epsg(4326).value()};
}

}  // namespace

/// The picture, where it lies, and the blocks used last.
struct ImageDrape::Data {
  struct Block {
    std::uint64_t last_use = 0;
    std::vector<Rgba8> colours;
  };

  Data(std::string file_name, std::unique_ptr<ImagePixels> picture, PicturePlace picture_place,
       std::uint64_t cache_bytes)
      : name(std::move(file_name)), pixels(std::move(picture)), place(std::move(picture_place)) {
    block_size = std::size_t{pixels->block_width} * pixels->block_height;
    most_blocks = std::max<std::uint64_t>(4, cache_bytes / (block_size * sizeof(Rgba8)));
    if (!place.crs.geographic()) return;
    turn = 360 / place.crs.definition().unit;
    closes = std::abs(place.map.x_per_column * pixels->width - turn) < 1e-6 * turn;
  }

  /// Inverse of the map; also of a rotated one.
  PixelPoint point_of(PlanePoint p) const {
    const PostingMap& m = place.map;
    const double determinant = m.x_per_column * m.y_per_row - m.x_per_row * m.y_per_column;
    const double x = p.x - m.x0, y = p.y - m.y0;
    return {(x * m.y_per_row - y * m.x_per_row) / determinant,
            (y * m.x_per_column - x * m.y_per_column) / determinant};
  }
  bool is_inside(PixelPoint p) const {
    return p.column >= -0.5 && p.column <= pixels->width - 0.5 && p.row >= -0.5 &&
           p.row <= pixels->height - 0.5;
  }
  /// Nothing where the picture does not lie; longitudes by whole turns.
  std::optional<PixelPoint> pixel_at(LatLon at) const {
    const PlanePoint p = place.crs.coordinates(at);
    for (const double by : {0.0, turn, -turn, 2 * turn}) {
      const PixelPoint pixel = point_of({p.x + by, p.y});
      if (is_inside(pixel)) return pixel;
      if (turn == 0) break;
    }
    return {};
  }

  Result<Rgba8> colour_at(std::uint32_t x, std::uint32_t y) {
    const std::uint32_t bx = x / pixels->block_width, by = y / pixels->block_height;
    const std::uint64_t key = std::uint64_t{by} << 32 | bx;
    if (key != current_key) {
      auto block = find(key, bx, by);
      if (!block) return fail(block.error());
      current = *block;
      current_key = key;
    }
    return current
        ->colours[std::size_t{y % pixels->block_height} * pixels->block_width + x % pixels->block_width];
  }

  Result<Block*> find(std::uint64_t key, std::uint32_t bx, std::uint32_t by) {
    const auto [at, is_new] = blocks.try_emplace(key);
    at->second.last_use = ++clock;
    if (!is_new) return &at->second;
    at->second.colours.resize(block_size);
    if (auto r = pixels->load(bx, by, at->second.colours); !r) {
      blocks.erase(at);
      current_key = none;
      return fail(r.error());
    }
    if (blocks.size() > most_blocks) forget_oldest();
    return &blocks.at(key);
  }
  void forget_oldest() {
    blocks.erase(std::min_element(blocks.begin(), blocks.end(), [](const auto& a, const auto& b) {
      return a.second.last_use < b.second.last_use;
    }));
  }

  std::uint32_t column(double whole) const {
    const auto width = static_cast<double>(pixels->width);
    if (closes)
      return static_cast<std::uint32_t>(whole < 0 ? whole + width : whole >= width ? whole - width : whole);
    return static_cast<std::uint32_t>(std::clamp(whole, 0.0, width - 1));
  }
  std::uint32_t row(double whole) const {
    return static_cast<std::uint32_t>(std::clamp(whole, 0.0, static_cast<double>(pixels->height - 1)));
  }

  Result<Rgba8> sample(LatLon at) {
    if (!std::isfinite(at.lat_deg) || !std::isfinite(at.lon_deg)) return Rgba8{0, 0, 0, 0};
    const auto p = pixel_at(at);
    if (!p) return Rgba8{0, 0, 0, 0};
    const double left = std::floor(p->column), top = std::floor(p->row);
    const double u = p->column - left, v = p->row - top;
    ColourSum sum;
    for (const int dy : {0, 1})
      for (const int dx : {0, 1}) {
        const double weight = (dx ? u : 1 - u) * (dy ? v : 1 - v);
        if (weight == 0) continue;
        const auto colour = colour_at(column(left + dx), row(top + dy));
        if (!colour) return colour;
        sum.add(*colour, weight);
      }
    return sum.colour();
  }

  static constexpr std::uint64_t none = ~std::uint64_t{0};
  std::string name;
  std::unique_ptr<ImagePixels> pixels;
  PicturePlace place;
  double turn = 0;  ///< geographic: all around, in the system's units
  bool closes = false;
  std::size_t block_size = 0;
  std::uint64_t most_blocks = 0, clock = 0;
  std::mutex turns;
  std::unordered_map<std::uint64_t, Block> blocks;
  Block* current = nullptr;
  std::uint64_t current_key = none;
};

ImageDrape::ImageDrape(std::unique_ptr<Data> data) : data_(std::move(data)) {}
ImageDrape::ImageDrape(ImageDrape&&) noexcept = default;
ImageDrape& ImageDrape::operator=(ImageDrape&&) noexcept = default;
ImageDrape::~ImageDrape() = default;

Result<ImageDrape> ImageDrape::open(const std::filesystem::path& path, const DrapeOptions& options) {
  const auto bad = [&](const char* message) {
    return fail(ErrorCode::invalid_input, path.string(), "bounds", message);
  };
  if (options.bounds && !has_area(*options.bounds))
    return bad("expected west < east within 360 degrees of it, and south < north between the poles");
  auto file = open_raster_file(path, options.temp);
  if (!file) return fail(file.error());
  auto pixels = open_image(std::move(*file), options.temp);
  if (!pixels) return fail(pixels.error());
  if (!options.bounds && !(*pixels)->place)
    return bad(
        "the picture does not say where it lies: give its bounds, west, south, east and north in degrees");
  PicturePlace place = options.bounds ? place_between(*options.bounds, **pixels) : *(*pixels)->place;
  const PostingMap& m = place.map;
  if (!std::isnormal(m.x_per_column * m.y_per_row - m.x_per_row * m.y_per_column))
    return bad("its pixels have no area");
  return ImageDrape(std::make_unique<Data>(path.filename().string(), std::move(*pixels), std::move(place),
                                           options.cache_bytes));
}

Result<void> ImageDrape::sample(std::span<const LatLon> at, std::span<Rgba8> out) const {
  CUESTA_CHECK(at.size() == out.size(), at.size(), out.size());
  const std::scoped_lock lock(data_->turns);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const auto colour = data_->sample(at[i]);
    if (!colour) return fail(colour.error());
    out[i] = *colour;
  }
  return {};
}

std::uint32_t ImageDrape::width() const {
  return data_->pixels->width;
}
std::uint32_t ImageDrape::height() const {
  return data_->pixels->height;
}
std::string ImageDrape::description() const {
  return fmt::format("{}, {} × {} pixels, {}", data_->name, width(), height(),
                     data_->place.crs.description());
}

std::optional<GeoBox> parse_geo_box(std::string_view text) {
  std::array<double, 4> n{};
  const char* at = text.data();
  const char* const end = text.data() + text.size();
  for (std::size_t i = 0; i < n.size(); ++i) {
    const auto [next, error] = std::from_chars(at, end, n[i]);
    if (error != std::errc{} || !std::isfinite(n[i])) return {};
    if (i + 1 < n.size() ? next == end || *next != ',' : next != end) return {};
    at = next + (i + 1 < n.size() ? 1 : 0);
  }
  GeoBox box{n[0], n[1], n[2], n[3]};
  if (box.east_deg < box.west_deg) box.east_deg += 360;
  if (!has_area(box)) return {};
  return box;
}

}  // namespace cuesta
