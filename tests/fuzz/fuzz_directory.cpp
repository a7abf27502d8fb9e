/// Whatever decode_directory accepts can be encoded again.

#include "hierarchy/directory.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoded = cuesta::decode_directory({reinterpret_cast<const std::byte*>(data), size});
  if (decoded) cuesta::encode_directory(*decoded);
  return 0;
}
