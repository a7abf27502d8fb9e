#include "apps/cuesta/stop_signal.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace cuesta::app {
namespace {

std::atomic<bool> requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

void on_stop(int) {
  if (requested.exchange(true)) _exit(exit_status(ErrorCode::cancelled));
}

}  // namespace

void catch_stop_signals() {
  struct sigaction action {};
  action.sa_handler = on_stop;
  action.sa_flags = SA_RESTART;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

bool stop_requested() {
  return requested.load(std::memory_order_relaxed);
}

Result<void> check_stop() {
  if (stop_requested())
    return fail(ErrorCode::cancelled, "", "", "stopped by a signal; no unfinished file was left");
  return {};
}

}  // namespace cuesta::app
