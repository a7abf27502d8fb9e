/// Whatever decode_scene_directory accepts can be encoded again.

#include "hierarchy/scene_directory.h"
#include "tests/fuzz/packed_mutator.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto decoded = cuesta::decode_scene_directory({reinterpret_cast<const std::byte*>(data), size}, 64);
  if (decoded) cuesta::encode_scene_directory(*decoded);
  return 0;
}

/// A byte of the version is before it.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
  return cuesta::fuzz::mutate_packed(data, size, most, seed, 1);
}
