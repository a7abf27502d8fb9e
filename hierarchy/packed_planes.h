#pragma once
/// Planes as bytes: varint raw bytes, varint stored bytes, then the stored bytes, which are a zstd frame, or
/// the raw bytes when the two sizes are equal.

#include <cstdint>
#include <memory>
#include <span>

#include "hierarchy/number_planes.h"
#include "ooc/byte_stream.h"
#include "ooc/result.h"

namespace cuesta {

struct StoredPlane {
  std::uint64_t raw = 0;
  std::span<const std::byte> bytes;
};

/// @error corrupt: the bytes end within it.
Result<StoredPlane> stored_plane(ByteReader& r);

/// Keeps zstd's working memory for many planes.
class PlaneCompressor {
 public:
  PlaneCompressor();
  ~PlaneCompressor();
  void write(ByteWriter& w, const Plane& raw);

 private:
  struct Zstd;
  std::unique_ptr<Zstd> zstd_;
};

class PlaneDecompressor {
 public:
  PlaneDecompressor();
  ~PlaneDecompressor();
  /// @param most  raw bytes that are allocated at most; 65,536 times the stored bytes are another limit
  /// @error corrupt
  Result<Plane> read(ByteReader& r, std::uint64_t most);

 private:
  struct Zstd;
  std::unique_ptr<Zstd> zstd_;
};

}  // namespace cuesta
