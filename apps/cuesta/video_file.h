#pragma once
/// Frames into a video, by an ffmpeg that is installed.

#include <sys/types.h>

#include <filesystem>

#include "ooc/result.h"
#include "runtime/draw/picture.h"

namespace cuesta::app {

/// H.264 in .mp4 or VP9 in .webm, near to lossless to the eye. ffmpeg writes to a name with ".part" in it,
/// which finish() renames: a video that was not finished leaves nothing.
class VideoFile {
 public:
  /// Starts ffmpeg.
  /// @error invalid_input for another ending; not_found, saying what to install, without ffmpeg; io.
  static Result<VideoFile> create(const std::filesystem::path& path, int width_px, int height_px, double fps);
  VideoFile(VideoFile&& other) noexcept;
  VideoFile& operator=(VideoFile&&) = delete;
  ~VideoFile();

  /// @pre the picture has the video's size.   @error io if ffmpeg has ended; its own message is on stderr.
  Result<void> add(const Picture& picture);
  /// @error io if ffmpeg fails.
  Result<void> finish();

 private:
  VideoFile(std::filesystem::path path, std::filesystem::path part, pid_t process, int pipe)
      : path_(std::move(path)), part_(std::move(part)), process_(process), pipe_(pipe) {}
  int end();

  std::filesystem::path path_, part_;
  pid_t process_ = -1;
  int pipe_ = -1;
};

}  // namespace cuesta::app
