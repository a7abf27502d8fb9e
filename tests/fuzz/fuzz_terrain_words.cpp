/// What is parsed by our own code, by the first byte modulo 3: GeoKeys, sidecars, and facts in metadata.
#include <cstring>

#include "terrain/geo_keys.h"
#include "terrain/raster_sidecar.h"
#include "terrain/terrain_metadata.h"
#include "tests/fuzz/fuzz_terrain.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace cuesta;
  if (size == 0) return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] % 3 == 2) {
    const auto facts = terrain_facts(text);
    if (!facts && facts.error().message.empty()) std::abort();
    if (facts && *facts && !terrain_facts("{\"terrain\":" + terrain_json(**facts) + "}").value())
      std::abort();
    return 0;
  }
  if (data[0] % 3 == 1) {
    RasterOptions options;
    const auto parsed = parse_sidecar(text, "a.json", options);
    if (!parsed && parsed.error().message.empty()) std::abort();
    if (parsed) (void)check_options(options, "a").has_value();
    return 0;
  }
  std::vector<std::uint16_t> directory(text.size() / 2);
  if (!directory.empty()) std::memcpy(directory.data(), text.data(), directory.size() * 2);
  const std::vector<double> doubles{1, 2, 3};
  const auto keys = parse_geo_keys(directory, doubles, "name|other|");
  RasterInfo info;
  if (keys) (void)apply_vertical_keys(*keys, info).has_value();
  return 0;
}
