#include "apps/scene_show/scene_statistics.h"

#include <fmt/format.h>

#include "apps/scene_show/scene_frames.h"

namespace cuesta::scene_show {
namespace {

std::string grouped(std::uint64_t n) {
  std::string digits = std::to_string(n);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, ",");
  return digits;
}

double mebibytes(std::uint64_t bytes) {
  return static_cast<double>(bytes) / (1 << 20);
}

std::string parts_line(const SceneStatistics& s) {
  const SceneFrameReport& r = s.frame.report;
  std::string line =
      fmt::format("parts      {:.1f} of {:.1f} MiB", mebibytes(r.store.resident_bytes + r.surface_bytes),
                  mebibytes(s.cache_bytes));
  if (r.store.missing > 0) line += fmt::format(", {} on their way", grouped(r.store.missing));
  if (s.unreadable_parts > 0) line += fmt::format(", {} cannot be read", grouped(s.unreadable_parts));
  return line;
}

std::string clip_line(const ClipStatistics& c) {
  return fmt::format("clip       {}{:.1f} of {:.1f} s{}", c.name.empty() ? "" : c.name + ", ", c.time_s,
                     c.length_s, c.playing ? "" : ", held");
}

}  // namespace

std::vector<std::string> statistics_lines(const SceneStatistics& s) {
  const SceneFrameReport& r = s.frame.report;
  std::vector<std::string> lines{s.title};
  if (s.frame_ms > 0)
    lines.push_back(fmt::format("frame      {:.1f} ms ({:.0f} fps)", s.frame_ms, 1000 / s.frame_ms));
  lines.push_back(fmt::format("time       {:.1f} ms, desired {:.3g}, predicted {:.1f}", s.frame.actual_ms,
                              r.desired_ms, r.predicted_ms));
  lines.push_back(fmt::format("choice     {:.2f} ms, optimisation {:.2f}", r.choice_ms, r.optimisation_ms));
  lines.push_back(fmt::format("policy     {}, {}; tau {:.3g} px", name(s.policy), name(r.outcome), s.tau_px));
  lines.push_back(
      fmt::format("triangles  {} of {} visible", grouped(r.drawn_triangles), grouped(r.visible_triangles)));
  lines.push_back(
      fmt::format("objects    {} of {} visible", grouped(r.drawn_objects), grouped(r.visible_objects)));
  lines.push_back(parts_line(s));
  if (s.clip) lines.push_back(clip_line(*s.clip));
  if (!s.pointer.empty()) lines.push_back("pointer    " + s.pointer);
  lines.push_back(s.camera + (s.frozen ? "; frozen" : r.settled ? "; settled" : "; adapting"));
  lines.push_back(s.driver);
  return lines;
}

}  // namespace cuesta::scene_show
