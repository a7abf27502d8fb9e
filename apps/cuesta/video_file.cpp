#include "apps/cuesta/video_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

extern char** environ;

namespace cuesta::app {
namespace {

std::vector<std::string> ffmpeg_words(const std::filesystem::path& part, bool webm, int width_px,
                                      int height_px, double fps) {
  std::vector<std::string> words{"ffmpeg", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo",
                                 "-pixel_format", "rgba", "-video_size",
                                 fmt::format("{}x{}", width_px, height_px), "-framerate",
                                 fmt::format("{:g}", fps), "-i", "pipe:0",
                                 // Both encoders want even sides: a last column or row is repeated.
                                 "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2,format=yuv420p"};
  const auto add = [&](std::initializer_list<const char*> more) {
    words.insert(words.end(), more.begin(), more.end());
  };
  if (webm)
    add({"-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1", "-f", "webm"});
  else
    add({"-c:v", "libx264", "-crf", "17", "-preset", "medium", "-movflags", "+faststart", "-f", "mp4"});
  words.push_back(part.string());
  return words;
}

}  // namespace

Result<VideoFile> VideoFile::create(const std::filesystem::path& path, int width_px, int height_px,
                                    double fps) {
  const std::string ending = path.extension().string();
  if (ending != ".mp4" && ending != ".webm")
    return fail(ErrorCode::invalid_input, path.string(), "", "a video's name ends in .mp4 or .webm");
  std::filesystem::path part = path;
  part += ".part";
  std::signal(SIGPIPE, SIG_IGN);  // an ffmpeg that ends is an error of write(), with a message
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return fail(ErrorCode::io, path.string(), "", std::strerror(errno));
  std::vector<std::string> words = ffmpeg_words(part, ending == ".webm", width_px, height_px, fps);
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], 0);
  pid_t process = -1;
  const int error = posix_spawnp(&process, "ffmpeg", &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  ::close(ends[0]);
  VideoFile video(path, part, error == 0 ? process : -1, ends[1]);
  if (error == ENOENT)
    return fail(ErrorCode::not_found, path.string(), "",
                "a video needs ffmpeg, which is not installed (Debian: ffmpeg); without --video, frames are "
                "PNG files");
  if (error != 0)
    return fail(ErrorCode::io, path.string(), "",
                std::string("ffmpeg cannot be started: ") + std::strerror(error));
  return video;
}

VideoFile::VideoFile(VideoFile&& other) noexcept
    : path_(std::move(other.path_)),
      part_(std::move(other.part_)),
      process_(std::exchange(other.process_, -1)),
      pipe_(std::exchange(other.pipe_, -1)) {}

VideoFile::~VideoFile() {
  if (process_ >= 0) ::kill(process_, SIGTERM);  // not finished
  const bool unfinished = process_ >= 0;
  end();
  std::error_code ignored;
  if (unfinished) std::filesystem::remove(part_, ignored);
}

/// Closes the pipe and waits. @return ffmpeg's exit status; 0 if it was waited for before.
int VideoFile::end() {
  if (pipe_ >= 0) ::close(std::exchange(pipe_, -1));
  int status = 0;
  if (process_ >= 0) ::waitpid(std::exchange(process_, -1), &status, 0);
  return status;
}

Result<void> VideoFile::add(const Picture& picture) {
  const char* bytes = reinterpret_cast<const char*>(picture.pixels.data());
  std::size_t left = picture.pixels.size() * sizeof(Rgba8);
  while (left > 0) {
    const ssize_t written = ::write(pipe_, bytes, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0)
      return fail(ErrorCode::io, path_.string(), "", "ffmpeg takes no more frames; see its message above");
    bytes += written;
    left -= static_cast<std::size_t>(written);
  }
  return {};
}

Result<void> VideoFile::finish() {
  const int status = end();
  std::error_code error;
  if (status == 0) std::filesystem::rename(part_, path_, error);
  if (status == 0 && !error) return {};
  std::error_code ignored;
  std::filesystem::remove(part_, ignored);
  if (error) return fail(ErrorCode::io, path_.string(), "", error.message());
  return fail(ErrorCode::io, path_.string(), "", "ffmpeg could not make the video; see its message above");
}

}  // namespace cuesta::app
