#include "runtime/error_scale.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace cuesta {
namespace {

std::array<Vec3d, 5> frustum(const View& view, double widen) {
  const auto [right, up, back] = view.frame();
  const Vec3d ahead = -back;
  const double half_y = view.fov_y_rad / 2;
  const double half_x = std::atan(std::tan(half_y) * view.width_px / view.height_px);
  const double limit = std::numbers::pi / 2 - 1e-3;
  const double x = std::min(half_x * widen, limit);
  const double y = std::min(half_y * widen, limit);
  return {ahead * std::sin(x) + right * std::cos(x), ahead * std::sin(x) - right * std::cos(x),
          ahead * std::sin(y) + up * std::cos(y), ahead * std::sin(y) - up * std::cos(y), ahead};
}

/// How much longer than `exaggeration` a way may become on an ellipsoid.
constexpr double curve_stretch = 1.01;

}  // namespace

ErrorScale ErrorScale::uniform(const Grid& grid) {
  ErrorScale s;
  s.unit_ = 1 / grid.step;
  return s;
}

ErrorScale ErrorScale::part(const Grid& grid, SurfacePart part, double border_share) {
  ErrorScale s = uniform(grid);
  s.part_ = std::move(part);
  s.border_share_ = border_share;
  return s;
}

double ErrorScale::share(const Sphere& s) const {
  if (!part_) return 1;
  switch (part_->place(s)) {
    case SurfacePart::Place::inside:
      return 1;
    case SurfacePart::Place::border:
      return border_share_;
    case SurfacePart::Place::outside:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

std::optional<double> ErrorScale::same_within(const Sphere& bound) const {
  if (part_ && part_->place(bound) == SurfacePart::Place::border) return std::nullopt;
  return share(bound);
}

ErrorScale ErrorScale::perspective(const Grid& grid, const View& view, double outside_factor, double margin) {
  ErrorScale s;
  s.uniform_ = false;
  s.unit_ = 1 / view.pixels_per_unit();
  s.outside_factor_ = outside_factor;
  s.eye_ = (view.eye - grid.origin) / grid.step;
  s.wide_ = frustum(view, 1 + margin);
  s.sides_ = frustum(view, 1);
  return s;
}

ErrorScale ErrorScale::exaggerated(const Grid& grid, const Relief& relief) const {
  ErrorScale s = *this;
  if (relief.exaggeration == 1 || uniform_) return s;
  s.relief_ = relief.in(grid);
  s.eye_ = s.relief_->lowered(eye_);
  s.unit_ = unit_ / std::max(relief.exaggeration, 1 / relief.exaggeration);
  return s;
}

bool ErrorScale::outside(const std::array<Vec3d, 5>& planes, const Sphere& bound) const {
  Vec3d centre = vec_cast<double>(bound.centre), eye = eye_;
  double radius = bound.radius;
  if (relief_) {
    centre = relief_->raised(centre);
    eye = relief_->raised(eye);
    radius *= std::max(1.0, relief_->exaggeration) * (relief_->is_plane() ? 1 : curve_stretch);
  }
  return std::any_of(planes.begin(), planes.end(),
                     [&](const Vec3d& n) { return dot(n, centre - eye) < -radius; });
}

double ErrorScale::page_factor(const Sphere& bound) const {
  if (uniform_ || outside_factor_ <= 1) return 1;
  return outside(wide_, bound) ? outside_factor_ : 1;
}

bool ErrorScale::invisible(const Sphere& bound) const {
  return !uniform_ && outside(sides_, bound);
}

double ErrorScale::near(const Sphere& s) const {
  return std::max(length(vec_cast<double>(s.centre) - eye_) - static_cast<double>(s.radius), nearest);
}

ErrorScale ErrorScale::moved(Vec3d by_grid_units) const {
  ErrorScale s = *this;
  s.eye_ = s.eye_ + by_grid_units;
  return s;
}

}  // namespace cuesta
