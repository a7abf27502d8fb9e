#pragma once
/// A camera moved by mouse and keys, as people know it: orbit, fly and walk.

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>

#include "runtime/draw/window.h"
#include "runtime/view.h"

namespace cuesta::view {

/// Each of these is a camera moved a little. Pixels are of the picture, from the top left; `up` of the view
/// is the world's and stays. Eye and target stay apart, and the line of sight at least 1° off `up`.
/// @{
/// Around the target, so that half a turn takes the picture's height.
View orbited(const View& view, double dx_px, double dy_px);
/// Sideways, so that what is at the target's distance follows the pointer.
View panned(const View& view, double dx_px, double dy_px);
/// A wheel's notches towards `point` (positive) or away from it; what is there stays where it is in the
/// picture. The target comes no nearer to the eye than `least_distance`.
View zoomed(const View& view, double notches, Vec3d point, double least_distance);
/// Turned about the eye: to the right and down with the pointer.
View turned(const View& view, double dx_px, double dy_px);
/// Moved by lengths along the camera's right, the world's up, and where the camera looks.
View moved(const View& view, double right, double up, double forward);
/// Moved across the world's horizon.
View stepped(const View& view, double right, double forward);
/// Raised or lowered, with its target.
View raised(const View& view, double by);
/// @}

/// Where a pixel's centre looks, unit.
Vec3d ray_direction(const View& view, double x_px, double y_px);

enum class ControlMode : std::uint8_t {
  orbit,  ///< drag: around the target; right or middle button, or shift: sideways; wheel: to what is under
          ///< the pointer
  fly,    ///< drag: look around; W A S D: move; Q and E: down and up; wheel: speed
  walk,   ///< as fly, at a height above the surface; Q and E change the height
};

/// First point of the surface on a ray, if any. Directions are unit.
using SurfaceRay = std::function<std::optional<Vec3d>(Vec3d origin, Vec3d direction)>;

/// What terrain changes for a camera. Lengths in world units.
struct GroundRules {
  std::function<Vec3d(Vec3d)> up;  ///< at a point, unit
  double least_height = 2;         ///< of a flying eye above the ground
  double eye_height = 2;           ///< of someone who begins to walk
};

/// `view` with the up of where its eye is. It looks as far above the horizon, and as far to the side, as
/// before.
View levelled(const View& view, Vec3d up);

/// What mouse and keys do to a camera. Knows no window and no clock.
class CameraControls {
 public:
  explicit CameraControls(SurfaceRay ray) : ray_(std::move(ray)) {}

  const View& view() const { return view_; }
  ControlMode mode() const { return mode_; }
  /// World units per second.
  double speed() const {
    return is_over_ground() ? speed_ * std::max(ground_height_, ground_->least_height) : speed_;
  }
  /// True while the pointer should have no bounds, for a drag has begun.
  bool dragging() const { return dragging_; }
  /// True while held keys move the camera, or it settles on the ground.
  bool moving() const;

  void set_view(const View& view) { view_ = view; }
  void set_picture_size(int width_px, int height_px);
  /// Length of the model's diagonal: speeds and heights start from it.
  void set_model_size(double diagonal);
  void set_mode(ControlMode mode);
  /// From now on up is that of the place when flying and walking; flying is as fast as the eye is high above
  /// the ground, and never below it.
  void set_ground(GroundRules rules) { ground_ = std::move(rules); }
  /// The surface is drawn finer or coarser now: who walks comes to its new height, and who flies stays above
  /// it.
  void surface_changed();
  /// Of the eye; negative under the ground, nothing where there is none below or above it.
  std::optional<double> height_above_ground() const;

  /// @return true if the event was for the camera (which need not have moved yet).
  bool handle(const WindowEvent& event);
  /// Held keys move the camera for `seconds`. @return true if it moved.
  bool advance(double seconds);

 private:
  struct Held {
    bool left = false, right = false, forward = false, back = false, up = false, down = false;
    bool fast = false, slow = false;
    bool any() const { return left || right || forward || back || up || down; }
  };
  bool hold(Key key, bool down);
  bool press(const WindowEvent& event);
  bool drag(const WindowEvent& event);
  bool scroll(const WindowEvent& event);
  bool follow_ground(double seconds);
  bool is_over_ground() const { return ground_ && mode_ == ControlMode::fly; }
  void enter_ground(Vec3d forward);
  void level();
  void stay_above_ground();

  SurfaceRay ray_;
  View view_;
  ControlMode mode_ = ControlMode::orbit;
  double diagonal_ = 1;
  double speed_ = 0.125;  ///< world units per second; flying over ground: heights above it per second
  std::optional<GroundRules> ground_;
  double ground_height_ = 0;  ///< flying over ground: where it was known last
  double height_ = 0;         ///< walk: of the eye above the surface
  bool above_ground_ = true;  ///< walk: nothing left to do to reach that height
  Held held_;
  bool dragging_ = false;
  MouseButton button_ = MouseButton::left;
  bool sideways_ = false;
  double click_x_ = -1e9, click_y_ = -1e9;  ///< where the last press was, for a second one there
};

}  // namespace cuesta::view
