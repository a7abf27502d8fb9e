#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "apps/plot/scale.h"
#include "apps/plot/svg_plot.h"

namespace cuesta::plot {
namespace {

std::vector<std::string> labels(const Scale& scale, int wanted) {
  std::vector<std::string> result;
  for (const Tick& tick : ticks(scale, wanted)) {
    if (!tick.label.empty()) result.push_back(tick.label);
  }
  return result;
}

std::size_t count_of(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

Chart one_line(std::vector<double> x, std::vector<double> y) {
  Chart chart{.title = "a & b < c", .subtitle = "", .x = {"time (s)", false, {}, {}}, .panels = {}};
  Panel panel;
  panel.title = "load";
  panel.y.label = "ms";
  panel.series.push_back({"one", std::move(x), std::move(y), {}});
  chart.panels.push_back(std::move(panel));
  return chart;
}

TEST(Ticks, RoundNumbers) {
  EXPECT_EQ(labels({0, 1, false, 0, 1}, 5), (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1"}));
  EXPECT_EQ(labels({-30, 40, false, 0, 1}, 4), (std::vector<std::string>{"−20", "0", "20", "40"}));
  EXPECT_EQ(labels({0, 3e6, false, 0, 1}, 3), (std::vector<std::string>{"0", "1 M", "2 M", "3 M"}));
  EXPECT_EQ(labels({0, 1e6, false, 0, 1}, 2), (std::vector<std::string>{"0", "0.5 M", "1 M"}));
  EXPECT_EQ(labels({1e3, 1e6, true, 0, 1}, 4), (std::vector<std::string>{"1000", "10 k", "100 k", "1 M"}));
  EXPECT_EQ(labels({0, 4e-5, false, 0, 1}, 2), (std::vector<std::string>{"0", "2×10⁻⁵", "4×10⁻⁵"}));
  EXPECT_EQ(labels({1, 1000, true, 0, 1}, 4), (std::vector<std::string>{"1", "10", "100", "1000"}));
  EXPECT_EQ(labels({0.1, 1, true, 0, 1}, 4), (std::vector<std::string>{"0.1", "0.2", "0.5", "1"}));
}

TEST(Ticks, WidenReachesRoundNumbers) {
  Scale linear{0.3, 9.2, false, 0, 1};
  widen(linear, 5);
  EXPECT_DOUBLE_EQ(linear.low, 0);
  EXPECT_DOUBLE_EQ(linear.high, 10);
  Scale logarithmic{0.03, 700, true, 0, 1};
  widen(logarithmic, 5);
  EXPECT_DOUBLE_EQ(logarithmic.low, 0.02);
  EXPECT_DOUBLE_EQ(logarithmic.high, 1000);
}

TEST(SvgPlot, GapsBreakTheLine) {
  const double nan = std::nan("");
  EXPECT_EQ(count_of(to_svg(one_line({0, 1, 2, 3, 4}, {1, 2, nan, 3, 4})), "<polyline"), 2u);
  Chart logarithmic = one_line({0, 1, 2, 3, 4}, {1, 2, 0, 3, 4});
  logarithmic.panels[0].y.logarithmic = true;
  EXPECT_EQ(count_of(to_svg(logarithmic), "<polyline"), 2u);
}

TEST(SvgPlot, EscapesTextAndStaysSmall) {
  std::vector<double> x, y;
  for (int i = 0; i < 200'000; ++i) {
    x.push_back(i);
    y.push_back(std::sin(i * 0.7));
  }
  const std::string svg = to_svg(one_line(x, y));
  EXPECT_NE(svg.find("a &amp; b &lt; c"), std::string::npos);
  EXPECT_LT(svg.size(), 100'000u);
}

TEST(SvgPlot, NothingToDrawIsStillADocument) {
  for (const Chart& chart : {Chart{}, one_line({}, {}), one_line({1}, {0}), one_line({1, 2}, {5, 5}),
                             one_line({0}, {std::numeric_limits<double>::infinity()})}) {
    const std::string svg = to_svg(chart);
    EXPECT_TRUE(svg.starts_with("<svg") && svg.ends_with("</svg>\n"));
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
  }
}

TEST(CsvColumns, RowsAreTheUnionOfX) {
  Chart chart = one_line({0, 1, 1, 2}, {0.1, 2, 3, std::nan("")});
  chart.panels[0].series.push_back({"two, \"quoted\"", {1, 5}, {7, 8}, {}});
  EXPECT_EQ(to_csv(chart),
            "time (s),load: one [ms],\"load: two, \"\"quoted\"\" [ms]\"\r\n"
            "0,0.1,\r\n1,2,7\r\n1,3,\r\n2,nan,\r\n5,,8\r\n");
}

}  // namespace
}  // namespace cuesta::plot
