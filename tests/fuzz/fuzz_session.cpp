/// Both directions of the session protocol: a message of a client is understood or refused; a change, damaged
/// in any way, leaves a mesh whose corners are vertices. The first byte chooses; the last four of a change's
/// head are made to fit, so that bodies are reached: they are packed here.

#include <zstd.h>

#include <cstdlib>

#include "apps/serve/session_mesh.h"

namespace {

using namespace cuesta::serve;

void check(const SessionMesh& mesh) {
  for (const auto& t : mesh.triangles())
    for (const std::uint32_t v : t)
      if (v != no_vertex && v >= mesh.vertices().size()) std::abort();
}

std::string packed(std::uint32_t triangles, std::string_view body) {
  std::string message = encode(ChangeHead{false, 1, triangles, 0, static_cast<std::uint32_t>(body.size())});
  message.resize(change_head_bytes + ZSTD_compressBound(body.size()));
  const std::size_t bytes = ZSTD_compress(message.data() + change_head_bytes,
                                          message.size() - change_head_bytes, body.data(), body.size(), 1);
  message.resize(change_head_bytes + bytes);
  return message;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 6) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 2, size - 2);
  SessionMesh mesh((data[1] & 1) != 0, (data[1] & 2) != 0);
  if (data[0] % 3 == 0) {
    if (decode_client_message(bytes_of(bytes)) || decode_welcome(bytes_of(bytes))) return 0;
  } else if (data[0] % 3 == 1) {
    (void)mesh.apply(bytes_of(bytes)).has_value();
  } else {
    (void)mesh.apply(bytes_of(packed(data[1] >> 2, bytes))).has_value();
  }
  check(mesh);
  return 0;
}
