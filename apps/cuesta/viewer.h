#pragma once
/// The window of cuesta view and its loop: camera, flights, messages, pictures, whatever is shown.

#include <memory>
#include <optional>

#include "apps/cuesta/view_subject.h"
#include "apps/view/flight_player.h"
#include "apps/view/flight_recorder.h"
#include "apps/view/view_script.h"
#include "runtime/draw/window.h"

namespace cuesta::app {

class Viewer {
 public:
  /// @error as run_view()
  static Result<std::unique_ptr<Viewer>> open(const ViewSettings& settings);
  /// Until the window is closed, or a stop is asked for.
  Result<void> run();

 private:
  explicit Viewer(const ViewSettings& settings);

  Result<void> open_window();
  void drop(const std::vector<std::filesystem::path>& paths);
  Result<void> begin_with(const std::vector<std::filesystem::path>& paths);
  void fit();

  void take_events();
  void take(const WindowEvent& event);
  void act(view::Action action);
  void leave();
  void toggle_recording();
  void save_recording();
  void toggle_flight();
  Result<void> write_picture(const std::filesystem::path& path);
  void save_picture();
  void say(std::string text);

  bool move_camera(double seconds);
  Result<void> frame();
  Result<void> show();
  std::vector<TextBlock> texts() const;
  bool at_rest() const;
  Result<void> follow_script();
  std::filesystem::path free_name(const char* what, const char* extension) const;

  const ViewSettings& s_;
  std::filesystem::path first_file_;
  std::unique_ptr<Window> window_;  // outlives what draws
  view::CameraControls controls_;
  std::unique_ptr<ViewSubject> subject_;
  view::FlightRecorder recorder_;
  view::FlightPlayer flight_;
  view::ViewScript script_;

  bool placed_ = false;  // the camera shows the model
  bool open_ = true, redraw_ = true, settled_ = false;
  bool help_ = false, statistics_ = true;
  std::string message_;
  double message_end_s_ = 0;
  double last_frame_s_ = 0;
  ViewTimes times_;
  bool was_at_rest_ = true;
};

}  // namespace cuesta::app
