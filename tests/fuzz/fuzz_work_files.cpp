/// What a build keeps in its work folder, damaged: whatever is accepted can be used and encoded again. The
/// first byte says which file the rest is of (work_file_seeds.cpp has a good one of each).

#include <unistd.h>

#include <cstdlib>
#include <limits>

#include "hierarchy/page_survivors.h"
#include "hierarchy/round_journal.h"
#include "ooc/bucket_file.h"
#include "ooc/clean_chunk.h"
#include "tests/fuzz/work_file_kinds.h"

namespace {

using namespace cuesta;
using Bytes = std::span<const std::byte>;

void try_chunk(Bytes bytes) {
  const auto chunk = decode_chunk(bytes);
  if (chunk && !decode_chunk(encode_chunk(*chunk))) std::abort();
}

void try_survivors(Bytes bytes) {
  auto survivors = decode_survivors(bytes);
  if (!survivors) return;
  if (!decode_survivors(encode_survivors(*survivors))) std::abort();
  const std::size_t triangles = survivors->triangles.size();
  const SpaceTree everywhere({}, 1, identity_axes);
  ChunkCollector collector(everywhere, 0);
  collector.add(0, std::move(*survivors));
  if (collector.take().triangles.size() > triangles) std::abort();
}

void try_record(Bytes bytes) {
  const auto record = decode_record(bytes);
  if (record && !decode_record(encode_record(*record))) std::abort();
}

/// The index of a file of 4 KiB.
void try_bucket_index(Bytes bytes) {
  static const std::string path = [] {
    std::string name = "/tmp/cuesta-fuzz-" + std::to_string(::getpid());
    if (!BucketFile::create(name) || ::truncate(name.c_str(), 4096) != 0) std::abort();
    return name;
  }();
  const auto file = BucketFile::open(path, bytes);
  if (!file) return;
  for (std::uint32_t b = 0; b < file->bucket_count(); ++b) {
    if (file->bytes(b) <= 1u << 20 && !file->read(b)) std::abort();
    for (std::size_t p = 0; p < file->piece_count(b); ++p)
      if (!file->read_piece(b, p)) std::abort();
  }
  if (!BucketFile::open(path, file->encode_index())) std::abort();
}

/// Records of triangles have no checksum: any bytes are a soup, and any soup can be cleaned.
void try_soup(Bytes bytes) {
  if (bytes.empty()) return;
  const auto how = static_cast<std::uint8_t>(bytes[0]);
  const SoupLayout layout{{(how & 1) != 0, (how & 2) != 0, (how & 4) != 0}, (how & 8) != 0};
  const TriangleSoup soup = decode_soup(bytes.subspan(1), 0, layout);
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3<float> box;
  box.lo = {-infinity, -infinity, -infinity};
  box.hi = {(how & 16) != 0 ? 4.0f : infinity, infinity, infinity};
  const CleanedChunk cleaned = clean_chunk(soup, 0, box, layout.area_normals);
  if (!decode_chunk(encode_chunk(cleaned.chunk))) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(reinterpret_cast<const std::byte*>(data) + 1, size - 1);
  switch (static_cast<fuzz::WorkFile>(data[0])) {
    case fuzz::WorkFile::chunk:
      try_chunk(bytes);
      break;
    case fuzz::WorkFile::survivors:
      try_survivors(bytes);
      break;
    case fuzz::WorkFile::record:
      try_record(bytes);
      break;
    case fuzz::WorkFile::bucket_index:
      try_bucket_index(bytes);
      break;
    case fuzz::WorkFile::soup:
      try_soup(bytes);
      break;
  }
  return 0;
}
