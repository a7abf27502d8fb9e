#include "ooc/read_job.h"

#include <fmt/format.h>

#include <algorithm>

namespace cuesta {

Result<void> ReadBudget::charge(std::uint64_t count, std::uint64_t element_bytes, const char* what) {
  const std::uint64_t free = left();
  if (element_bytes != 0 && count > free / element_bytes) {
    const std::string each = element_bytes == 1 ? "" : fmt::format(" of {} bytes each", element_bytes);
    return fail(
        ErrorCode::out_of_budget, "", "",
        fmt::format("{} {}{} do not fit in the {} bytes left; allow more memory", count, what, each, free));
  }
  used_ += count * element_bytes;
  return {};
}

tl::unexpected<Error> ReadJob::corrupt_at(std::uint64_t byte, std::string message) const {
  return error(ErrorCode::corrupt, fmt::format("byte {}", byte), std::move(message));
}

tl::unexpected<Error> ReadJob::corrupt_line(const char* position, std::string message) const {
  std::uint64_t line = 1;
  for (const char* at = bytes.data(); at != position;) {
    const char* next = at + std::min<std::ptrdiff_t>(position - at, MapWindow::step_bytes);
    line += static_cast<std::uint64_t>(std::count(at, next, '\n'));
    passed(at = next);
  }
  return error(ErrorCode::corrupt, fmt::format("line {}", line), std::move(message));
}

Result<void> ReadJob::report_progress(std::uint64_t bytes_done) const {
  if (progress && !progress(std::min<std::uint64_t>(bytes_done, bytes.size()), bytes.size())) {
    return error(ErrorCode::cancelled, "", "reading was cancelled");
  }
  return file ? file->check_unchanged() : Result<void>{};
}

std::string quote_word(std::string_view word) {
  std::string text(word.substr(0, 40));
  for (char& c : text) {
    if (c < ' ' || c > '~') c = '?';
  }
  return '"' + text + '"';
}

}  // namespace cuesta
