#include "tools/terrain_generator/make_terrain.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>

#include "ooc/atomic_file.h"
#include "terrain/raster_sidecar.h"
#include "tools/terrain_generator/fractal_rows.h"

namespace cuesta::tools {
namespace {

constexpr std::uint64_t band_rows = 64;  // computed in parallel, then written
constexpr double shortest_wave = 2;      // postings

static_assert(std::endian::native == std::endian::little, "samples are written as they are in memory");

std::int16_t sample(double height_m) {
  return static_cast<std::int16_t>(std::lround(std::clamp(height_m, -32767.0, 32767.0)));
}

class Generator {
 public:
  Generator(const Relief& relief, const TerrainOptions& options)
      : relief_(relief),
        options_(options),
        step_(static_cast<double>(relief.side - 1) / static_cast<double>(options.side - 1)) {}

  Result<std::vector<std::int16_t>> band(std::uint64_t first, std::uint64_t count) const {
    const auto rows = ReliefRows::read(relief_, at(first), at(first + count - 1));
    if (!rows) return fail(rows.error());
    std::vector<std::int16_t> samples(count * options_.side);
    tbb::parallel_for(std::uint64_t{0}, count, [&](std::uint64_t r) {
      fill(*rows, first + r, std::span(samples).subspan(r * options_.side, options_.side));
    });
    return samples;
  }

 private:
  /// Row of the relief; the last one is met exactly.
  double at(std::uint64_t row) const {
    return std::min(static_cast<double>(row) * step_, static_cast<double>(relief_.side - 1));
  }
  void fill(const ReliefRows& rows, std::uint64_t row, std::span<std::int16_t> samples) const {
    std::vector<double> heights_m(samples.size()), slopes(samples.size()), detail(samples.size());
    rows.interpolate(at(row), step_, heights_m, slopes);
    fractal_row(detail, row, 1 / step_, shortest_wave, options_.seed);
    for (std::size_t i = 0; i < samples.size(); ++i)
      samples[i] = sample(heights_m[i] + options_.roughness * slopes[i] * detail[i]);
  }

  const Relief& relief_;
  TerrainOptions options_;
  double step_;  // postings of the relief per posting
};

std::string sidecar(const TerrainOptions& o) {
  const double half_m = static_cast<double>(o.side - 1) / 2 * o.spacing_m;
  nlohmann::ordered_json json;
  json["format"] = "raw";
  json["placement"] = {{"x", o.centre_x_m - half_m},
                       {"y", o.centre_y_m + half_m},
                       {"x_spacing", o.spacing_m},
                       {"y_spacing", o.spacing_m},
                       {"pixel_is", "point"}};
  json["epsg"] = o.epsg;
  json["vertical_datum"] = "orthometric";
  json["type"] = "int16";
  json["byte_order"] = "little";
  json["width"] = o.side;
  json["height"] = o.side;
  return json.dump(2) + "\n";
}

Result<void> write_sidecar(const std::filesystem::path& path, const TerrainOptions& options) {
  auto file = AtomicFile::create(sidecar_path(path));
  if (!file) return fail(file.error());
  const std::string text = sidecar(options);
  if (auto r = file->write(std::as_bytes(std::span(text))); !r) return r;
  return file->commit();
}

}  // namespace

Result<void> make_terrain(const Relief& relief, const std::filesystem::path& path,
                          const TerrainOptions& options) {
  if (options.side < 2)
    return fail(ErrorCode::invalid_input, path.string(), "", "terrain needs two postings a side at least");
  if (auto r = write_sidecar(path, options); !r) return r;
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  const Generator generator(relief, options);
  for (std::uint64_t row = 0; row < options.side; row += band_rows) {
    const auto samples = generator.band(row, std::min(band_rows, options.side - row));
    if (!samples) return fail(samples.error());
    if (auto r = file->write(std::as_bytes(std::span(*samples))); !r) return r;
  }
  return file->commit();
}

}  // namespace cuesta::tools
