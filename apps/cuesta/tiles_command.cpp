#include "apps/cuesta/tiles_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/text_forms.h"
#include "apps/tiles/export_tiles.h"

namespace cuesta::app {
namespace {

void tell_json(const TilesSettings& s, const tiles::TilesReport& r) {
  nlohmann::ordered_json json{{"file", s.output.string()}, {"tiles", r.tiles},
                              {"leaves", r.leaves},        {"levels", r.levels},
                              {"tilesets", r.tilesets},    {"triangles", r.triangles},
                              {"bytes", r.bytes},          {"root_error", r.root_error}};
  fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

void tell(const TilesSettings& s, const tiles::TilesReport& r) {
  fmt::print("{}: {} tiles on {} levels, {} of them leaves, {} tilesets\n", s.output.string(),
             with_commas(r.tiles), r.levels, with_commas(r.leaves), with_commas(r.tilesets));
  fmt::print("{} triangles, {}; geometric error of the root: {:.6g}\n", with_commas(r.triangles),
             byte_count(r.bytes), r.root_error);
}

std::uint64_t cache_bytes(const TilesSettings& s) {
  return s.options.cache_bytes > 0 ? s.options.cache_bytes : physical_memory_bytes() / 2;
}

tiles::TileProgress teller(Progress& progress) {
  return [&progress](const tiles::TilesReport& r) {
    progress.update("tiles", Unit::triangles, r.triangles, 0);
    return check_stop();
  };
}

Result<tiles::TilesReport> write_tiles(const TilesSettings& s, Progress& progress) {
  tiles::TileOptions options = s.options;
  options.cache_bytes = cache_bytes(s);
  auto producer = tiles::TileProducer::open(s.file, options);
  if (!producer) return fail(producer.error());
  auto files = tiles::tile_files(s.output);
  if (!files) return fail(files.error());
  return tiles::export_tiles(**producer, **files, teller(progress));
}

Result<tiles::TilesReport> write_terrain(const TilesSettings& s, Progress& progress) {
  auto pyramid = tiles::TerrainPyramid::open(s.file, {s.finest_error_m, cache_bytes(s)});
  if (!pyramid) return fail(pyramid.error());
  auto files = tiles::tile_folder(s.output);
  if (!files) return fail(files.error());
  return tiles::export_terrain(**pyramid, **files, teller(progress));
}

}  // namespace

Result<void> run_export_tiles(const TilesSettings& s) {
  Progress progress(s.quiet);
  const auto report = s.terrain ? write_terrain(s, progress) : write_tiles(s, progress);
  if (!report) return fail(report.error());
  progress.finish();
  (s.json ? tell_json : tell)(s, *report);
  return {};
}

}  // namespace cuesta::app
