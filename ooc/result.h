#pragma once
/// The world's faults as values: `Result<T>` is either a T or an Error that says what, where and what to do.
/// The caller's bugs are CUESTA_CHECK (check.h). Nothing of ours throws; adaptors catch what libraries throw.

#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>
#include <utility>

namespace cuesta {

enum class ErrorCode : std::uint8_t {
  not_found,            ///< a file or name that is not there
  corrupt,              ///< bytes that contradict themselves or their checksum
  unsupported_version,  ///< a format, or a version or feature of one, that this program does not read
  invalid_input,        ///< well-formed, but nothing can be made of it; also a wrong option
  io,                   ///< the operating system refused a read or a write
  out_of_budget,        ///< would need more memory, disk or triangles than it was given
  cancelled,            ///< the user stopped it
};

/// Name as users see it, for example "corrupt".
std::string_view name(ErrorCode code);

/// Process exit status of a command that ends with this code: 2 to 8, distinct. 1 is kept for wrong usage.
int exit_status(ErrorCode code);

struct Error {
  ErrorCode code = ErrorCode::io;
  std::string file;     ///< path as the user gave it; may be empty
  std::string place;    ///< "line 12", "byte 4096", "page 7"; may be empty
  std::string message;  ///< what was expected, what was found, what to do next

  /// "bunny.ply: byte 312: expected 104,000 bytes of vertices, found 2,048 (corrupt)"
  std::string text() const;
};

template <class T>
class [[nodiscard]] Result : public tl::expected<T, Error> {
 public:
  using tl::expected<T, Error>::expected;
};

/// `return fail(ErrorCode::corrupt, path, "byte 12", "…");` in a function that returns any Result.
inline tl::unexpected<Error> fail(ErrorCode code, std::string file, std::string place, std::string message) {
  return tl::unexpected<Error>(Error{code, std::move(file), std::move(place), std::move(message)});
}
inline tl::unexpected<Error> fail(Error error) {
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace cuesta
