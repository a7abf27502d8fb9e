#pragma once
/// What benches of frames say of a flight: a row of quantiles.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "runtime/cut.h"

namespace cuesta::bench {

inline double clock_ms() {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Processor time of this thread: what a frame costs on one core, whatever else the machine does.
inline double thread_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) * 1e-6;
}

inline double quantile(std::vector<double> v, double q) {
  std::sort(v.begin(), v.end());
  return v.empty() ? 0 : v[static_cast<std::size_t>(q * static_cast<double>(v.size() - 1) + 0.5)];
}

/// A flight, or a part of one.
struct Part {
  std::string name;
  std::vector<AdaptReport> frames = {};
  std::vector<double> processor_ms = {};  ///< of adapt()
};

inline void print_head(std::FILE* csv) {
  const char* head =
      "flight,frames,median_ms,p99_ms,p999_ms,most_ms,median_operations,median_blocks,most_triangles,"
      "most_resident_mebibytes,most_tau_px,p999_processor_ms";
  fmt::print("{}\n", head);
  if (csv) fmt::print(csv, "{}\n", head);
}

inline void print_part(const Part& part, std::FILE* csv) {
  std::vector<double> ms, operations, blocks;
  std::uint64_t most_triangles = 0, most_bytes = 0;
  double tau = 0;
  for (const AdaptReport& r : part.frames) {
    ms.push_back(r.adapt_ms);
    operations.push_back(r.coarse_operations + r.fine_operations);
    blocks.push_back(r.blocks_tested);
    most_triangles = std::max(most_triangles, r.triangles);
    most_bytes = std::max(most_bytes, r.resident_bytes);
    tau = std::max(tau, r.tau);
  }
  const std::string line =
      fmt::format("{},{},{:.4f},{:.3f},{:.3f},{:.3f},{:.0f},{:.0f},{},{:.1f},{:.3f},{:.3f}", part.name,
                  part.frames.size(), quantile(ms, 0.5), quantile(ms, 0.99), quantile(ms, 0.999),
                  quantile(ms, 1), quantile(operations, 0.5), quantile(blocks, 0.5), most_triangles,
                  static_cast<double>(most_bytes) / (1 << 20), tau, quantile(part.processor_ms, 0.999));
  fmt::print("{}\n", line);
  if (csv) fmt::print(csv, "{}\n", line);
}

}  // namespace cuesta::bench
