#include "terrain/mosaic.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ooc/check.h"
#include "ooc/read_job.h"
#include "terrain/mosaic_datums.h"
#include "terrain/mosaic_field.h"
#include "terrain/mosaic_layers.h"
#include "terrain/mosaic_seams.h"

namespace cuesta {
namespace {

constexpr std::size_t most_warnings = 64;

double vertical_quantum(const RasterInfo& info) {
  if (info.type == SampleType::f32 || info.type == SampleType::f64) return 0;
  return std::abs(info.meaning.scale * info.meaning.unit_m);
}

std::vector<std::string> warnings_of(std::span<const RasterInfo> infos, std::vector<std::string> first) {
  std::uint64_t more = 0, unplaced = 0;
  for (const RasterInfo& info : infos) {
    unplaced += !info.is_placed;
    for (const std::string& warning : info.warnings) {
      if (first.size() < most_warnings)
        first.push_back(info.files.front() + ": " + warning);
      else
        ++more;
    }
  }
  if (unplaced > 1)
    first.push_back(
        fmt::format("{} files do not say where they lie: they lie on top of each other", unplaced));
  if (more > 0) first.push_back(fmt::format("{} more warnings of files", more));
  return first;
}

Result<void> check_options(std::span<const std::filesystem::path> files, const MosaicOptions& options) {
  const auto wrong = [](const char* what, std::string message) {
    return fail(ErrorCode::invalid_input, "", what, std::move(message));
  };
  if (files.empty()) return wrong("files", "expected at least one raster");
  if (files.size() >= ~std::uint32_t{0}) return wrong("files", "more than can be counted");
  if (options.fill_postings > most_fill_postings)
    return wrong("fill", fmt::format("expected at most {} postings, found {}", most_fill_postings,
                                     options.fill_postings));
  if (options.sea_level_m && !std::isfinite(*options.sea_level_m))
    return wrong("sea level", "expected a height that is a number");
  return {};
}

/// Makes covered postings of a window NaN. @return how many had a height.
std::uint64_t take_away(const LayerCover& cover, std::uint64_t around, const Window& window,
                        std::span<double> heights) {
  std::uint64_t taken = 0;
  const auto take = [&](std::uint64_t row, std::uint64_t begin, std::uint64_t end) {
    const std::uint64_t last = std::min(end, window.column + window.width);
    for (std::uint64_t c = std::max(begin, window.column); c < last; ++c) {
      double& height = heights[row * window.width + c - window.column];
      taken += !std::isnan(height);
      height = std::numeric_limits<double>::quiet_NaN();
    }
  };
  for (std::uint64_t r = 0; r < window.height; ++r) {
    for (const PostingRun& run : cover.covered.row(window.row + r)) {
      std::uint64_t begin = cover.part.column + run.begin, end = cover.part.column + run.end;
      if (around != 0 && begin >= around) {
        begin -= around;
        end -= around;
      }
      take(r, begin, end);
      if (around == 0) continue;
      if (end > around) take(r, 0, end - around);
      take(r, begin + around, end + around);
    }
  }
  return taken;
}

}  // namespace

struct Mosaic::State {
  State(const MosaicOptions& options)
      : field(options, {std::max(1u, options.most_open_files), options.cache_bytes}) {}

