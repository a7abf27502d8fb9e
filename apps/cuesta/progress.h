#pragma once
/// How far long work is: on a terminal one line that is updated in place, otherwise plain lines, few of them.

#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace cuesta::app {

enum class Unit : std::uint8_t { none, bytes, postings, triangles, pages, frames };

/// Writes to a stream (stderr). Stages follow each other; a stage's total may be 0 if unknown.
/// On a terminal: stage, bar, rate, time left and memory, ten times a second at most. Elsewhere: a line at
/// each stage's start and end, and every 5 s between. Threads: one at a time.
class Progress {
 public:
  explicit Progress(bool quiet, std::FILE* stream = stderr);
  ~Progress() { close(false); }  ///< a stage that is still open was not finished
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @return false if the user asked to stop: the work should end with ErrorCode::cancelled.
  bool update(std::string_view stage, Unit unit, std::uint64_t done, std::uint64_t total);
  /// The current stage is done: ends its line.
  void finish() { close(true); }

 private:
  void close(bool done);
  void begin(std::string_view stage, Unit unit, double now_ms);
  std::string line(double now_ms) const;
  void print(double now_ms, bool last);

  std::FILE* stream_;
  bool quiet_, terminal_;
  bool open_ = false;
  std::string stage_;
  Unit unit_ = Unit::none;
  std::uint64_t done_ = 0, total_ = 0;
  double start_ms_ = 0, printed_ms_ = 0;
};

}  // namespace cuesta::app
