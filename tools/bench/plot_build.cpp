// cuesta-bench-plot build.csv build.svg: the scans of tools/bench/build, by their size.
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>

#include "apps/plot/svg_plot.h"
#include "tools/bench/csv_rows.h"

int main(int argc, char** argv) {
  using namespace cuesta::plot;
  std::ifstream in(argc == 3 ? argv[1] : "");
  if (!in) {
    std::fprintf(stderr, "usage: cuesta-bench-plot build.csv build.svg\n");
    return 1;
  }
  Series rate, memory, size;
  for (const cuesta::bench::Row& row : cuesta::bench::rows_of(in)) {
    const std::string& name = row.at("case");
    // Plain scans only: scan_4m, scan_16m, …
    if (!name.starts_with("scan_") || std::count(name.begin(), name.end(), '_') != 1) continue;
    const double millions = std::stod(row.at("triangles")) / 1e6;
    for (auto& [series, column] : std::map<Series*, const char*>{
             {&rate, "triangles_per_second"}, {&memory, "peak_mebibytes"}, {&size, "bytes_per_triangle"}}) {
      const auto at = std::upper_bound(series->x.begin(), series->x.end(), millions) - series->x.begin();
      series->x.insert(series->x.begin() + at, millions);
      series->y.insert(series->y.begin() + at, std::stod(row.at(column)) / (series == &rate ? 1000 : 1));
    }
  }
  Chart chart;
  chart.title = "Building generated scans with --memory 1G on two threads";
  chart.x = {.label = "triangles of the input (millions)", .logarithmic = true, .low = {}, .high = {}};
  chart.panels = {{"Rate", {"thousand triangles/s", false, 0.0, {}}, {rate}, {{"required", 500}}},
                  {"Peak resident set", {"MiB", false, 0.0, {}}, {memory}, {{"budget", 1024}}},
                  {"Size", {"bytes per triangle", false, 0.0, {}}, {size}, {{"required", 6.5}}}};
  if (const auto written = write_svg(argv[2], chart); !written) {
    std::fprintf(stderr, "%s\n", written.error().text().c_str());
    return cuesta::exit_status(written.error().code);
  }
}
