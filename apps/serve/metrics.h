#pragma once
/// What the server counts, as Prometheus reads it.

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace cuesta::serve {

/// Counters of one thread, which alone adds to them; any thread reads them.
struct alignas(64) Counters {
  using Count = std::atomic<std::uint64_t>;

  std::array<Count, 6> responses{};  ///< by the first digit of their status
  Count sent_bytes{0};
  Count accepted{0}, open{0};      ///< connections
  Count refused_connections{0};    ///< for there were too many
  Count displaced_connections{0};  ///< closed while they waited for a request, for another one's sake
  Count timed_out{0};              ///< closed: the client was too slow
  Count clients_gone{0};           ///< before the end of a response
  Count files_failed{0};           ///< responses that a disk cut short
  /// Responses by seconds from the whole head to the last byte in the system's hands: up to each of
  /// duration_bounds_s, and more.
  static constexpr std::array<double, 7> duration_bounds_s{0.0001, 0.001, 0.01, 0.1, 1, 10, 100};
  std::array<Count, 8> durations{};
  Count duration_us{0};  ///< their sum

  static void add(Count& count, std::uint64_t n = 1) {
    count.store(count.load(std::memory_order_relaxed) + n, std::memory_order_relaxed);
  }
  void add_duration(double seconds);
};

/// A number that is read when it is asked for.
struct Gauge {
  std::string_view name, help;
  double value = 0;
  bool counts_up = false;
};

/// The sum over threads, and gauges, in Prometheus' text format 0.0.4.
std::string metrics_text(const std::vector<const Counters*>& threads, const std::vector<Gauge>& gauges);

}  // namespace cuesta::serve
