#include <fmt/format.h>

#include <cmath>
#include <map>
#include <utility>

#include "apps/plot/svg_plot.h"
#include "ooc/check.h"

namespace cuesta::plot {
namespace {

/// x, and how many times the series had it before: points with the same key share a row.
using Key = std::pair<double, std::size_t>;
using Rows = std::map<Key, std::vector<std::optional<double>>>;

std::string csv_cell(const std::string& words) {
  if (words.find_first_of(",\"\r\n") == std::string::npos) return words;
  std::string text = "\"";
  for (const char c : words) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

std::string column_name(const Panel& panel, const Series& series) {
  std::string name = panel.title;
  if (!name.empty() && !series.name.empty()) name += ": ";
  name += series.name;
  if (!panel.y.label.empty()) name += " [" + panel.y.label + "]";
  return csv_cell(name);
}

std::string number(double value) {
  return std::isnan(value) ? "nan" : fmt::format("{}", value);
}

void add_column(const Series& series, std::size_t column, std::size_t columns, Rows& rows) {
  CUESTA_CHECK(series.x.size() == series.y.size(), series.name, series.x.size(), series.y.size());
  std::map<double, std::size_t> repeats;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (std::isnan(series.x[i])) continue;
    auto& row = rows[{series.x[i], repeats[series.x[i]]++}];
    row.resize(columns);
    row[column] = series.y[i];
  }
}

}  // namespace

std::string to_csv(const Chart& chart) {
  std::size_t columns = 0;
  for (const Panel& panel : chart.panels) columns += panel.series.size();
  std::string text = csv_cell(chart.x.label);
  Rows rows;
  std::size_t column = 0;
  for (const Panel& panel : chart.panels) {
    for (const Series& series : panel.series) {
      text += "," + column_name(panel, series);
      add_column(series, column++, columns, rows);
    }
  }
  text += "\r\n";
  for (const auto& [key, cells] : rows) {
    text += number(key.first);
    for (const auto& cell : cells) text += "," + (cell ? number(*cell) : std::string());
    text += "\r\n";
  }
  return text;
}

}  // namespace cuesta::plot
