/// Whatever decode_page accepts can be encoded again.

#include "hierarchy/page_codec.h"
#include "ooc/byte_stream.h"

namespace {

/// As many survivors as the header speaks of, somewhere.
std::vector<cuesta::Vec3i> survivors_of(std::span<const std::byte> page) {
  cuesta::ByteReader r(page);
  r.get_bytes(6);
  const auto vertices = r.get<std::uint32_t>();
  r.get_bytes(4);
  const auto owned = r.get<std::uint32_t>();
  std::vector<cuesta::Vec3i> places;
  if (!r.ok() || owned > vertices || vertices - owned > 1u << 16) return places;
  for (std::uint32_t i = 0; i < vertices - owned; ++i)
    places.push_back({static_cast<std::int32_t>(i * 40503u), static_cast<std::int32_t>(i % 97), 3});
  return places;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::span page(reinterpret_cast<const std::byte*>(data), size);
  const auto decoded = cuesta::decode_page(page, survivors_of(page));
  if (decoded) cuesta::encode_page(*decoded);
  return 0;
}
