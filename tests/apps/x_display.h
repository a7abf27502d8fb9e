#pragma once
/// A screen in memory (Xvfb) for programs that open windows.

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>

extern char** environ;

namespace cuesta::test {

/// An Xvfb of its own, which DISPLAY names as long as this lives. Not running where Xvfb is not installed.
class XDisplay {
 public:
  XDisplay() {
    int ends[2];
    if (::pipe(ends) != 0) return;
    const std::string number_goes_to = std::to_string(ends[1]);
    std::string words[] = {"Xvfb", "-displayfd",  number_goes_to, "-screen",
                           "0",    "1024x768x24", "-nolisten",    "tcp"};
    char* pointers[9] = {};
    for (int i = 0; i < 8; ++i) pointers[i] = words[i].data();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addclose(&actions, ends[0]);
    // A test that is aborted leaves it behind: it must not keep a pipe open that somebody reads to its end.
    for (const int stream : {1, 2})
      posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    if (posix_spawnp(&id_, "Xvfb", &actions, nullptr, pointers, environ) != 0) id_ = -1;
    posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    std::string number;
    char c = 0;
    while (id_ > 0 && ::read(ends[0], &c, 1) == 1 && c != '\n') number += c;
    ::close(ends[0]);
    running_ = !number.empty();
    if (running_) ::setenv("DISPLAY", (":" + number).c_str(), 1);
  }
  ~XDisplay() {
    ::unsetenv("DISPLAY");
    if (id_ <= 0) return;
    ::kill(id_, SIGTERM);
    ::waitpid(id_, nullptr, 0);
  }
  XDisplay(const XDisplay&) = delete;
  XDisplay& operator=(const XDisplay&) = delete;
  bool running() const { return running_; }

 private:
  pid_t id_ = -1;
  bool running_ = false;
};

}  // namespace cuesta::test
