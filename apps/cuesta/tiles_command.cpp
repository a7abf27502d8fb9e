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

}  // namespace

Result<void> run_export_tiles(const TilesSettings& s) {
  Progress progress(s.quiet);
  tiles::TileOptions options = s.options;
  if (options.cache_bytes == 0) options.cache_bytes = physical_memory_bytes() / 2;
  auto producer = tiles::TileProducer::open(s.file, options);
  if (!producer) return fail(producer.error());
  auto files = tiles::tile_files(s.output);
  if (!files) return fail(files.error());
  const auto report = tiles::export_tiles(**producer, **files, [&](const tiles::TilesReport& r) {
    progress.update("tiles", Unit::triangles, r.triangles, 0);
    return check_stop();
  });
  if (!report) return fail(report.error());
  progress.finish();
  (s.json ? tell_json : tell)(s, *report);
  return {};
}

}  // namespace cuesta::app
