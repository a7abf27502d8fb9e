#pragma once
/// WebSocket sessions: threads of their own that take connections over from the server. Sessions of one file
/// share its decoded pages.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "apps/serve/dataset.h"
#include "apps/serve/metrics.h"
#include "apps/serve/session.h"

namespace cuesta::serve {

struct SessionServerSettings {
  std::uint32_t threads = 2;
  std::uint32_t sessions = 256;             ///< beyond: refused, out_of_budget
  std::uint64_t memory_bytes = 8ull << 30;  ///< of all sessions and shelves; beyond: refused, out_of_budget
  std::uint64_t shelf_bytes =
      256ull << 20;                   ///< of decoded pages, for each file with sessions; at most a quarter
  std::uint32_t silence_ms = 60'000;  ///< without anything from the client: pinged, then closed
  std::uint32_t handshake_ms = 10'000;
  SessionLimits limits;
};

/// Threads: any.
class SessionServer {
 public:
  static std::unique_ptr<SessionServer> start(const SessionServerSettings& settings);
  /// Closes all sessions.
  virtual ~SessionServer() = default;

  /// @param connection  a connected TCP socket.   @param bytes  that were read from it: a WebSocket
  /// handshake.
  virtual void take(std::shared_ptr<const Dataset> set, Descriptor connection, std::string bytes) = 0;
  virtual std::vector<Gauge> gauges() const = 0;
};

}  // namespace cuesta::serve
