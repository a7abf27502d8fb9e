#pragma once
/// HTTP/1.1 over TCP for a Site: a few threads, each with its own connections, none of which waits for
/// another.

#include <cstdint>
#include <memory>
#include <string>

#include "apps/serve/site.h"
#include "ooc/result.h"

namespace cuesta::serve {

/// What a client may take. Looked at every `tick_ms`.
struct ClientLimits {
  std::uint32_t connections =
      1024;  ///< beyond, one that waits for a request makes room, else the new one is refused
  std::uint32_t head_bytes = 16 * 1024;  ///< of a request; beyond: 431
  std::uint32_t head_ms = 10'000;        ///< from the first byte of a head to its last; beyond: 408
  std::uint32_t idle_ms = 60'000;        ///< from one response to the next request
  /// Time in which a response must move on by stall_bytes; else the connection is closed.
  std::uint32_t stall_ms = 30'000;
  std::uint32_t stall_bytes = 16 * 1024;
  std::uint32_t later_ms = 120'000;  ///< for what is made when it is asked for; beyond: 503
  std::uint32_t tick_ms = 200;
};

struct ServerSettings {
  std::string bind = "127.0.0.1";  ///< an address, of either family
  std::uint16_t port = 8080;       ///< 0: any that is free
  std::uint32_t threads = 2;
  std::uint32_t grace_ms = 10'000;  ///< for responses under way when it stops
  ClientLimits limits;
};

class Server {
 public:
  /// Listens, and serves from threads of its own.
  /// @param site  outlives the server.
  /// @error invalid_input: `bind` is no address; io: the port is taken, or another reason not to listen.
  static Result<std::unique_ptr<Server>> start(const ServerSettings& settings, const Site& site);
  /// stop()
  virtual ~Server() = default;

  virtual std::uint16_t port() const = 0;
  /// Takes no more connections, closes those that wait for a request, and returns when the responses under
  /// way are done or grace_ms is over.
  virtual void stop() = 0;
};

}  // namespace cuesta::serve
