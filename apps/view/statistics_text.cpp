#include "apps/view/statistics_text.h"

#include <fmt/format.h>

#include <cmath>

namespace cuesta::view {
namespace {

std::string grouped(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

std::string mebibytes(std::uint64_t bytes) {
  return fmt::format("{:.1f} MiB", static_cast<double>(bytes) / (1 << 20));
}

std::string triangle_line(const FrameStatistics& s) {
  std::string line = "triangles  " + grouped(s.adapt.triangles);
  if (s.budgets.triangles != Budgets{}.triangles) line += " of " + grouped(s.budgets.triangles);
  return line;
}

std::string adapt_line(const FrameStatistics& s) {
  std::string line = fmt::format("adapt      {:.2f} ms", s.adapt.adapt_ms);
  if (std::isfinite(s.budgets.adapt_ms)) line += fmt::format(" of {:.3g}", s.budgets.adapt_ms);
  return line;
}

const char* mode_name(ControlMode mode) {
  return mode == ControlMode::orbit ? "orbit" : mode == ControlMode::fly ? "fly" : "walk";
}

std::string state(const FrameStatistics& s) {
  const std::string bound = s.adapt.bound_by == Binding::nothing ? "" : "; bound by " + s.bound_by;
  if (s.frozen) return "frozen";
  return (s.adapt.settled ? "settled" : "adapting") + bound;
}

}  // namespace

std::vector<std::string> statistics_lines(const FrameStatistics& s) {
  std::vector<std::string> lines{s.title};
  if (s.frame_ms > 0)
    lines.push_back(fmt::format("frame      {:.1f} ms ({:.0f} fps), draw {:.1f} ms", s.frame_ms,
                                1000 / s.frame_ms, s.draw_ms));
  lines.push_back(triangle_line(s));
  lines.push_back(
      fmt::format("tau        {:.3g} px{}{}", s.tau_px,
                  s.adapt.tau > s.tau_px * 1.001 ? fmt::format(", held to {:.3g}", s.adapt.tau) : "",
                  std::isfinite(s.adapt.achieved) ? fmt::format("; error {:.3g}", s.adapt.achieved) : ""));
  lines.push_back(adapt_line(s));
  lines.push_back(fmt::format("operations {} coarse, {} fine", grouped(s.adapt.coarse_operations),
                              grouped(s.adapt.fine_operations)));
  lines.push_back(fmt::format("pages      {}, {} of {}", grouped(s.pages), mebibytes(s.adapt.resident_bytes),
                              mebibytes(s.cache_bytes)));
  if (s.adapt.morphing > 0) lines.push_back(fmt::format("blends     {} vertices", grouped(s.adapt.morphing)));
  if (s.adapt.pages_missing > 0)
    lines.push_back(fmt::format("           {} on their way", grouped(s.adapt.pages_missing)));
  lines.push_back(fmt::format("upload     {} in {} calls", mebibytes(s.upload_bytes), s.upload_calls));
  lines.push_back(s.mode == ControlMode::orbit
                      ? fmt::format("{}; {}", mode_name(s.mode), state(s))
                      : fmt::format("{}, {:.3g} {}/s; {}", mode_name(s.mode), s.speed,
                                    s.places.empty() ? "units" : "m", state(s)));
  if (s.unreadable_pages > 0)
    lines.push_back(fmt::format("{} pages cannot be read", grouped(s.unreadable_pages)));
  lines.push_back(s.driver);
  lines.insert(lines.end(), s.places.begin(), s.places.end());
  return lines;
}

}  // namespace cuesta::view
