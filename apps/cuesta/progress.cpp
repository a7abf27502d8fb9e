#include "apps/cuesta/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/text_forms.h"

namespace cuesta::app {
namespace {

constexpr double terminal_interval_ms = 100;
constexpr double plain_interval_ms = 5000;
constexpr int bar_width = 24;
constexpr double least_ms_for_rate = 200;  // below, rates are noise

std::string amount(Unit unit, double n) {
  const auto whole = static_cast<std::uint64_t>(std::max(0.0, n));
  switch (unit) {
    case Unit::bytes:
      return byte_count(whole);
    case Unit::postings:
      return with_commas(whole) + " postings";
    case Unit::triangles:
      return with_commas(whole) + " triangles";
    case Unit::pages:
      return with_commas(whole) + " pages";
    case Unit::frames:
      return with_commas(whole) + " frames";
    case Unit::none:
      break;
  }
  return with_commas(whole);
}

std::string bar(double part) {
  const int full = static_cast<int>(part * bar_width);
  return fmt::format("[{:#<{}}{:.<{}}]", "", full, "", bar_width - full);
}

}  // namespace

Progress::Progress(bool quiet, std::FILE* stream)
    : stream_(stream), quiet_(quiet), terminal_(isatty(fileno(stream)) != 0) {}

bool Progress::update(std::string_view stage, Unit unit, std::uint64_t done, std::uint64_t total) {
  if (stop_requested()) return false;
  if (quiet_) return true;
  const double now = clock_ms();
  if (!open_ || stage != stage_) begin(stage, unit, now);
  done_ = done;
  total_ = total;
  if (now - printed_ms_ >= (terminal_ ? terminal_interval_ms : plain_interval_ms)) print(now, false);
  return true;
}

void Progress::begin(std::string_view stage, Unit unit, double now_ms) {
  finish();
  open_ = true;
  stage_ = stage;
  unit_ = unit;
  start_ms_ = now_ms;
  printed_ms_ = terminal_ ? 0 : now_ms;
}

std::string Progress::line(double now_ms) const {
  std::string text = fmt::format("{:<12}", stage_);
  const double elapsed_ms = now_ms - start_ms_;
  const double part =
      total_ > 0 ? std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_)) : 0;
  if (total_ > 0) text += fmt::format(" {} {:3.0f} %", bar(part), part * 100);
  if (unit_ != Unit::none && done_ > 0 && elapsed_ms > least_ms_for_rate) {
    text += "  " + amount(unit_, static_cast<double>(done_) * 1000 / elapsed_ms) + "/s";
    if (part > 0 && part < 1) text += "  " + duration(elapsed_ms * (1 - part) / part / 1000) + " left";
  }
  return text + "  " + byte_count(resident_bytes()) + " used";
}

void Progress::print(double now_ms, bool last) {
  printed_ms_ = now_ms;
  if (terminal_)
    fmt::print(stream_, "\r\x1b[K{}{}", line(now_ms), last ? "\n" : "");
  else
    fmt::print(stream_, "{}\n", line(now_ms));
  std::fflush(stream_);
}

void Progress::close(bool done) {
  if (open_ && !quiet_) {
    if (done) done_ = total_;
    print(clock_ms(), true);
  }
  open_ = false;
}

}  // namespace cuesta::app
