/// cuesta-read-rate FILE [--adaptivity A] [--block N]: time and memory of reading a mesh or volume, kept
/// nowhere.

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <fstream>
#include <string>
#include <string_view>

#include "ooc/mesh_reader.h"

namespace {

class CountingSink : public cuesta::MeshSink {
 public:
  cuesta::Result<void> vertices(const cuesta::VertexBlock&) override { return {}; }
  cuesta::Result<void> triangles(cuesta::TriangleBlock) override {
    note_memory();
    return {};
  }
  /// Without pages of files: those the kernel takes back whenever it needs them.
  std::uint64_t peak_anonymous_kib() const { return peak_; }

 private:
  void note_memory() {
    std::ifstream status("/proc/self/status");
    for (std::string line; std::getline(status, line);)
      if (line.starts_with("RssAnon:")) peak_ = std::max<std::uint64_t>(peak_, std::stoull(line.substr(8)));
  }
  std::uint64_t peak_ = 0;
};

std::string resident_peak() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::to_string(std::stoull(line.substr(6)) / 1024);
  return "?";
}

template <class T>
bool number(std::string_view text, T& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

}  // namespace

int main(int argc, char** argv) {
  cuesta::VolumeOptions volume;
  bool understood = argc >= 2 && argc % 2 == 0;
  for (int i = 2; understood && i + 1 < argc; i += 2) {
    const std::string_view word = argv[i];
    understood = (word == "--adaptivity" && number(argv[i + 1], volume.adaptivity)) ||
                 (word == "--block" && number(argv[i + 1], volume.block_voxels));
  }
  if (!understood) {
    fmt::print(stderr, "usage: cuesta-read-rate FILE [--adaptivity A] [--block N]\n");
    return 1;
  }
  CountingSink sink;
  const auto start = std::chrono::steady_clock::now();
  const auto report = cuesta::read_mesh(argv[1], sink, std::uint64_t{64} << 30, {}, {}, volume);
  if (!report) {
    fmt::print(stderr, "cuesta-read-rate: {}\n", report.error().text());
    return cuesta::exit_status(report.error().code);
  }
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  fmt::print(
      "{} triangles, {} vertices, {:.1f} s, {:.0f} triangles/s, peak {} MiB resident, {} MiB anonymous\n",
      report->triangles, report->vertices, seconds, static_cast<double>(report->triangles) / seconds,
      resident_peak(), sink.peak_anonymous_kib() / 1024);
  return 0;
}
