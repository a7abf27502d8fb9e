#include "ooc/gltf_chunks.h"

#include <fmt/format.h>

#include <cstring>

namespace cuesta::gltf {
namespace {

struct Chunks {
  std::string_view json;
  std::span<const char> binary;
};

Result<Chunks> chunks_of(const ReadJob& job) {
  const std::span<const char> bytes = job.bytes;
  if (bytes.size() < 4 || std::memcmp(bytes.data(), "glTF", 4) != 0)
    return Chunks{{bytes.data(), bytes.size()}, {}};
  const auto word = [&](std::uint64_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  if (bytes.size() < 20) return job.corrupt_at(bytes.size(), "expected a GLB header and a JSON chunk");
  if (word(4) != 2) {
    return job.error(ErrorCode::unsupported_version, "byte 4",
                     fmt::format("GLB version {}; 2 can be read", word(4)));
  }
  const std::uint64_t length = word(8);
  if (length > bytes.size() || length < 20) {
    return job.corrupt_at(8, fmt::format("expected {} bytes, found {}", length, bytes.size()));
  }
  constexpr std::uint32_t json_type = 0x4e4f534a;
  constexpr std::uint32_t binary_type = 0x004e4942;
  const std::uint64_t json_bytes = word(12);
  if (word(16) != json_type || json_bytes > length - 20)
    return job.corrupt_at(12, "expected a JSON chunk that fits the file");
  Chunks chunks{{bytes.data() + 20, json_bytes}, {}};
  const std::uint64_t second = 20 + (json_bytes + 3) / 4 * 4;
  if (second + 8 > length || word(second + 4) != binary_type) return chunks;
  if (word(second) > length - second - 8)
    return job.corrupt_at(second, "expected a binary chunk that fits the file");
  chunks.binary = bytes.subspan(second + 8, word(second));
  return chunks;
}

}  // namespace

Result<ParsedFile> parse_file(const ReadJob& job) {
  const auto chunks = chunks_of(job);
  if (!chunks) return fail(chunks.error());
  CUESTA_TRY(job.budget.charge(chunks->json.size(), 1, "bytes of JSON"));
  auto document = parse(job, chunks->json);
  if (!document) return fail(std::move(document).error());
  job.budget.release(chunks->json.size());
  if (job.window) job.window->release_all();
  return ParsedFile{std::move(*document), chunks->binary};
}

}  // namespace cuesta::gltf
