#include "apps/view/flight_recorder.h"

#include <algorithm>
#include <numbers>
#include <utility>

namespace cuesta::view {
namespace {

bool shows(const Keyframe& k, const View& view) {
  return k.eye == view.eye && k.target == view.target && k.up == view.up;
}

}  // namespace

void FlightRecorder::start(double now_s) {
  *this = {};
  recording_ = true;
  start_s_ = now_s_ = now_s;
}

void FlightRecorder::push(double now_s, const View& view) {
  const double time_s = flight_.keyframes.empty() ? 0 : now_s - start_s_;
  if (!flight_.keyframes.empty() && time_s <= flight_.keyframes.back().time_s) return;
  flight_.keyframes.push_back(
      {time_s, view.eye, view.target, view.up, view.fov_y_rad * 180 / std::numbers::pi});
}

void FlightRecorder::add(double now_s, const View& view) {
  if (!recording_) return;
  const bool first = flight_.keyframes.empty();
  if (!first && !shows(flight_.keyframes.back(), view)) {
    // The camera stood still until just now: it must not begin to drift at the last keyframe.
    const double still_until_s = std::max(now_s_, now_s - least_interval_s);
    const bool stood = last_ && shows(flight_.keyframes.back(), *last_);
    if (stood && still_until_s - start_s_ - flight_.keyframes.back().time_s >= least_interval_s)
      push(still_until_s, *last_);
    if (now_s - start_s_ - flight_.keyframes.back().time_s >= least_interval_s) push(now_s, view);
  }
  if (first) push(now_s, view);
  now_s_ = now_s;
  last_ = view;
}

std::optional<Flight> FlightRecorder::finish() {
  if (last_) push(now_s_, *last_);
  recording_ = false;
  last_.reset();
  if (flight_.keyframes.empty()) return {};
  return std::exchange(flight_, {});
}

}  // namespace cuesta::view
