/// Two segments of a TOM from hostile bytes: what is accepted is a consistent TOM and can be encoded again.

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "hierarchy/tom_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  if (size < 2) return 0;
  // The first two bytes say where the second segment begins.
  const std::size_t first = std::min(size - 2, data[0] + std::size_t{256} * data[1]);
  cuesta::Tom tom;
  for (const auto segment : {bytes.subspan(2, first), bytes.subspan(2 + first)}) {
    if (!cuesta::decode_tom_segment(segment, tom)) return 0;
    if (!cuesta::is_consistent(tom)) std::abort();
    cuesta::encode_tom_segment(tom, 0, tom.full());
  }
  return 0;
}
