#pragma once
/// What a viewer shows: surfaces, or a scene of many parts. The viewer has the window, the camera, flights,
/// messages and the script; a subject knows what is looked at, and how it is drawn.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/cuesta/view_command.h"
#include "apps/view/camera_controls.h"
#include "apps/view/view_keys.h"
#include "runtime/draw/gl_context.h"
#include "runtime/draw/text_overlay.h"

namespace cuesta::app {

/// What a subject must know of the moment to make a frame of it. The camera is that of its controls.
struct ViewMoment {
  double now_s = 0;
  bool must_draw = false;    ///< the camera, the window or what is written has changed
  bool was_at_rest = false;  ///< nothing happened before this frame
  bool in_flight = false;    ///< the camera follows a flight
};

struct ViewedFrame {
  bool drawn = false;    ///< there is another picture to show
  bool settled = false;  ///< and no other will come, while the camera stays
};

/// What the viewer measured.
struct ViewTimes {
  double frame_ms = 0;  ///< between the last frames, a running mean
  double show_ms = 0;   ///< text and window, of the last frame
};

/// Threads: the main thread only. A subject has the viewer's controls, and is asked by them what a ray meets.
class ViewSubject {
 public:
  virtual ~ViewSubject() = default;

  virtual bool is_empty() const = 0;
  /// Of its files.
  virtual std::string title() const = 0;
  /// Makes the renderer. Once, before anything is drawn.   @error of the driver
  virtual Result<void> draw_into(std::unique_ptr<GlContext> context) = 0;

  /// Some of what is there, for cameras that show all; empty if nothing is.
  virtual std::vector<Vec3d> points() const = 0;
  /// The camera of the first picture.   @pre !is_empty()
  virtual View first_view(const View& picture) const = 0;
  /// The nearest surface along a ray, as it is drawn.   @param direction  unit
  virtual std::optional<Vec3d> hit(Vec3d origin, Vec3d direction) const = 0;

  /// A file that was dropped on the window.   @return what to say
  virtual std::string add(const std::filesystem::path& file) = 0;
  /// What is not the viewer's own to do.   @return what to say; empty: nothing
  virtual std::string act(view::Action action) = 0;
  /// The pointer, where a subject listens to it.
  enum class Taken : std::uint8_t {
    no,
    noticed,
    whole
  };  ///< noticed: a picture is due; whole: not for the camera
  virtual Taken take(const WindowEvent& event) = 0;

  /// Adapts to the camera, and draws what there is to draw.   @error of drawing
  virtual Result<ViewedFrame> frame(const ViewMoment& moment) = 0;
  virtual Result<void> show(int width_px, int height_px, std::span<const TextBlock> text, int text_scale) = 0;
  virtual Result<Picture> read() = 0;
  virtual std::vector<std::string> statistics(const ViewTimes& times) const = 0;

  /// From now on frames are kept for frames_csv().
  virtual void record_frames() = 0;
  /// Those since then, one row each; they are forgotten.
  virtual std::string take_frames_csv() = 0;
  /// What could not be read, and is drawn coarser.
  virtual std::vector<Error> errors() const = 0;
};

/// @param controls  outlive the subject   @param files  may be none
/// @error of reading the files; invalid_input: heights of what is no terrain; a scene beside other files
Result<std::unique_ptr<ViewSubject>> open_subject(const ViewSettings& settings,
                                                  const std::vector<std::filesystem::path>& files,
                                                  view::CameraControls& controls);
Result<std::unique_ptr<ViewSubject>> open_surface_subject(const ViewSettings& settings,
                                                          const std::vector<std::filesystem::path>& files,
                                                          view::CameraControls& controls);
Result<std::unique_ptr<ViewSubject>> open_scene_subject(const ViewSettings& settings,
                                                        const std::filesystem::path& file,
                                                        view::CameraControls& controls);

}  // namespace cuesta::app
