/// Whatever decode_page accepts can be encoded again.

#include "hierarchy/page_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoded = cuesta::decode_page({reinterpret_cast<const std::byte*>(data), size});
  if (decoded) cuesta::encode_page(*decoded);
  return 0;
}
