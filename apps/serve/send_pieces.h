#pragma once
/// The pieces of a response into a socket that does not block: text by send(2), files by sendfile(2), which
/// copies them nowhere in this process.

#include <cstdint>

#include "apps/serve/response.h"

namespace cuesta::serve {

/// How far a response is.
struct SendProgress {
  std::size_t piece = 0;
  std::uint64_t done = 0;   ///< of that piece
  std::uint64_t total = 0;  ///< bytes that the system has taken
};

enum class Sending : std::uint8_t {
  done,
  socket_full,  ///< goes on when the socket is writable
  turn_over,    ///< goes on when others had theirs
  client_gone,
  file_failed,  ///< the disk refused, or the file ends before the range does: what was promised cannot be
                ///< sent
};

/// @param turn_bytes  of files, that are sent in one call at most.
/// @pre   SIGPIPE is blocked or ignored.
Sending send_pieces(int socket, const Response& response, SendProgress& progress, std::uint64_t turn_bytes);

/// For tests: called before each sendfile(); a result other than 0 is the errno that it fails with. Called
/// from many threads. Null removes it.
using SendFault = int (*)(const ServedFile& file, std::uint64_t offset, std::uint64_t bytes);
void set_send_fault(SendFault fault);

}  // namespace cuesta::serve
