#pragma once
/// A thin client over a real connection: frames of WebSocket by hand, so that wrong ones can be sent, too.

#include <optional>

#include "apps/serve/session_mesh.h"
#include "tests/apps/serve/raw_client.h"

namespace cuesta::test {

class ThinClient {
 public:
  ThinClient(std::uint16_t port, const std::string& name) : raw(port) {
    raw.get("/session/" + name,
            "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
            "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n");
    const Reply reply = raw.reply();
    upgraded = reply.status == 101 && reply.header("Sec-WebSocket-Accept") == "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=";
  }

  /// @param opcode  2: binary.   @param mask  of four bytes.
  static std::string frame(std::string_view payload, unsigned opcode = 2,
                           std::string_view mask = "\x11\x22\x33\x44") {
    std::string bytes;
    bytes += static_cast<char>(0x80 | opcode);
    if (payload.size() < 126) {
      bytes += static_cast<char>(0x80 | payload.size());
    } else {
      bytes += static_cast<char>(0x80 | 126);
      bytes += static_cast<char>(payload.size() >> 8);
      bytes += static_cast<char>(payload.size());
    }
    bytes += mask;
    for (std::size_t i = 0; i < payload.size(); ++i) bytes += static_cast<char>(payload[i] ^ mask[i % 4]);
    return bytes;
  }
  bool send(std::string_view message) { return raw.send(frame(message)); }

  /// The next binary message; nothing at the end of the connection, or of the time.
  std::optional<std::string> receive(int wait_ms = 5000) {
    std::string message;
    while (true) {
      const auto head = raw.take(2, wait_ms);
      if (!head) return std::nullopt;
      std::uint64_t length = static_cast<unsigned char>((*head)[1]);
      const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
      if (more > 0) {
        const auto bytes = raw.take(more, wait_ms);
        if (!bytes) return std::nullopt;
        length = 0;
        for (const char c : *bytes) length = length << 8 | static_cast<unsigned char>(c);
      }
      const auto payload = raw.take(length, wait_ms);
      const unsigned opcode = static_cast<unsigned char>((*head)[0]) & 15;
      if (!payload || opcode == 8) return std::nullopt;
      if (opcode > 2) continue;  // a ping
      message += *payload;
      if (static_cast<unsigned char>((*head)[0]) & 0x80) return message;
    }
  }

  /// Says hello, and takes the welcome.
  bool begin(const serve::Hello& hello) {
    if (!upgraded || !send(serve::encode(hello))) return false;
    const auto message = receive();
    const auto welcome = message ? serve::decode_welcome(serve::bytes_of(*message)) : fail(Error{});
    if (welcome) mesh.emplace(welcome->has_normals, welcome->has_colours);
    return welcome.has_value();
  }
  /// Applies one change and acknowledges it.
  std::optional<serve::ChangeHead> change(int wait_ms = 5000) {
    const auto message = receive(wait_ms);
    if (!message) return std::nullopt;
    const auto head = mesh->apply(serve::bytes_of(*message));
    if (!head) return std::nullopt;
    send(serve::encode(serve::Ack{head->sequence}));
    return *head;
  }
  bool settle() {
    while (const auto head = change())
      if (head->settled) return true;
    return false;
  }

  RawClient raw;
  bool upgraded = false;
  std::optional<serve::SessionMesh> mesh;
};

}  // namespace cuesta::test
