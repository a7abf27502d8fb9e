#include "runtime/flight.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ooc/check.h"
#include "runtime/view_fit.h"

namespace cuesta {
namespace {

constexpr double frame_slack = 1e-6;  // of a frame, for times that are a multiple of 1 / fps but for rounding

Vec3d mix(Vec3d a, Vec3d b, double t) {
  return a * (1 - t) + b * t;
}

/// Cubic Hermite between a and b with tangents in units of the whole interval.
Vec3d hermite(Vec3d a, Vec3d tangent_a, Vec3d b, Vec3d tangent_b, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return a * (2 * t3 - 3 * t2 + 1) + tangent_a * (t3 - 2 * t2 + t) + b * (3 * t2 - 2 * t3) +
         tangent_b * (t3 - t2);
}

/// Velocity at a keyframe: one-sided at the ends.
Vec3d velocity(const std::vector<Keyframe>& keys, std::size_t i, Vec3d Keyframe::*member) {
  const Keyframe& before = keys[i > 0 ? i - 1 : 0];
  const Keyframe& after = keys[std::min(i + 1, keys.size() - 1)];
  const double span = after.time_s - before.time_s;
  return span > 0 ? (after.*member - before.*member) / span : Vec3d{};
}

Vec3d spline(const std::vector<Keyframe>& keys, std::size_t i, double t, Vec3d Keyframe::*member) {
  const double span = keys[i + 1].time_s - keys[i].time_s;
  return hermite(keys[i].*member, velocity(keys, i, member) * span, keys[i + 1].*member,
                 velocity(keys, i + 1, member) * span, t);
}

Keyframe interpolate(const std::vector<Keyframe>& keys, double time_s) {
  if (time_s <= keys.front().time_s) return keys.front();
  if (time_s >= keys.back().time_s) return keys.back();
  const auto after = std::upper_bound(keys.begin(), keys.end(), time_s,
                                      [](double t, const Keyframe& k) { return t < k.time_s; });
  const auto i = static_cast<std::size_t>(after - keys.begin()) - 1;
  const Keyframe &a = keys[i], &b = keys[i + 1];
  const double t = (time_s - a.time_s) / (b.time_s - a.time_s);
  Keyframe k;
  k.time_s = time_s;
  k.eye = spline(keys, i, t, &Keyframe::eye);
  k.target = spline(keys, i, t, &Keyframe::target);
  if (k.eye == k.target) k.eye = mix(a.eye, b.eye, t), k.target = mix(a.target, b.target, t);
  if (k.eye == k.target) k.eye = a.eye, k.target = a.target;
  k.up = mix(a.up, b.up, t);
  if (dot(k.up, k.up) == 0) k.up = a.up;
  k.fov_deg = a.fov_deg * (1 - t) + b.fov_deg * t;
  return k;
}

/// Right and front of the model's frame, orthonormal with up.
struct ModelFrame {
  Vec3d right, front, up;
};
ModelFrame model_frame(Vec3d up) {
  const Vec3d above = normalized(up);
  const Vec3d front = front_direction(above);
  return {cross(above, front), front, above};
}

/// Half the box's size along a unit direction.
double half_extent(const Box3d& box, Vec3d direction) {
  const Vec3d half = (box.hi - box.lo) * 0.5;
  return std::abs(direction.x) * half.x + std::abs(direction.y) * half.y + std::abs(direction.z) * half.z;
}

struct FlightPlan {
  std::span<const Vec3d> points;
  Vec3d surface;
  Box3d box;
  const View& view;
  Vec3d centre;
  ModelFrame frame;

  Keyframe key(double time_s, Vec3d eye, Vec3d target) const {
    return {time_s, eye, target, frame.up, view.fov_y_rad * 180 / std::numbers::pi};
  }

  void orbit(double seconds, Flight& flight) const {
    constexpr int parts = 32;
    constexpr double rise = 0.3;
    double distance = 0;
    std::array<Vec3d, parts + 1> directions;
    for (int i = 0; i <= parts; ++i) {
      const double angle = 2 * std::numbers::pi * (i % parts) / parts;
      directions[static_cast<std::size_t>(i)] =
          normalized(frame.front * std::cos(angle) + frame.right * std::sin(angle) + frame.up * rise);
      distance =
          std::max(distance, fit_distance(points, centre, directions[static_cast<std::size_t>(i)], view));
    }
    for (std::size_t i = 0; i <= parts; ++i)
      flight.keyframes.push_back(
          key(seconds * static_cast<double>(i) / parts, centre + directions[i] * distance, centre));
  }

