/// Figure 10 of the fan-hierarchy's paper as curves, and the cost of each frame of a flight over the terrain.

#include <fstream>

#include "apps/plot/svg_plot.h"
#include "tools/bench/csv_rows.h"
#include "tools/bench/fan_inputs.h"

namespace cuesta::bench {
namespace {

Result<std::vector<Row>> table_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  if (!in) return fail(ErrorCode::not_found, path.string(), "", "run tools/bench/fan first");
  return rows_of(in);
}

/// A series of a column over the rows whose `key` is `value`; x in percent of the way.
plot::Series series_of(const std::vector<Row>& rows, const char* key, const std::string& value,
                       const char* column, const char* name, std::size_t colour) {
  plot::Series s{name, {}, {}, colour};
  for (const Row& row : rows)
    if (row.at(key) == value) s.y.push_back(std::stod(row.at(column)));
  for (std::size_t i = 0; i < s.y.size(); ++i)
    s.x.push_back(100.0 * static_cast<double>(i + 1) / static_cast<double>(s.y.size()));
  return s;
}

plot::Panel operations_panel(const std::vector<Row>& rows, const char* key, const std::string& value,
                             const std::string& title) {
  plot::Panel panel{title, {"operations per frame", true, {}, {}}, {}, {}};
  panel.series = {
      series_of(rows, key, value, "fan_operations", "fan-merges and -splits", 0),
      series_of(rows, key, value, "edge_operations", "single substitutions", 1),
      series_of(rows, key, value, "vdt_equal_operations", "view-dependence tree, equal triangles", 2)};
  return panel;
}

}  // namespace

Result<void> draw_results(const std::filesystem::path& folder) {
  const auto route = table_of(folder / "fan_route.csv");
  if (!route) return fail(route.error());
  auto frames = table_of(folder / "fan_frames.csv");
  if (!frames) return fail(frames.error());
  std::erase_if(*frames, [](const Row& row) { return row.at("model") != "terrain"; });
  plot::Chart chart;
  chart.title = "Fan-hierarchy and view-dependence tree over a terrain of 522,242 triangles, 2 pixels";
  chart.x = {.label = "part of the way (%)", .logarithmic = false, .low = 0.0, .high = 100.0};
  plot::Panel cost{"Fly-over: adapt time", {"processor ms per frame", true, {}, {}}, {}, {}};
  cost.series = {
      series_of(*frames, "flight", "fly-over", "fan_ms", "fan-hierarchy", 0),
      series_of(*frames, "flight", "fly-over", "vdt_equal_ms", "view-dependence tree, equal triangles", 2)};
  chart.panels = {
      cost,
      operations_panel(*frames, "flight", "fly-over", "Fly-over: operations"),
      operations_panel(*route, "flight", "route in 1000 frames: slower", "Corner to middle in 1000 frames"),
      operations_panel(*route, "flight", "route in 100 frames: slow", "Corner to middle in 100 frames"),
      operations_panel(*route, "flight", "route in 50 frames: medium", "Corner to middle in 50 frames"),
      operations_panel(*route, "flight", "route in 10 frames: fast", "Corner to middle in 10 frames")};
  return plot::write_svg(folder / "fan.svg", chart);
}

}  // namespace cuesta::bench
