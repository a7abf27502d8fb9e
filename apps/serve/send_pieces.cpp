#include "apps/serve/send_pieces.h"

#include <sys/sendfile.h>
#include <sys/socket.h>

#include <algorithm>
#include <atomic>
#include <cerrno>

namespace cuesta::serve {
namespace {

std::atomic<SendFault> send_fault{nullptr};

ssize_t send_file(int socket, const ServedFile& file, std::uint64_t offset, std::uint64_t bytes) {
  if (const SendFault fault = send_fault.load(std::memory_order_relaxed))
    if (const int number = fault(file, offset, bytes); number != 0) return errno = number, -1;
  auto at = static_cast<off_t>(offset);
  return ::sendfile(socket, file.descriptor.get(), &at, bytes);
}

ssize_t send_text(int socket, std::string_view text, bool more) {
  return ::send(socket, text.data(), text.size(), MSG_NOSIGNAL | MSG_DONTWAIT | (more ? MSG_MORE : 0));
}

Sending outcome_of_errno(int number, bool of_file) {
  if (number == EAGAIN || number == EWOULDBLOCK) return Sending::socket_full;
  const bool from_disk =
      number == EIO || number == EINVAL || number == EBADF || number == ESTALE || number == ENOMEM;
  return of_file && from_disk ? Sending::file_failed : Sending::client_gone;
}

}  // namespace

Sending send_pieces(int socket, const Response& response, SendProgress& progress, std::uint64_t turn_bytes) {
  while (progress.piece < response.pieces.size()) {
    const Piece& piece = response.pieces[progress.piece];
    const std::uint64_t first = piece.first + progress.done, left = piece.count - progress.done;
    const std::uint64_t now = piece.of_file ? std::min(left, turn_bytes) : left;
    if (now == 0 && left > 0) return Sending::turn_over;
    const bool last = progress.piece + 1 == response.pieces.size();
    const ssize_t sent = piece.of_file
                             ? send_file(socket, *response.file, first, now)
                             : send_text(socket, std::string_view(response.text).substr(first, now), !last);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return outcome_of_errno(errno, piece.of_file);
    if (sent == 0 && left > 0) return piece.of_file ? Sending::file_failed : Sending::client_gone;
    const auto bytes = static_cast<std::uint64_t>(sent);
    if (piece.of_file) turn_bytes -= bytes;
    progress.total += bytes;
    progress.done += bytes;
    if (progress.done == piece.count) ++progress.piece, progress.done = 0;
  }
  return Sending::done;
}

void set_send_fault(SendFault fault) {
  send_fault.store(fault);
}

}  // namespace cuesta::serve
