#pragma once
/// One thin client's session: its camera and budgets in, changes of its mesh out. Knows no socket and no
/// thread.

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "apps/serve/link_rate.h"
#include "apps/serve/session_messages.h"
#include "apps/serve/session_mirror.h"
#include "runtime/cut.h"

namespace cuesta::serve {

struct SessionLimits {
  std::uint32_t triangles = 1'000'000;
  std::uint64_t cache_bytes = 64ull << 20;  ///< of resident pages
  std::uint32_t bytes_per_second = 8u << 20;
  double step_ms = 66;  ///< between two changes, at least
  std::uint32_t pages_per_step = 2;
  double adapt_ms = 20;
};

class Session {
 public:
  /// @param clock  milliseconds since any moment.
  /// @error as Cut::open.
  static Result<std::unique_ptr<Session>> open(CuestaFile file, const SessionLimits& limits, Clock clock);

  /// What a session of a file takes at most: pages, what its client has of them, and a directory of its own.
  static std::uint64_t most_bytes(const Directory& directory, const SessionLimits& limits);
  /// What it takes of that now.
  std::uint64_t bytes() const {
    return directory_bytes(cut_->directory()) + cut_->cache().resident_bytes() + mirror_.bytes();
  }

  const std::string& welcome() const { return welcome_; }

  /// A message of the client.
  /// @error as decode_client_message(); invalid_input: the first one is no hello. Then the session is over.
  Result<void> receive(std::span<const std::byte> message);

  /// Adapts and says what changed, if it is time to, the link has room, and there is a camera. To be sent at
  /// once.
  std::optional<std::string> step();
  /// Milliseconds until step() is worth a call: 0 now; infinite: not before something is received.
  double wait_ms() const;

  std::uint64_t sent_bytes() const { return sent_bytes_; }
  const LinkRate& link() const { return link_; }
  const Cut& cut() const { return *cut_; }

 private:
  Session(std::unique_ptr<Cut> cut, const SessionLimits& limits, Clock clock);
  static std::uint64_t directory_bytes(const Directory& directory);
  void set_budgets(const Hello& hello);
  double target_bytes() const;
  void choose_upload_budget();
  void fill_allowance(double now_ms);
  double allowance_at(double now_ms) const;

  std::unique_ptr<Cut> cut_;
  SessionLimits limits_;
  Clock clock_;
  std::string welcome_;
  SessionMirror mirror_;
  LinkRate link_;
  std::optional<Hello> hello_;
  std::optional<View> view_;
  Budgets budgets_;
  bool settled_ = false;
  std::uint32_t sequence_ = 0;
  std::uint64_t sent_bytes_ = 0;
  double bytes_per_second_ = 0;
  double last_step_ms_ = 0, allowance_ = 0,
         allowance_ms_ = 0;       // bytes that may be sent, and when that was so
  double sent_per_upload_ = 0.1;  // bytes of messages per byte that the upload budget counts
};

}  // namespace cuesta::serve
