#pragma once
/// Line charts for reports and benchmarks: panels stacked over one x axis, written as SVG that needs nothing
/// else. Colours: Okabe and Ito, "Color Universal Design", 2008, darkened where thin lines on white need it;
/// dash patterns repeat the distinction once the colours are used up.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ooc/result.h"

namespace cuesta::plot {

struct Axis {
  std::string label;         ///< with its unit: "time (s)"
  bool logarithmic = false;  ///< values ≤ 0 are then gaps
  std::optional<double> low,
      high;  ///< the data decide what is not given; on a linear axis, 0 is included if it is near
};

/// A line. NaN and infinities are gaps.
struct Series {
  std::string name;                   ///< in the legend; none if empty
  std::vector<double> x, y;           ///< same length
  std::optional<std::size_t> colour;  ///< index of the palette; its place in the panel if not given
};

/// A budget or a target: a dashed horizontal line with its name on it. Always inside the axis.
struct Limit {
  std::string name;
  double value = 0;
};

struct Panel {
  std::string title;
  Axis y;
  std::vector<Series> series;
  std::vector<Limit> limits;
  double height_px = 190;  ///< of the drawn area
};

struct Chart {
  std::string title, subtitle;  ///< either may be empty
  Axis x;
  std::vector<Panel> panels;
  double width_px = 960;
};

/// The chart as an SVG 1.1 document. Lines with more points than pixels keep each pixel column's first,
/// lowest, highest and last point.
/// @pre each series has as many x as y.   @cost O(points).
std::string to_svg(const Chart& chart);

/// @error io.
Result<void> write_svg(const std::filesystem::path& path, const Chart& chart);

/// The chart's columns as CSV (RFC 4180): first x, then one column per series, named "panel title: series
/// name [axis label]"; one row per distinct x in ascending order, more where a series repeats an x; empty
/// cells where a series has no point. Numbers have the digits that bring back the same double; NaN is "nan".
std::string to_csv(const Chart& chart);

/// @error io.
Result<void> write_csv(const std::filesystem::path& path, const Chart& chart);

}  // namespace cuesta::plot
