#pragma once
/// The few SVG elements that a chart needs.

#include <span>
#include <string>
#include <string_view>

namespace cuesta::plot {

struct Point {
  double x, y;  ///< pixels, y down
};

struct Stroke {
  std::string_view colour = "#000000";
  double width = 1;
  std::string_view dashes = {};  ///< as in stroke-dasharray; solid if empty
};

enum class Anchor { start, middle, end };

struct Font {
  double size = 12;
  std::string_view colour = "#333333";
  bool bold = false;
  Anchor anchor = Anchor::start;
  double turn_deg = 0;
};

/// Elements in drawing order; finish() closes the document.
class SvgDocument {
 public:
  SvgDocument(double width, double height);

  void rectangle(Point corner, double width, double height, std::string_view fill);
  void line(Point a, Point b, const Stroke& stroke);
  void polyline(std::span<const Point> points, const Stroke& stroke);
  void dot(Point centre, double radius, std::string_view fill);
  void text(Point at, std::string_view words, const Font& font);  ///< `words` is plain text, escaped here
  void begin_clip(Point corner, double width, double height);
  void end_clip();
  std::string finish();

 private:
  std::string out_;
  int clips_ = 0;
};

/// Estimated width in px of sans-serif text.
double text_width(std::string_view words, double size);

}  // namespace cuesta::plot
