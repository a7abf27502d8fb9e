// cuesta-bench-plot-sessions sessions.csv sessions.svg: a run of tools/bench/sessions, over its time.
#include <cstdio>
#include <fstream>
#include <string>

#include "apps/plot/svg_plot.h"
#include "tools/bench/csv_rows.h"

int main(int argc, char** argv) {
  using namespace cuesta;
  std::ifstream in(argc == 3 ? argv[1] : "");
  if (!in) {
    std::fprintf(stderr, "usage: cuesta-bench-plot-sessions sessions.csv sessions.svg\n");
    return 1;
  }
  const std::vector<bench::Row> rows = bench::rows_of(in);
  const auto line = [&](const char* name, const char* column) {
    plot::Series series{name, {}, {}, {}};
    for (const bench::Row& row : rows) {
      series.x.push_back(std::stod(row.at("second")));
      series.y.push_back(std::stod(row.at(column)));
    }
    return series;
  };
  plot::Chart chart;
  chart.title = "Sessions of one server, each on a flight of its own";
  chart.x = {.label = "time (s)", .logarithmic = false, .low = 0.0, .high = {}};
  chart.panels = {
      {"Memory",
       {"MiB", false, 0.0, {}},
       {line("resident", "resident_mib"), line("set aside", "set_aside_mib")},
       {}},
      {"Processor time per session and second",
       {"ms", false, 0.0, {}},
       {line("", "cpu_ms_per_session_s")},
       {}},
      {"Changes per session and second",
       {"1/s", false, 0.0, {}},
       {line("mean", "changes_per_s"), line("of the session with the fewest", "least_changes_per_s")},
       {}},
      {"Longest wait of any session for a change", {"s", false, 0.0, {}}, {line("", "longest_wait_s")}, {}}};
  if (const auto written = plot::write_svg(argv[2], chart); !written) {
    std::fprintf(stderr, "%s\n", written.error().text().c_str());
    return exit_status(written.error().code);
  }
}
