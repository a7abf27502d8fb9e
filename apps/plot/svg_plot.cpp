#include "apps/plot/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "apps/plot/scale.h"
#include "apps/plot/svg_document.h"
#include "ooc/atomic_file.h"
#include "ooc/check.h"

namespace cuesta::plot {
namespace {

constexpr std::array palette{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"};
constexpr std::array dash_patterns{"", "7 3", "2 3"};
constexpr const char* ink = "#222222";
constexpr const char* quiet_ink = "#555555";
constexpr const char* grid_colour = "#e4e4e4";
constexpr const char* axis_colour = "#888888";
constexpr const char* limit_colour = "#b00020";
constexpr double margin = 18, label_space = 18, panel_title_space = 28, legend_row = 19, panel_gap = 14,
                 x_axis_space = 50;
constexpr double tick_size = 11.5, label_size = 12, legend_size = 12, limit_size = 11.5;
constexpr std::size_t markers_up_to = 40;  ///< points: then each gets a dot

/// Where things go, in pixels.
struct Layout {
  double left = 0, right = 0, top = 0;  ///< of the drawn areas, and of the first panel's title
};

/// Long noisy lines are thinner, or they would be bands.
Stroke pen_of(const Series& series, std::size_t place) {
  const std::size_t i = series.colour.value_or(place);
  const double width = series.x.size() > 1000 ? 1.2 : 1.8;
  return {palette[i % palette.size()], width, dash_patterns[i / palette.size() % dash_patterns.size()]};
}

/// Grows [low, high] over the values that the scale accepts.
void cover(Scale& scale, std::span<const double> values) {
  for (const double v : values) {
    if (!scale.accepts(v)) continue;
    scale.low = std::min(scale.low, v);
    scale.high = std::max(scale.high, v);
  }
}

/// An axis without data, or with one value, still needs a length; a linear one starts at 0 if that is near.
void settle(Scale& scale, const Axis& axis) {
  if (scale.low > scale.high) scale.low = scale.high = 1;
  if (!axis.logarithmic && !axis.low && scale.low > 0 && scale.low < 0.6 * scale.high) scale.low = 0;
  if (axis.low && scale.accepts(*axis.low)) scale.low = *axis.low;
  if (axis.high && scale.accepts(*axis.high)) scale.high = *axis.high;
  if (scale.low < scale.high) return;
  const double away = std::max(std::abs(scale.low) * 0.5, std::numeric_limits<double>::min());
  scale.high = axis.logarithmic ? scale.low * 2 : scale.low + away;
  scale.low = axis.logarithmic ? scale.low / 2 : scale.low - away;
}

Scale empty_scale(const Axis& axis, double from_px, double to_px) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  return {infinity, -infinity, axis.logarithmic, from_px, to_px};
}

Scale x_scale(const Chart& chart, const Layout& layout) {
  Scale scale = empty_scale(chart.x, layout.left, layout.right);
  for (const Panel& panel : chart.panels) {
    for (const Series& series : panel.series) cover(scale, series.x);
  }
  settle(scale, chart.x);
  return scale;
}

int wanted_y_ticks(const Panel& panel) {
  return std::max(2, static_cast<int>(panel.height_px / 38));
}

Scale y_scale(const Panel& panel, double top_px) {
  Scale scale = empty_scale(panel.y, top_px + panel.height_px, top_px);
  for (const Series& series : panel.series) cover(scale, series.y);
  for (const Limit& limit : panel.limits) cover(scale, {&limit.value, 1});
  settle(scale, panel.y);
  const double low = scale.low, high = scale.high;
  widen(scale, wanted_y_ticks(panel));
  if (panel.y.low) scale.low = low;
  if (panel.y.high) scale.high = high;
  return scale;
}

/// Thins a run of points with ascending x to at most four per pixel column.
std::vector<Point> thinned(const std::vector<Point>& run) {
  std::vector<Point> kept;
  for (std::size_t i = 0; i < run.size();) {
    std::size_t last = i, low = i, high = i;
    while (last + 1 < run.size() && std::floor(run[last + 1].x) == std::floor(run[i].x)) {
      ++last;
      if (run[last].y < run[low].y) low = last;
      if (run[last].y > run[high].y) high = last;
    }
    std::array<std::size_t, 4> keep{i, std::min(low, high), std::max(low, high), last};
    for (std::size_t k = 0; k < 4; ++k) {
      if (k == 0 || keep[k] != keep[k - 1]) kept.push_back(run[keep[k]]);
    }
    i = last + 1;
  }
  return kept;
}

void draw_run(SvgDocument& svg, const std::vector<Point>& run, const Stroke& pen, bool markers) {
  if (run.size() > 1) svg.polyline(thinned(run), pen);
  if (!markers && run.size() > 1) return;
  for (const Point& p : run) svg.dot(p, 3, pen.colour);
}

void draw_series(SvgDocument& svg, const Series& series, const Scale& x, const Scale& y, const Stroke& pen) {
  CUESTA_CHECK(series.x.size() == series.y.size(), series.name, series.x.size(), series.y.size());
  const bool markers = series.x.size() <= markers_up_to;
  std::vector<Point> run;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (x.accepts(series.x[i]) && y.accepts(series.y[i])) {
      run.push_back({x(series.x[i]), y(series.y[i])});
      continue;
    }
    if (!run.empty()) draw_run(svg, run, pen, markers);
    run.clear();
  }
  if (!run.empty()) draw_run(svg, run, pen, markers);
}

void draw_y_axis(SvgDocument& svg, const Panel& panel, const Scale& y, const Layout& layout) {
  for (const Tick& tick : ticks(y, wanted_y_ticks(panel))) {
    const double at = y(tick.value);
    if (tick.label.empty()) {
      svg.line({layout.left - 3, at}, {layout.left, at}, {axis_colour, 0.8});
      continue;
    }
    svg.line({layout.left, at}, {layout.right, at}, {grid_colour, 1});
    svg.text({layout.left - 8, at + 4}, tick.label,
             {.size = tick_size, .colour = quiet_ink, .anchor = Anchor::end});
  }
  const double middle = (y.from_px + y.to_px) / 2;
  svg.text({margin + 10, middle}, panel.y.label,
           {.size = label_size, .colour = ink, .anchor = Anchor::middle, .turn_deg = -90});
}

void draw_x_axis(SvgDocument& svg, const Chart& chart, const Scale& x, const Scale& y, bool labelled) {
  const int wanted = std::max(2, static_cast<int>((x.to_px - x.from_px) / 90));
  for (const Tick& tick : ticks(x, wanted)) {
    const double at = x(tick.value);
    const bool minor = tick.label.empty();
    if (!minor) svg.line({at, y.to_px}, {at, y.from_px}, {grid_colour, 1});
    svg.line({at, y.from_px}, {at, y.from_px + (minor ? 3 : 5)}, {axis_colour, 0.8});
    if (!labelled || minor) continue;
    svg.text({at, y.from_px + 19}, tick.label,
             {.size = tick_size, .colour = quiet_ink, .anchor = Anchor::middle});
  }
  if (!labelled) return;
  svg.text({(x.from_px + x.to_px) / 2, y.from_px + 40}, chart.x.label,
           {.size = label_size, .colour = ink, .anchor = Anchor::middle});
}

/// Which series stand in which row of the legend. One row beside the title if all fit there, else rows below
/// it.
struct Legend {
  std::vector<std::vector<std::size_t>> rows;
  bool beside_title = true;
  double extra_height() const { return beside_title ? 0 : static_cast<double>(rows.size()) * legend_row; }
};

constexpr double legend_line = 28, legend_gap = 18;

double entry_width(const Series& series) {
  return legend_line + text_width(series.name, legend_size) + legend_gap;
}

Legend legend_of(const Panel& panel, const Layout& layout) {
  Legend legend;
  const double room = layout.right - layout.left;
  double all = 0, used = room;
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    if (panel.series[i].name.empty()) continue;
    const double width = entry_width(panel.series[i]);
    all += width;
    if (used + width > room + legend_gap) {
      legend.rows.emplace_back();
      used = 0;
    }
    legend.rows.back().push_back(i);
    used += width;
  }
  legend.beside_title = legend.rows.size() <= 1 && all + text_width(panel.title, 15) <= room;
  return legend;
}

