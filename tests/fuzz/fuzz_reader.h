#pragma once
/// A libFuzzer target for one reader: FUZZ_READER(read_ply). Memory is small, output bounded: hostile files
/// may repeat a mesh any number of times.

#include <cstdlib>

#include "ooc/read_job.h"

namespace cuesta::fuzz {

class BoundedSink : public MeshSink {
 public:
  Result<void> vertices(const VertexBlock& block) override { return add(block.positions.size()); }
  Result<void> triangles(TriangleBlock block) override {
    for (const auto& t : block) {
      for (const std::uint64_t i : t) highest_ = i > highest_ ? i : highest_;
    }
    has_triangles_ |= !block.empty();
    return add(block.size());
  }
  std::uint64_t highest() const { return highest_; }
  bool has_triangles() const { return has_triangles_; }

 private:
  Result<void> add(std::uint64_t n) {
    if ((count_ += n) <= 1'000'000) return {};
    return fail(ErrorCode::cancelled, "", "", "enough");
  }
  std::uint64_t count_ = 0, highest_ = 0;
  bool has_triangles_ = false;
};

/// @param path  where the bytes lie too, for readers that open the file themselves
inline int run(Result<ReadReport> (*reader)(const ReadJob&), const std::uint8_t* data, std::size_t size,
               const std::filesystem::path& path = "fuzz/file") {
  if (size == 0) return 0;  // refused before a reader is called
  BoundedSink sink;
  ReadBudget budget(std::uint64_t{32} << 20);
  const ReadProgress progress;
  const ReadJob job{path, {reinterpret_cast<const char*>(data), size}, sink, budget, progress, {}};
  const auto report = reader(job);
  if (report && sink.has_triangles() && sink.highest() >= report->vertices) std::abort();
  if (!report && report.error().message.empty()) std::abort();
  return 0;
}

}  // namespace cuesta::fuzz

#define FUZZ_READER(reader)                                                           \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    return cuesta::fuzz::run(cuesta::reader, data, size);                             \
  }
