#include "apps/plot/svg_document.h"

#include <fmt/format.h>

#include <iterator>

namespace cuesta::plot {
namespace {

std::string escaped(std::string_view words) {
  std::string text;
  for (const char c : words) {
    switch (c) {
      case '&':
        text += "&amp;";
        break;
      case '<':
        text += "&lt;";
        break;
      case '>':
        text += "&gt;";
        break;
      case '"':
        text += "&quot;";
        break;
      default:
        if (static_cast<unsigned char>(c) >= 0x20) text += c;
    }
  }
  return text;
}

std::string attributes(const Stroke& stroke) {
  std::string text =
      fmt::format(R"(fill="none" stroke="{}" stroke-width="{:g}")", stroke.colour, stroke.width);
  if (!stroke.dashes.empty()) text += fmt::format(R"( stroke-dasharray="{}")", stroke.dashes);
  return text;
}

}  // namespace

SvgDocument::SvgDocument(double width, double height) {
  out_ = fmt::format(
      R"(<svg xmlns="http://www.w3.org/2000/svg" width="{0:g}" height="{1:g}" viewBox="0 0 {0:g} {1:g}" )"
      R"(font-family="Helvetica, Arial, 'DejaVu Sans', sans-serif">)"
      "\n",
      width, height);
  rectangle({0, 0}, width, height, "#ffffff");
}

void SvgDocument::rectangle(Point corner, double width, double height, std::string_view fill) {
  out_ += fmt::format(R"(<rect x="{:.2f}" y="{:.2f}" width="{:.2f}" height="{:.2f}" fill="{}"/>)"
                      "\n",
                      corner.x, corner.y, width, height, fill);
}

void SvgDocument::line(Point a, Point b, const Stroke& stroke) {
  out_ += fmt::format(R"(<line x1="{:.2f}" y1="{:.2f}" x2="{:.2f}" y2="{:.2f}" {}/>)"
                      "\n",
                      a.x, a.y, b.x, b.y, attributes(stroke));
}

void SvgDocument::polyline(std::span<const Point> points, const Stroke& stroke) {
  out_ += "<polyline points=\"";
  for (const Point& p : points) fmt::format_to(std::back_inserter(out_), "{:.2f},{:.2f} ", p.x, p.y);
  out_ += fmt::format(R"(" stroke-linejoin="round" stroke-linecap="round" {}/>)"
                      "\n",
                      attributes(stroke));
}

void SvgDocument::dot(Point centre, double radius, std::string_view fill) {
  out_ += fmt::format(R"(<circle cx="{:.2f}" cy="{:.2f}" r="{:g}" fill="{}"/>)"
                      "\n",
                      centre.x, centre.y, radius, fill);
}

void SvgDocument::text(Point at, std::string_view words, const Font& font) {
  static constexpr const char* anchors[] = {"start", "middle", "end"};
  out_ += fmt::format(R"(<text x="{:.2f}" y="{:.2f}" font-size="{:g}" fill="{}" text-anchor="{}")", at.x,
                      at.y, font.size, font.colour, anchors[static_cast<int>(font.anchor)]);
  if (font.bold) out_ += R"( font-weight="bold")";
  if (font.turn_deg != 0)
    out_ += fmt::format(" transform='rotate({:g} {:.2f} {:.2f})'", font.turn_deg, at.x, at.y);
  out_ += ">" + escaped(words) + "</text>\n";
}

void SvgDocument::begin_clip(Point corner, double width, double height) {
  out_ += fmt::format(
      "<clipPath id='clip{}'><rect x='{:.2f}' y='{:.2f}' width='{:.2f}' height='{:.2f}'/></clipPath>", clips_,
      corner.x, corner.y, width, height);
  out_ += fmt::format("<g clip-path='url(#clip{})'>\n", clips_++);
}

void SvgDocument::end_clip() {
  out_ += "</g>\n";
}

std::string SvgDocument::finish() {
  return std::move(out_) + "</svg>\n";
}

double text_width(std::string_view words, double size) {
  double letters = 0;
  for (const char c : words) {
    const bool continues = (static_cast<unsigned char>(c) & 0xc0) == 0x80;  // inside a UTF-8 character
    const bool narrow =
        c == ' ' || c == '.' || c == ',' || c == 'i' || c == 'l' || c == 't' || c == 'f' || c == '\'';
    letters += continues ? 0 : narrow ? 0.32 : 0.59;
  }
  return letters * size;
}

}  // namespace cuesta::plot
