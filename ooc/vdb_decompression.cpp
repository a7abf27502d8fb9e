/// Stands in for functions of OpenVDB 10 that believe a damaged file: they copy as many bytes as a chunk of
/// values says into a buffer for as many as it should have, have Blosc decode bytes that it has not checked,
/// and end the process where a table of chunks is too short. Found by fuzz_vdb. All reading, in templates
/// here and in the library, comes to these; a program's own definition is taken before a shared library's.
/// Same format; what the library refuses with an exception, these refuse with one.

#include <blosc.h>
#include <openvdb/Exceptions.h>
#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <zlib.h>

#include <cstdint>
#include <istream>
#include <memory>
#include <vector>

static_assert(OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10, "is this needed still, and the same?");

namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {
namespace io {
namespace {

/// What compression may add, if the writer keeps its result all the same.
constexpr std::size_t most_overhead = BLOSC_MAX_OVERHEAD;

struct Chunk {
  bool is_compressed = false;
  std::unique_ptr<char[]> bytes;
  std::size_t size = 0;
};

/// Reads a chunk up to its end. What is stored as it is goes to `data`, what is compressed is returned.
/// @param data  null: only passes over it
Chunk read_chunk(std::istream& is, char* data, std::size_t expected) {
  std::int64_t size = 0;
  is.read(reinterpret_cast<char*>(&size), sizeof(size));
  Chunk chunk;
  chunk.is_compressed = size > 0;
  chunk.size =
      chunk.is_compressed ? static_cast<std::size_t>(size) : std::size_t{0} - static_cast<std::size_t>(size);
  if (!is || (chunk.is_compressed ? chunk.size > expected + most_overhead : chunk.size != expected))
    OPENVDB_THROW(RuntimeError, "a chunk of " << expected << " bytes of values is damaged");
  if (!data) {
    is.seekg(static_cast<std::streamoff>(chunk.size), std::ios_base::cur);
    return chunk;
  }
  if (chunk.is_compressed) chunk.bytes = std::make_unique<char[]>(chunk.size);
  is.read(chunk.is_compressed ? chunk.bytes.get() : data, static_cast<std::streamsize>(chunk.size));
  return chunk;
}

void expect(bool good) {
  if (!good) OPENVDB_THROW(RuntimeError, "compressed values are damaged");
}

template <class T>
T element(const std::vector<T>& table, std::size_t index) {
  expect(index < table.size());
  return table[index];
}

}  // namespace

DelayedLoadMetadata::MaskType DelayedLoadMetadata::getMask(std::size_t leaf) const {
  return element(mMask, leaf);
}

DelayedLoadMetadata::CompressedSizeType DelayedLoadMetadata::getCompressedSize(std::size_t leaf) const {
  return element(mCompressedSize, leaf);
}

void unzipFromStream(std::istream& is, char* data, std::size_t expected) {
  const Chunk chunk = read_chunk(is, data, expected);
  if (!chunk.bytes) return;
  uLongf size = expected;
  expect(uncompress(reinterpret_cast<Bytef*>(data), &size, reinterpret_cast<const Bytef*>(chunk.bytes.get()),
                    chunk.size) == Z_OK &&
         size == expected);
}

void bloscFromStream(std::istream& is, char* data, std::size_t expected) {
  const Chunk chunk = read_chunk(is, data, expected);
  if (!chunk.bytes) return;
  std::size_t size = 0;
  expect(blosc_cbuffer_validate(chunk.bytes.get(), chunk.size, &size) == 0 && size == expected);
  expect(blosc_decompress_ctx(chunk.bytes.get(), data, expected, 1) == static_cast<int>(expected));
}

}  // namespace io
}  // namespace OPENVDB_VERSION_NAME
}  // namespace openvdb