  MosaicField field;
  MosaicSeams joined = {};
  double vertical_quantum_m = 0;
  std::vector<std::string> warnings = {};
};

MosaicCounts& MosaicCounts::operator+=(const MosaicCounts& other) {
  heights += other.heights;
  filled += other.filled;
  flooded += other.flooded;
  raised += other.raised;
  covered += other.covered;
  return *this;
}

Result<Mosaic> Mosaic::open(std::span<const std::filesystem::path> files, const MosaicOptions& options) {
  CUESTA_TRY(check_options(files, options));
  auto state = std::make_unique<State>(options);
  MosaicField& field = state->field;
  for (const std::filesystem::path& file : files) CUESTA_TRY(field.rasters().add(file));
  const std::vector<RasterInfo>& infos = field.rasters().infos();
  const auto systems = systems_of(infos);
  if (!systems) return fail(systems.error());
  auto layers = group_into_layers(infos, *systems, options.priority);
  if (!layers) return fail(std::move(layers).error());
  auto datums = choose_datums(infos, *systems, options);
  if (!datums) return fail(std::move(datums).error());
  CUESTA_TRY(field.place(std::move(*layers), std::move(datums->steps), datums->datum));
  state->vertical_quantum_m = vertical_quantum(std::ranges::min(infos, {}, vertical_quantum));
  state->warnings = warnings_of(infos, std::move(datums->warnings));
  if (field.layers().size() > 1) {
    auto joined = join_layers(field);
    if (!joined) return fail(std::move(joined).error());
    state->joined = std::move(*joined);
    if (const auto lost = state->joined.lost_segments; lost > 0)
      state->warnings.push_back(
          fmt::format("{} edges between layers cross others; there may be small cracks", lost));
  }
  return Mosaic(std::move(state));
}

Mosaic::Mosaic(std::unique_ptr<const State> state) : state_(std::move(state)) {}
Mosaic::Mosaic(Mosaic&&) noexcept = default;
Mosaic& Mosaic::operator=(Mosaic&&) noexcept = default;
Mosaic::~Mosaic() = default;

const std::vector<MosaicLayer>& Mosaic::layers() const {
  return state_->field.layers();
}

const std::vector<RasterInfo>& Mosaic::infos() const {
  return state_->field.rasters().infos();
}

Result<void> Mosaic::read(std::uint32_t layer_number, const Window& window, std::span<double> heights,
                          MosaicCounts* counts) const {
  CUESTA_CHECK(layer_number < layers().size(), layer_number, layers().size());
  const MosaicLayer& layer = layers()[layer_number];
  CUESTA_CHECK(window.height <= layer.height && window.row <= layer.height - window.height, window.row,
               window.height, layer.height);
  const std::uint64_t most_columns = layer.columns_around != 0 ? 2 * layer.columns_around : layer.width;
  CUESTA_CHECK(window.width <= most_columns && window.column <= most_columns - window.width, window.column,
               window.width, most_columns);
  CUESTA_CHECK(heights.size() == window.width * window.height, heights.size(), window.width, window.height);
  if (heights.empty()) return {};
  MosaicCounts here;
  CUESTA_TRY(state_->field.read(layer_number, window, heights, here));
  for (const LayerCover& cover : state_->joined.covers) {
    if (cover.part.layer == layer_number)
      here.covered += take_away(cover, layer.columns_around, window, heights);
  }
  here.heights = static_cast<std::uint64_t>(
      std::ranges::count_if(heights, [](double height) { return !std::isnan(height); }));
  if (counts) *counts += here;
  return {};
}

bool Mosaic::has_files(std::uint32_t layer, const Window& window) const {
  return state_->field.has_files(layer, window);
}

std::span<const SeamTriangle> Mosaic::seams() const {
  return state_->joined.seams;
}

VerticalDatum Mosaic::heights() const {
  return state_->field.datum();
}

double Mosaic::vertical_quantum_m() const {
  return state_->vertical_quantum_m;
}

std::uint64_t Mosaic::postings() const {
  std::uint64_t sum = 0;
  for (const MosaicLayer& layer : layers()) sum += layer.width * layer.height;
  return sum;
}

const std::vector<std::string>& Mosaic::warnings() const {
  return state_->warnings;
}

std::uint64_t Mosaic::memory_bytes() const {
  std::uint64_t bytes =
      state_->field.rasters().memory_bytes() + state_->joined.seams.size() * sizeof(SeamTriangle);
  for (const LayerCover& cover : state_->joined.covers) bytes += cover.covered.memory_bytes();
  return bytes;
}

}  // namespace cuesta
