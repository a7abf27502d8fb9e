/// Pictures: JPEG, PNG and TIFF, decoded as for a drape.

#include "terrain/image_pixels.h"
#include "tests/fuzz/fuzz_terrain.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta;
  constexpr std::uint64_t most_pixels = std::uint64_t{1} << 22;  // what a fuzzer can wait for
  auto image = open_image(test::memory_file("a", {reinterpret_cast<const char*>(data), size}), {});
  if (!image) {
    if (image.error().message.empty()) std::abort();
    return 0;
  }
  ImagePixels& pixels = **image;
  if (std::uint64_t{pixels.block_width} * pixels.block_height > most_pixels) return 0;
  std::vector<Rgba8> colours(std::size_t{pixels.block_width} * pixels.block_height);
  for (const bool last : {false, true}) {
    const auto loaded = pixels.load(last ? (pixels.width - 1) / pixels.block_width : 0,
                                    last ? (pixels.height - 1) / pixels.block_height : 0, colours);
    if (!loaded && loaded.error().message.empty()) std::abort();
  }
  return 0;
}
