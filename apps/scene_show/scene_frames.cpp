#include "apps/scene_show/scene_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "apps/plot/svg_plot.h"

namespace cuesta::scene_show {
namespace {

double quantile(std::vector<double> v, double q) {
  if (v.empty()) return 0;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(std::ceil(q * static_cast<double>(v.size() - 1)))];
}

template <class Value>
std::vector<double> column(std::span<const PlayedFrame> frames, const Value& value) {
  std::vector<double> v;
  for (const PlayedFrame& f : frames) v.push_back(static_cast<double>(value(f)));
  return v;
}

template <class Value>
plot::Series series(const char* title, std::span<const PlayedFrame> frames, const Value& value) {
  return {title, column(frames, [](const PlayedFrame& f) { return f.time_s; }), column(frames, value), {}};
}

}  // namespace

std::string_view name(ResolutionOutcome outcome) {
  switch (outcome) {
    case ResolutionOutcome::full:
      return "full";
    case ResolutionOutcome::optimal:
      return "optimal";
    case ResolutionOutcome::early:
      return "early";
    case ResolutionOutcome::infeasible:
      return "infeasible";
    case ResolutionOutcome::heuristic:
      break;
  }
  return "heuristic";
}

std::string_view name(PolicyKind policy) {
  return policy == PolicyKind::predictive ? "predictive" : policy == PolicyKind::stress ? "stress" : "static";
}

std::string scene_frames_csv(std::span<const PlayedFrame> frames) {
  std::string text =
      "frame,time_s,visible_objects,drawn_objects,visible_triangles,drawn_triangles,changed_triangles,"
      "desired_ms,"
      "predicted_ms,optimisation_ms,choice_ms,actual_ms,outcome,resident_bytes,missing\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const SceneFrameReport& r = frames[i].report;
    text += fmt::format("{},{:.6g},{},{},{},{},{},{:.6g},{:.3f},{:.3f},{:.3f},{:.3f},{},{},{}\n", i,
                        frames[i].time_s, r.visible_objects, r.drawn_objects, r.visible_triangles,
                        r.drawn_triangles, r.changed_triangles, r.desired_ms, r.predicted_ms,
                        r.optimisation_ms, r.choice_ms, frames[i].actual_ms, name(r.outcome),
                        r.store.resident_bytes + r.surface_bytes, r.store.missing);
  }
  return text;
}

Result<void> write_scene_plot(const std::filesystem::path& path, const std::string& title,
                              const std::string& subtitle, std::span<const PlayedFrame> frames) {
  plot::Chart chart;
  chart.title = title, chart.subtitle = subtitle;
  chart.x.label = "time (s)";
  plot::Panel triangles{"triangles", {"triangles", true, {}, {}}, {}, {}};
  triangles.series = {
      series("visible", frames,
             [](const PlayedFrame& f) { return std::max<double>(1, double(f.report.visible_triangles)); }),
      series("rendered", frames,
             [](const PlayedFrame& f) { return std::max<double>(1, double(f.report.drawn_triangles)); })};
  plot::Panel times{"time of a frame", {"ms", false, 0.0, {}}, {}, {}};
  times.series = {
      series("actual", frames, [](const PlayedFrame& f) { return f.actual_ms; }),
      series("predicted", frames, [](const PlayedFrame& f) { return f.report.predicted_ms; }),
      series("optimisation", frames, [](const PlayedFrame& f) { return f.report.optimisation_ms; })};
  if (!frames.empty()) times.limits = {{"desired", frames.front().report.desired_ms}};
  chart.panels = {triangles, times};
  return plot::write_svg(path, chart);
}

DeadlineSummary summarise(std::span<const PlayedFrame> frames) {
  DeadlineSummary s;
  const double n = std::max<double>(1, static_cast<double>(frames.size()));
  for (const PlayedFrame& f : frames) {
    s.within_share += f.actual_ms <= f.report.desired_ms ? 1 / n : 0;
    s.mean_use += f.actual_ms / f.report.desired_ms / n;
  }
  const auto actual = column(frames, [](const PlayedFrame& f) { return f.actual_ms; });
  s.median_ms = quantile(actual, 0.5), s.p99_ms = quantile(actual, 0.99), s.most_ms = quantile(actual, 1);
  s.median_error = quantile(column(frames,
                                   [](const PlayedFrame& f) {
                                     return std::abs(f.actual_ms / std::max(f.report.predicted_ms, 1e-9) - 1);
                                   }),
                            0.5);
  s.median_triangles =
      quantile(column(frames, [](const PlayedFrame& f) { return f.report.drawn_triangles; }), 0.5);
  return s;
}

}  // namespace cuesta::scene_show