void draw_legend_row(SvgDocument& svg, const Panel& panel, const std::vector<std::size_t>& row, double at,
                     double y) {
  for (const std::size_t i : row) {
    const Series& series = panel.series[i];
    const Stroke pen = pen_of(series, i);
    svg.line({at, y - 4}, {at + legend_line - 6, y - 4}, {pen.colour, 2.4, pen.dashes});
    if (series.x.size() <= markers_up_to) svg.dot({at + (legend_line - 6) / 2, y - 4}, 3, pen.colour);
    svg.text({at + legend_line, y}, series.name, {.size = legend_size, .colour = ink});
    at += entry_width(series);
  }
}

void draw_legend(SvgDocument& svg, const Panel& panel, const Legend& legend, const Layout& layout,
                 double baseline) {
  for (const auto& row : legend.rows) {
    double width = -legend_gap;
    for (const std::size_t i : row) width += entry_width(panel.series[i]);
    if (!legend.beside_title) baseline += legend_row;
    draw_legend_row(svg, panel, row, legend.beside_title ? layout.right - width : layout.left, baseline);
  }
}

/// Names stand right of the panel at the height of their lines, moved apart where they would touch.
void draw_limits(SvgDocument& svg, const Panel& panel, const Scale& y, const Layout& layout) {
  std::vector<Limit> limits = panel.limits;
  std::erase_if(limits, [&](const Limit& limit) { return !y.accepts(limit.value); });
  std::ranges::sort(limits, std::greater{}, &Limit::value);
  double last = -std::numeric_limits<double>::infinity();
  for (const Limit& limit : limits) {
    const double at = y(limit.value);
    if (at < y.to_px - 0.5 || at > y.from_px + 0.5) continue;
    svg.line({layout.left, at}, {layout.right, at}, {limit_colour, 1.4, "6 4"});
    last = std::max(at + 4, last + 14);
    svg.text({layout.right + 7, last}, limit.name, {.size = limit_size, .colour = limit_colour});
  }
}

