#include "apps/cuesta/frame_table.h"

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "apps/cuesta/open_cut.h"
#include "apps/cuesta/text_forms.h"
#include "apps/plot/svg_plot.h"
#include "ooc/atomic_file.h"

namespace cuesta::app {
namespace {

constexpr double mib = 1 << 20;

template <class Value>
plot::Panel panel(const std::string& title, const std::string& unit, const std::vector<FrameRecord>& frames,
                  Value value) {
  plot::Panel p;
  p.title = title;
  p.y.label = unit;
  p.y.low = 0;
  plot::Series series;
  for (const FrameRecord& f : frames) {
    series.x.push_back(f.time_s);
    series.y.push_back(value(f));
  }
  p.series.push_back(std::move(series));
  p.height_px = 150;
  return p;
}

plot::Panel triangle_panel(const std::vector<FrameRecord>& frames, const FrameLimits& limits) {
  auto p = panel("triangles", "triangles", frames,
                 [](const FrameRecord& f) { return static_cast<double>(f.adapt.triangles); });
  if (limits.budgets.triangles != Budgets{}.triangles)
    p.limits.push_back({"budget", static_cast<double>(limits.budgets.triangles)});
  return p;
}

plot::Panel adapt_panel(const std::vector<FrameRecord>& frames, const FrameLimits& limits) {
  auto p = panel("adapt time", "ms", frames, [](const FrameRecord& f) { return f.adapt.adapt_ms; });
  if (std::isfinite(limits.budgets.adapt_ms)) p.limits.push_back({"budget", limits.budgets.adapt_ms});
  return p;
}

plot::Panel sse_panel(const std::vector<FrameRecord>& frames, const FrameLimits& limits) {
  auto p = panel("screen-space error", "px", frames, [](const FrameRecord& f) { return f.adapt.achieved; });
  p.limits.push_back({"tau", limits.tau_px});
  return p;
}

plot::Panel resident_panel(const std::vector<FrameRecord>& frames, const FrameLimits& limits) {
  auto p = panel("resident pages", "MiB", frames,
                 [](const FrameRecord& f) { return static_cast<double>(f.adapt.resident_bytes) / mib; });
  double most = 0;
  for (const double y : p.series[0].y) most = std::max(most, y);
  const double cache = static_cast<double>(limits.cache_bytes) / mib;
  // A cache far larger than the model would flatten the line; its size is in the subtitle then.
  if (cache < 4 * most) p.limits.push_back({"cache", cache});
  return p;
}

}  // namespace

std::string frames_csv(const std::vector<FrameRecord>& frames) {
  std::string text =
      "frame,time_s,triangles,adapt_ms,load_ms,render_ms,coarse_operations,fine_operations,pages_loaded,sse_"
      "px,tau_px,"
      "resident_bytes,bound_by,settled,pages_missing,upload_bytes,blocks_tested\n";
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const AdaptReport& a = frames[i].adapt;
    text += fmt::format("{},{:.6g},{},{:.3f},{:.3f},{:.3f},{},{},{},{:.6g},{:.6g},{},{},{},{},{},{}\n", i,
                        frames[i].time_s, a.triangles, a.adapt_ms, a.load_ms, frames[i].render_ms,
                        a.coarse_operations, a.fine_operations, a.pages_loaded, a.achieved, a.tau,
                        a.resident_bytes, name(a.bound_by), a.settled ? 1 : 0, a.pages_missing,
                        a.upload_bytes, a.blocks_tested);
  }
  return text;
}

Result<void> write_frames_plot(const std::filesystem::path& path, const std::string& title,
                               const std::vector<FrameRecord>& frames, const FrameLimits& limits) {
  plot::Chart chart;
  chart.title = title;
  chart.subtitle =
      fmt::format("tau {:.3g} px, page cache {}; the first frame is settled without a time limit",
                  limits.tau_px, byte_count(limits.cache_bytes));
  chart.x.label = "time (s)";
  chart.panels = {triangle_panel(frames, limits), adapt_panel(frames, limits), sse_panel(frames, limits),
                  resident_panel(frames, limits)};
  return plot::write_svg(path, chart);
}

Result<void> write_text(const std::filesystem::path& path, const std::string& text) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  if (auto r = file->write(std::as_bytes(std::span(text))); !r) return r;
  return file->commit();
}

}  // namespace cuesta::app
