#pragma once
/// The messages of a session, byte by byte in docs/session-protocol.md. All little-endian.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "ooc/grid.h"
#include "ooc/result.h"
#include "runtime/view.h"

namespace cuesta::serve {

inline constexpr std::uint8_t session_version = 1;
inline constexpr std::size_t largest_client_message = 128;        ///< bytes
inline constexpr std::uint64_t largest_change_bytes = 64u << 20;  ///< of a change when it is unpacked

enum class ClientMessage : std::uint8_t { hello = 1, view = 2, ack = 3 };
enum class ServerMessage : std::uint8_t { welcome = 1, change = 2, refusal = 3 };

/// The first message of a client; any later one changes its budgets.
struct Hello {
  std::uint8_t version = session_version;
  std::uint32_t triangles = 200'000;   ///< drawn at once, at most; > 0
  std::uint32_t bytes_per_second = 0;  ///< 0: what the link takes
  float tau_px = 1;                    ///< > 0
};
/// A change has been applied.
struct Ack {
  std::uint32_t sequence = 0;
};
using FromClient = std::variant<Hello, View, Ack>;

std::string encode(const Hello& hello);
std::string encode(const View& view);
std::string encode(const Ack& ack);
/// @error corrupt: not of the length that its kind has, or of no kind; invalid_input: numbers that are no
/// camera or no
///        budget; unsupported_version.
Result<FromClient> decode_client_message(std::span<const std::byte> bytes);

/// The first message of the server.
struct Welcome {
  bool has_normals = false, has_colours = false;
  Grid grid;
  Vec3i lo, hi;                 ///< box of all vertices, grid units
  std::uint64_t triangles = 0;  ///< of the full-resolution surface
};
std::string encode(const Welcome& welcome);
/// @error corrupt, unsupported_version.
Result<Welcome> decode_welcome(std::span<const std::byte> bytes);

/// Why there is no session (any more); the last message of the server.
std::string encode_refusal(const Error& error);
Result<std::string> decode_refusal(std::span<const std::byte> bytes);

/// What a change begins with.
struct ChangeHead {
  bool settled = false;         ///< nothing more will change until the camera or the budgets do
  std::uint32_t sequence = 0;   ///< 1, 2, 3, …
  std::uint32_t triangles = 0;  ///< that are drawn afterwards
  float achieved_px = 0;        ///< bound of the error on the screen; infinite while it is not known
  std::uint32_t raw_bytes = 0;  ///< of the body when it is unpacked (Zstandard)
};
inline constexpr std::size_t change_head_bytes = 20;
std::string encode(const ChangeHead& head);
/// @error corrupt.
Result<ChangeHead> decode_change_head(std::span<const std::byte> bytes);

std::span<const std::byte> bytes_of(std::string_view text);

}  // namespace cuesta::serve