void draw_frame(SvgDocument& svg, const Scale& x, const Scale& y) {
  svg.line({x.from_px, y.to_px}, {x.from_px, y.from_px}, {axis_colour, 1});
  svg.line({x.from_px, y.from_px}, {x.to_px, y.from_px}, {axis_colour, 1});
}

void draw_panel(SvgDocument& svg, const Chart& chart, const Panel& panel, const Layout& layout,
                double top_px) {
  const Legend legend = legend_of(panel, layout);
  const double area_top = top_px + panel_title_space + legend.extra_height();
  const Scale x = x_scale(chart, layout), y = y_scale(panel, area_top);
  svg.text({layout.left, top_px + panel_title_space - 10}, panel.title,
           {.size = 13, .colour = ink, .bold = true});
  draw_legend(svg, panel, legend, layout, top_px + panel_title_space - 10);
  draw_y_axis(svg, panel, y, layout);
  draw_x_axis(svg, chart, x, y, &panel == &chart.panels.back());
  draw_frame(svg, x, y);
  svg.begin_clip({layout.left - 4, area_top - 4}, layout.right - layout.left + 8, panel.height_px + 8);
  for (std::size_t i = 0; i < panel.series.size(); ++i) {
    draw_series(svg, panel.series[i], x, y, pen_of(panel.series[i], i));
  }
  svg.end_clip();
  draw_limits(svg, panel, y, layout);
}

/// The left margin fits the widest tick label, the right one the widest limit's name.
Layout layout_of(const Chart& chart) {
  double widest = 0, limits = 12;
  for (const Panel& panel : chart.panels) {
    for (const Tick& tick : ticks(y_scale(panel, 0), wanted_y_ticks(panel))) {
      widest = std::max(widest, text_width(tick.label, tick_size));
    }
    for (const Limit& limit : panel.limits) limits = std::max(limits, text_width(limit.name, limit_size) + 7);
  }
  const bool titled = !chart.title.empty() || !chart.subtitle.empty();
  const double top =
      margin + (chart.title.empty() ? 0 : 22) + (chart.subtitle.empty() ? 0 : 19) + (titled ? 10 : 0);
  return {margin + label_space + widest + 14, chart.width_px - margin - limits, top};
}

double panel_height(const Panel& panel, const Layout& layout) {
  return panel_title_space + legend_of(panel, layout).extra_height() + panel.height_px + panel_gap;
}

}  // namespace

std::string to_svg(const Chart& chart) {
  const Layout layout = layout_of(chart);
  double height = layout.top + x_axis_space;
  for (const Panel& panel : chart.panels) height += panel_height(panel, layout);
  SvgDocument svg(chart.width_px, height);
  svg.text({margin, margin + 12}, chart.title, {.size = 17, .colour = ink, .bold = true});
  svg.text({margin, layout.top - 15}, chart.subtitle, {.size = 12.5, .colour = quiet_ink});
  double at = layout.top;
  for (const Panel& panel : chart.panels) {
    draw_panel(svg, chart, panel, layout, at);
    at += panel_height(panel, layout);
  }
  return svg.finish();
}

namespace {

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  if (auto ok = file->write(std::as_bytes(std::span(text))); !ok) return ok;
  return file->commit();
}

}  // namespace

Result<void> write_svg(const std::filesystem::path& path, const Chart& chart) {
  return write_text(path, to_svg(chart));
}

Result<void> write_csv(const std::filesystem::path& path, const Chart& chart) {
  return write_text(path, to_csv(chart));
}

}  // namespace cuesta::plot