  void zoom_in(double seconds, Flight& flight) const {
    constexpr int parts = 24;
    const Vec3d direction = three_quarter_direction(frame.up);
    const double far = fit_distance(points, centre, direction, view);
    const double near = length(box.hi - box.lo) * 0.01;
    for (int i = 0; i <= parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      const double distance = far * std::pow(near / far, t);
      const Vec3d aim = mix(centre, surface, std::min(1.0, 2 * t));
      flight.keyframes.push_back(key(seconds * t, aim + direction * distance, aim));
    }
  }

  void fly_over(double seconds, Flight& flight) const {
    constexpr int parts = 16;
    const Vec3d along =
        half_extent(box, frame.right) > half_extent(box, frame.front) ? frame.right : -frame.front;
    const double reach = half_extent(box, along);
    const double top = half_extent(box, frame.up);
    const double above = top + 0.15 * (reach + top);
    for (int i = 0; i <= parts; ++i) {
      const double t = static_cast<double>(i) / parts;
      const Vec3d eye = centre + along * (reach * (2.1 * t - 1.9)) + frame.up * above;
      flight.keyframes.push_back(key(seconds * t, eye, centre + along * (reach * (1.3 * t - 0.5))));
    }
  }

  /// Times are tenths of the whole.
  void walk_through(double seconds, Flight& flight) const {
    const Vec3d far = fit_view(points, three_quarter_direction(frame.up), view).eye;
    const double reach = length(far - centre);
    const auto add = [&](double tenths, Vec3d eye, Vec3d target) {
      flight.keyframes.push_back(key(seconds * tenths / 10, eye, target));
    };
    for (int i = 0; i <= 6; ++i) {
      const double turn = 2 * std::numbers::pi * i / 6;
      const Vec3d around = frame.right * std::sin(turn) + frame.front * std::cos(turn) + frame.up * 0.3;
      add(i * 0.5, centre + around * reach, centre);
    }
    const Vec3d inside = centre + (far - centre) * 0.15;
    add(4.5, inside, centre);
    for (int i = 1; i <= 4; ++i) {
      const double turn = std::numbers::pi / 2 * i;
      const Vec3d ahead = frame.right * std::sin(turn) - frame.front * std::cos(turn);
      const Vec3d aside = frame.right * std::cos(turn) + frame.front * std::sin(turn);
      add(4.5 + i, inside, inside + ahead * (0.1 * reach));
      add(4.65 + i, inside, inside + ahead * (0.1 * reach) + aside * (0.02 * reach));
    }
    add(10, far, centre);
  }
};

}  // namespace

std::uint64_t frame_count(const Flight& flight) {
  const double seconds = flight.keyframes.back().time_s - flight.keyframes.front().time_s;
  return static_cast<std::uint64_t>(seconds * flight.fps + frame_slack) + 1;
}

double frame_time(const Flight& flight, std::uint64_t frame) {
  return static_cast<double>(frame) / flight.fps;
}

View flight_view(const Flight& flight, double time_s, const View& size) {
  const Keyframe k = interpolate(flight.keyframes, flight.keyframes.front().time_s + time_s);
  View view = size;
  view.eye = k.eye;
  view.target = k.target;
  view.up = k.up;
  view.fov_y_rad = k.fov_deg * std::numbers::pi / 180;
  return view;
}

Flight make_flight(FlightKind kind, const FlightSubject& subject, const View& view, std::uint64_t frames,
                   double fps) {
  const Box3d box = box_of(subject.points);
  CUESTA_CHECK(frames >= 2 && fps > 0 && !box.empty(), frames, fps);
  Flight flight;
  flight.fps = fps;
  const double seconds = static_cast<double>(frames - 1) / fps;
  const FlightPlan plan{subject.points, subject.surface,         box,
                        view,           (box.lo + box.hi) * 0.5, model_frame(view.up)};
  if (kind == FlightKind::orbit) plan.orbit(seconds, flight);
  if (kind == FlightKind::zoom_in) plan.zoom_in(seconds, flight);
  if (kind == FlightKind::fly_over) plan.fly_over(seconds, flight);
  if (kind == FlightKind::walk_through) plan.walk_through(seconds, flight);
  return flight;
}

}  // namespace cuesta
