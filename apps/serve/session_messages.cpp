#include "apps/serve/session_messages.h"

#include <array>
#include <cmath>

#include "ooc/byte_stream.h"

namespace cuesta::serve {
namespace {

constexpr std::size_t hello_bytes = 16, view_bytes = 84, ack_bytes = 8, welcome_bytes = 72;
constexpr int largest_picture_px = 16384;
constexpr std::uint8_t normals_flag = 1, colours_flag = 2;

struct TextWriter {
  std::string text;
  template <class T>
  void put(const T& value) {
    text.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
};

template <class Kind>
TextWriter begin(Kind kind, std::uint8_t second = 0) {
  TextWriter w;
  w.put(static_cast<std::uint8_t>(kind));
  w.put(second);
  w.put(std::uint16_t{0});
  return w;
}

void put(TextWriter& w, Vec3d v) {
  w.put(v.x), w.put(v.y), w.put(v.z);
}
Vec3d get_vector(ByteReader& r) {
  const auto x = r.get<double>(), y = r.get<double>(), z = r.get<double>();
  return {x, y, z};
}
bool is_finite(Vec3d v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A direction whose square is a number that is neither 0 nor infinite.
bool is_direction(Vec3d v) {
  const double square = dot(v, v);
  return std::isfinite(square) && square > 1e-300;
}

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "session", "", std::move(what));
}

Result<FromClient> decode_hello(ByteReader& r, std::uint8_t version) {
  if (version != session_version)
    return fail(ErrorCode::unsupported_version, "session", "",
                "version " + std::to_string(version) + ", this server speaks version " +
                    std::to_string(session_version));
  Hello hello;
  hello.triangles = r.get<std::uint32_t>();
  hello.bytes_per_second = r.get<std::uint32_t>();
  hello.tau_px = r.get<float>();
  if (hello.triangles == 0 || !(hello.tau_px > 0) || !std::isfinite(hello.tau_px))
    return fail(ErrorCode::invalid_input, "session", "", "budgets and tau must be above 0");
  return hello;
}

Result<FromClient> decode_view(ByteReader& r) {
  View view;
  view.eye = get_vector(r);
  view.target = get_vector(r);
  view.up = get_vector(r);
  view.fov_y_rad = static_cast<double>(r.get<float>());
  view.width_px = r.get<std::uint16_t>();
  view.height_px = r.get<std::uint16_t>();
  const Vec3d sight = view.target - view.eye;
  const bool is_camera =
      is_finite(view.eye) && is_finite(view.target) && is_direction(sight) && is_direction(view.up) &&
      is_direction(cross(normalized(sight), normalized(view.up))) && view.fov_y_rad > 1e-6 &&
      view.fov_y_rad < 3.14 && view.width_px > 0 && view.height_px > 0 &&
      view.width_px <= largest_picture_px && view.height_px <= largest_picture_px;
  if (!is_camera)
    return fail(ErrorCode::invalid_input, "session", "", "the numbers are not those of a camera");
  return view;
}

}  // namespace

std::span<const std::byte> bytes_of(std::string_view text) {
  return std::as_bytes(std::span(text.data(), text.size()));
}

std::string encode(const Hello& hello) {
  TextWriter w = begin(ClientMessage::hello, hello.version);
  w.put(hello.triangles);
  w.put(hello.bytes_per_second);
  w.put(hello.tau_px);
  return w.text;
}

std::string encode(const View& view) {
  TextWriter w = begin(ClientMessage::view);
  put(w, view.eye);
  put(w, view.target);
  put(w, view.up);
  w.put(static_cast<float>(view.fov_y_rad));
  w.put(static_cast<std::uint16_t>(view.width_px));
  w.put(static_cast<std::uint16_t>(view.height_px));
  return w.text;
}

std::string encode(const Ack& ack) {
  TextWriter w = begin(ClientMessage::ack);
  w.put(ack.sequence);
  return w.text;
}

Result<FromClient> decode_client_message(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  const auto kind = static_cast<ClientMessage>(r.get<std::uint8_t>());
  const auto second = r.get<std::uint8_t>();
  r.get<std::uint16_t>();
  switch (kind) {
    case ClientMessage::hello:
      return bytes.size() == hello_bytes ? decode_hello(r, second) : corrupt("a hello has 16 bytes");
    case ClientMessage::view:
      return bytes.size() == view_bytes ? decode_view(r) : corrupt("a view has 84 bytes");
    case ClientMessage::ack:
      if (bytes.size() != ack_bytes) return corrupt("an acknowledgement has 8 bytes");
      return Ack{r.get<std::uint32_t>()};
  }
  return corrupt("there is no message of this kind");
}

std::string encode(const Welcome& welcome) {
  TextWriter w;
  w.put(static_cast<std::uint8_t>(ServerMessage::welcome));
  w.put(session_version);
  w.put(static_cast<std::uint8_t>((welcome.has_normals ? normals_flag : 0) |
                                  (welcome.has_colours ? colours_flag : 0)));
  w.put(std::array<std::uint8_t, 5>{});
  put(w, welcome.grid.origin);
  w.put(welcome.grid.step);
  for (const Vec3i& v : {welcome.lo, welcome.hi}) w.put(v.x), w.put(v.y), w.put(v.z);
  w.put(welcome.triangles);
  return w.text;
}

Result<Welcome> decode_welcome(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  const auto kind = r.get<std::uint8_t>(), version = r.get<std::uint8_t>(), flags = r.get<std::uint8_t>();
  if (kind != static_cast<std::uint8_t>(ServerMessage::welcome)) return corrupt("not a welcome");
  if (version != session_version)
    return fail(ErrorCode::unsupported_version, "session", "",
                "the server speaks version " + std::to_string(version));
  if (bytes.size() != welcome_bytes) return corrupt("a welcome has 72 bytes");
  r.get_bytes(5);
  Welcome welcome;
  welcome.has_normals = flags & normals_flag;
  welcome.has_colours = flags & colours_flag;
  welcome.grid.origin = get_vector(r);
  welcome.grid.step = r.get<double>();
  for (Vec3i* v : {&welcome.lo, &welcome.hi})
    for (auto* c : {&v->x, &v->y, &v->z}) *c = r.get<std::int32_t>();
  welcome.triangles = r.get<std::uint64_t>();
  if (!is_finite(welcome.grid.origin) || !(welcome.grid.step > 0) || !std::isfinite(welcome.grid.step))
    return corrupt("the grid is none");
  return welcome;
}

std::string encode(const ChangeHead& head) {
  TextWriter w = begin(ServerMessage::change, head.settled);
  w.put(head.sequence);
  w.put(head.triangles);
  w.put(head.achieved_px);
  w.put(head.raw_bytes);
  return w.text;
}

Result<ChangeHead> decode_change_head(std::span<const std::byte> bytes) {
  ByteReader r(bytes);
  const auto kind = r.get<std::uint8_t>(), flags = r.get<std::uint8_t>();
  r.get<std::uint16_t>();
  ChangeHead head;
  head.settled = flags & 1;
  head.sequence = r.get<std::uint32_t>();
  head.triangles = r.get<std::uint32_t>();
  head.achieved_px = r.get<float>();
  head.raw_bytes = r.get<std::uint32_t>();
  if (!r.ok() || static_cast<ServerMessage>(kind) != ServerMessage::change) return corrupt("not a change");
  return head;
}

std::string encode_refusal(const Error& error) {
  TextWriter w = begin(ServerMessage::refusal, static_cast<std::uint8_t>(error.code));
  w.text += error.text();
  return w.text;
}

Result<std::string> decode_refusal(std::span<const std::byte> bytes) {
  if (bytes.size() < 4 || static_cast<ServerMessage>(bytes[0]) != ServerMessage::refusal)
    return corrupt("not a refusal");
  return std::string(reinterpret_cast<const char*>(bytes.data()) + 4, bytes.size() - 4);
}

}  // namespace cuesta::serve
