#pragma once
/// Directories are one zstd frame behind a varint, so random bytes hardly ever get further than zstd: this
/// changes what is in the frame. One input in eight is changed as it is.

#include <zstd.h>

#include <cstdint>
#include <cstring>
#include <vector>

#include "ooc/byte_stream.h"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace cuesta::fuzz {

/// For LLVMFuzzerCustomMutator().   @param head  bytes before the varint, which stay.
inline std::size_t mutate_packed(std::uint8_t* data, std::size_t size, std::size_t most, unsigned seed,
                                 std::size_t head = 0) {
  constexpr std::uint64_t most_plain = 1 << 20;
  const std::span<const std::byte> bytes(reinterpret_cast<const std::byte*>(data), size);
  ByteReader in(bytes.subspan(std::min(head, size)));
  const std::uint64_t raw = in.get_varint();
  if (!in.ok() || raw > most_plain || seed % 8 == 0) return LLVMFuzzerMutate(data, size, most);
  std::vector<std::uint8_t> plain(raw + 256);
  const auto frame = in.get_bytes(in.remaining());
  const std::size_t got = ZSTD_decompress(plain.data(), raw, frame.data(), frame.size());
  if (ZSTD_isError(got)) return LLVMFuzzerMutate(data, size, most);
  const std::size_t now = LLVMFuzzerMutate(plain.data(), got, plain.size());
  ByteWriter out;
  out.put_bytes(bytes.first(head));
  out.put_varint(now);
  std::vector<std::byte> packed(ZSTD_compressBound(now));
  packed.resize(ZSTD_compress(packed.data(), packed.size(), plain.data(), now, 1));
  out.put_bytes(packed);
  if (out.size() > most) return LLVMFuzzerMutate(data, size, most);
  std::memcpy(data, out.bytes().data(), out.size());
  return out.size();
}

}  // namespace cuesta::fuzz
