#include "apps/view/camera_controls.h"

#include <cmath>
#include <numbers>

namespace cuesta::view {
namespace {

constexpr double least_angle_rad = std::numbers::pi / 180;  // between the line of sight and up
constexpr double zoom_per_notch = 0.85;
constexpr double speed_per_notch = 1.25;
constexpr double fast_factor = 4, slow_factor = 0.25;
constexpr double start_speed = 0.125;        // diagonals per second
constexpr double start_height = 0.005;       // diagonals: of someone who walks
constexpr double least_distance = 1e-9;      // diagonals
constexpr double heights_per_second = 0.75;  // over ground
constexpr double reach_above = 0.02;         // diagonals: from where the ground below the eye is looked for
constexpr double ground_rate = 8;            // per second: how fast the eye follows the ground
constexpr double double_click_px = 4;

Vec3d rotated(Vec3d v, Vec3d axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

/// `v` turned about up by `yaw`, then towards up by `pitch`, as far as the poles allow.
Vec3d turned_direction(Vec3d v, Vec3d up, double yaw, double pitch) {
  const double size = length(v);
  const double elevation = std::acos(std::clamp(dot(v, up) / size, -1.0, 1.0));  // from up: 0…π
  const double wanted = std::clamp(elevation - pitch, least_angle_rad, std::numbers::pi - least_angle_rad);
  Vec3d level = v - up * dot(v, up);
  if (length(level) < 1e-12 * size) {  // along the pole: any way will do
    level = cross(up, std::abs(up.x) < 0.7 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0});
  }
  level = rotated(normalized(level), up, yaw);
  return (up * std::cos(wanted) + level * std::sin(wanted)) * size;
}

double radians_per_pixel(const View& view) {
  return view.fov_y_rad / view.height_px;
}

View shifted(const View& view, Vec3d by) {
  View v = view;
  v.eye = v.eye + by;
  v.target = v.target + by;
  return v;
}

}  // namespace

View orbited(const View& view, double dx_px, double dy_px) {
  View v = view;
  const double per_px = std::numbers::pi / view.height_px;
  v.eye = view.target +
          turned_direction(view.eye - view.target, normalized(view.up), -dx_px * per_px, dy_px * per_px);
  return v;
}

View panned(const View& view, double dx_px, double dy_px) {
  const auto [right, up, back] = view.frame();
  const double per_px = length(view.eye - view.target) / view.pixels_per_unit();
  const Vec3d by = right * (-dx_px * per_px) + up * (dy_px * per_px);
  View v = view;
  v.eye = v.eye + by;
  v.target = v.target + by;
  return v;
}

View zoomed(const View& view, double notches, Vec3d point, double least) {
  double factor = std::pow(zoom_per_notch, notches);
  const double distance = length(view.eye - view.target);
  if (factor < 1) factor = std::min(1.0, std::max(factor, least / distance));
  View v = view;
  v.eye = point + (view.eye - point) * factor;
  v.target = point + (view.target - point) * factor;
  if (v.eye == v.target) return view;
  return v;
}

View turned(const View& view, double dx_px, double dy_px) {
  constexpr double gain = 1.6;  // a little more than what the pointer is over
  const double per_px = gain * radians_per_pixel(view);
  View v = view;
  v.target = view.eye +
             turned_direction(view.target - view.eye, normalized(view.up), -dx_px * per_px, -dy_px * per_px);
  return v;
}

View moved(const View& view, double right, double up, double forward) {
  const auto [r, u, back] = view.frame();
  return shifted(view, r * right + normalized(view.up) * up - back * forward);
}

View stepped(const View& view, double right, double forward) {
  const auto [r, u, back] = view.frame();
  const Vec3d ahead = cross(normalized(view.up), r);  // right and up are perpendicular
  return shifted(view, r * right + ahead * forward);
}

View raised(const View& view, double by) {
  return shifted(view, normalized(view.up) * by);
}

View levelled(const View& view, Vec3d up) {
  const Vec3d was = normalized(view.up), axis = cross(was, up);
  const double sine = length(axis), cosine = dot(was, up);
  View v = view;
  v.up = up;
  if (sine < 1e-15) return v;
  const Vec3d ahead = rotated(view.target - view.eye, axis / sine, std::atan2(sine, cosine));
  v.target = view.eye + turned_direction(ahead, up, 0, 0);
  return v;
}

Vec3d ray_direction(const View& view, double x_px, double y_px) {
  const auto [right, up, back] = view.frame();
  const double per_px = 1 / view.pixels_per_unit();
  return normalized(right * ((x_px - view.width_px / 2.0) * per_px) -
                    up * ((y_px - view.height_px / 2.0) * per_px) - back);
}

bool CameraControls::moving() const {
  return held_.any() || (mode_ == ControlMode::walk && !above_ground_);
}

void CameraControls::set_picture_size(int width_px, int height_px) {
  view_.width_px = width_px;
  view_.height_px = height_px;
}

void CameraControls::set_model_size(double diagonal) {
  diagonal_ = diagonal > 0 ? diagonal : 1;
  speed_ = start_speed * diagonal_;
}

void CameraControls::set_mode(ControlMode mode) {
  if (mode == mode_) return;
  mode_ = mode;
  const Vec3d forward = normalized(view_.target - view_.eye);
  if (mode == ControlMode::orbit) {
    const auto hit = ray_(view_.eye, forward);  // turn about what is in the middle
    if (hit && length(*hit - view_.eye) > least_distance * diagonal_)
      view_.target = view_.eye + forward * length(*hit - view_.eye);
  }
  if (mode == ControlMode::walk) {
    height_ = ground_ ? ground_->eye_height : start_height * diagonal_;
    speed_ = ground_ ? 4 * height_ : std::min(speed_, 4 * height_);
    above_ground_ = false;
  }
  if (mode == ControlMode::fly)
    speed_ = ground_ ? heights_per_second : std::max(speed_, start_speed * diagonal_ / 8);
  if (mode != ControlMode::orbit && ground_) enter_ground(forward);
}

/// Who looks at terrain from beside it walks on what is in the middle of the picture, and flies as if it were
/// below.
void CameraControls::enter_ground(Vec3d forward) {
  const auto height = height_above_ground();
  const auto ahead = ray_(view_.eye, forward);
  if (mode_ == ControlMode::walk && !height && ahead)
    view_ = shifted(view_, *ahead + ground_->up(*ahead) * ground_->eye_height - view_.eye);
  // Only what is up changes, and not the picture, unless the line of sight is too near to it.
  view_.up = ground_->up(view_.eye);
  view_.target = view_.eye + turned_direction(view_.target - view_.eye, view_.up, 0, 0);
  ground_height_ = height.value_or(ahead ? length(*ahead - view_.eye) : start_speed * diagonal_);
}

void CameraControls::level() {
  if (ground_) view_ = levelled(view_, ground_->up(view_.eye));
}

std::optional<double> CameraControls::height_above_ground() const {
  const Vec3d up = ground_ ? ground_->up(view_.eye) : normalized(view_.up);
  // From above, as the eye may be under the ground; from inside a globe its far side would be below.
  for (const double above : {reach_above * diagonal_, diagonal_})
    if (const auto hit = ray_(view_.eye + up * above, -up)) return dot(view_.eye - *hit, up);
  return {};
}

void CameraControls::surface_changed() {
  if (mode_ == ControlMode::walk) above_ground_ = false;
  if (is_over_ground()) stay_above_ground();
}

void CameraControls::stay_above_ground() {
  const auto height = height_above_ground();
  if (!height) return;
  ground_height_ = *height;
  if (*height >= ground_->least_height) return;
  view_ = raised(view_, ground_->least_height - *height);
  ground_height_ = ground_->least_height;
}

bool CameraControls::hold(Key key, bool down) {
  bool* held = nullptr;
  if (key == key_of('W') || key == Key::up) held = &held_.forward;
  if (key == key_of('S') || key == Key::down) held = &held_.back;
  if (key == key_of('A') || key == Key::left) held = &held_.left;
  if (key == key_of('D') || key == Key::right) held = &held_.right;
  if (key == key_of('E') || key == Key::page_up) held = &held_.up;
  if (key == key_of('Q') || key == Key::page_down) held = &held_.down;
  if (key == Key::shift) held = &held_.fast;
  if (key == Key::alt) held = &held_.slow;
  if (held) *held = down;
  return held != nullptr;
}

bool CameraControls::press(const WindowEvent& event) {
  dragging_ = true;
  button_ = event.button;
  sideways_ = event.button != MouseButton::left || event.shift;
  const bool again = std::abs(event.x - click_x_) + std::abs(event.y - click_y_) < double_click_px;
  click_x_ = event.x;
  click_y_ = event.y;
  if (!again || sideways_ || mode_ != ControlMode::orbit) return true;
  // A second press at the same place: what is there becomes the middle.
  if (const auto hit = ray_(view_.eye, ray_direction(view_, event.x, event.y))) {
    const Vec3d by = *hit - view_.target;
    view_.eye = view_.eye + by;
    view_.target = *hit;
  }
  click_x_ = -1e9;
  return true;
}

bool CameraControls::drag(const WindowEvent& event) {
  if (!dragging_) return false;
  if (event.dx != 0 || event.dy != 0) click_x_ = -1e9;
  if (mode_ != ControlMode::orbit)
    view_ = turned(view_, event.dx, event.dy);
  else
    view_ = sideways_ ? panned(view_, event.dx, event.dy) : orbited(view_, event.dx, event.dy);
  return true;
}

bool CameraControls::scroll(const WindowEvent& event) {
  if (mode_ != ControlMode::orbit) {
    speed_ *= std::pow(speed_per_notch, event.notches);
    return true;
  }
  const auto hit = ray_(view_.eye, ray_direction(view_, event.x, event.y));
  // Nearer than the surface under the pointer the target would be of no use: it comes there, too.
  if (hit) {
    const double distance = dot(*hit - view_.eye, normalized(view_.target - view_.eye));
    if (distance > least_distance * diagonal_)
      view_.target = view_.eye + normalized(view_.target - view_.eye) * distance;
  }
  view_ = zoomed(view_, event.notches, hit.value_or(view_.target), least_distance * diagonal_);
  return true;
}

bool CameraControls::handle(const WindowEvent& event) {
  using Kind = WindowEvent::Kind;
  switch (event.kind) {
    case Kind::key_down:
      return !event.control && hold(event.key, true);
    case Kind::key_up:
      return hold(event.key, false);
    case Kind::button_down:
      return press(event);
    case Kind::button_up:
      if (event.button == button_) dragging_ = false;
      return true;
    case Kind::move:
      return drag(event);
    case Kind::scroll:
      return scroll(event);
    case Kind::leave:
      held_ = {};
      dragging_ = false;
      return false;
    default:
      return false;
  }
}

/// The eye comes to its height above the surface, quickly but not at once. Where nothing is below, it stays.
bool CameraControls::follow_ground(double seconds) {
  const Vec3d up = normalized(view_.up);
  above_ground_ = true;
  // From above the eye, so that a slope that came through it lifts it.
  const double above = std::max(4 * height_, reach_above * diagonal_);
  auto hit = ray_(view_.eye + up * above, -up);
  if (!hit) hit = ray_(view_.eye + up * (2 * diagonal_), -up);
  if (!hit) return false;
  const double wanted = height_ - dot(view_.eye - *hit, up);
  if (std::abs(wanted) < 1e-3 * height_) return false;
  above_ground_ = false;
  view_ = raised(view_, wanted * (1 - std::exp(-ground_rate * seconds)));
  return true;
}

bool CameraControls::advance(double seconds) {
  if (!moving()) return false;
  const auto both = [](bool plus, bool minus) {
    return static_cast<double>(plus) - static_cast<double>(minus);
  };
  const double right = both(held_.right, held_.left), up = both(held_.up, held_.down),
               forward = both(held_.forward, held_.back);
  double way = seconds * (held_.fast ? fast_factor : 1) * (held_.slow ? slow_factor : 1);
  if (mode_ == ControlMode::orbit) {  // keys go round, and nearer
    const double px = way * view_.height_px * 0.4;
    view_ = orbited(view_, -right * px, up * px);
    view_ = zoomed(view_, forward * way * 5, view_.target, least_distance * diagonal_);
    return true;
  }
  way *= speed();
  if (mode_ == ControlMode::fly) {
    view_ = moved(view_, right * way, up * way, forward * way);
    level();
    if (ground_) stay_above_ground();
    return true;
  }
  height_ *= std::exp(up * seconds);
  view_ = stepped(view_, right * way, forward * way);
  level();
  const bool fell = follow_ground(seconds);
  return fell || held_.any();
}

}  // namespace cuesta::view
