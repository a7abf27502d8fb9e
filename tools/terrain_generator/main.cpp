/// cuesta-make-terrain OUTPUT.i16 [--relief RASTER] --side N …

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "tools/terrain_generator/make_terrain.h"

namespace {

using namespace cuesta;

constexpr std::uint64_t made_up_postings = 16;  // of the terrain for one of a relief that is made up

/// @param square  column, row and side, or nothing.
Result<tools::Relief> open_relief(const std::string& path, const std::vector<std::uint64_t>& square,
                                  const tools::TerrainOptions& options) {
  if (path.empty()) return tools::made_up_relief((options.side - 1) / made_up_postings + 2, options.seed);
  auto raster = open_height_raster(path);
  if (!raster) return fail(raster.error());
  if (square.empty()) return tools::relief_of(std::move(*raster));
  return tools::relief_of(std::move(*raster), tools::Square{square[0], square[1], square[2]});
}

}  // namespace

int main(int argc, char** argv) {
  std::string output, relief;
  std::vector<std::uint64_t> square;
  tools::TerrainOptions options;
  CLI::App app{"Makes terrain of N x N postings: a relief, upsampled smoothly, with fractal detail.",
               "cuesta-make-terrain"};
  app.add_option("OUTPUT", output, "raw int16, .i16; a sidecar OUTPUT.json places it")->required();
  app.add_option("--side", options.side, "postings a side")->required()->check(CLI::Range(2, 1 << 20));
  auto* file =
      app.add_option("--relief", relief, "heights of any format; default: mountains that are made up");
  app.add_option("--square", square,
                 "of the relief: first column, row from the north, side; default: all, in its middle")
      ->delimiter(',')
      ->expected(3)
      ->needs(file);
  app.add_option("--seed", options.seed, "of the detail");
  app.add_option("--roughness", options.roughness, "of the detail, default 0.5; 0: smooth")
      ->check(CLI::Range(0.0, 10.0));
  app.add_option("--spacing", options.spacing_m, "metres between postings, default 30")
      ->check(CLI::PositiveNumber);
  app.add_option("--epsg", options.epsg, "code of the plane, default 32645 (UTM zone 45 north)");
  app.add_option("--x", options.centre_x_m, "easting of the middle, default 500000");
  app.add_option("--y", options.centre_y_m, "northing of the middle, default 3100000");
  CLI11_PARSE(app, argc, argv);
  const auto source = open_relief(relief, square, options);
  const Result<void> made =
      source ? tools::make_terrain(*source, output, options) : Result<void>(fail(source.error()));
  if (!made) {
    fmt::print(stderr, "cuesta-make-terrain: {}\n", made.error().text());
    return exit_status(made.error().code);
  }
  fmt::print("{}: {} x {} postings\n", output, options.side, options.side);
  return 0;
}
