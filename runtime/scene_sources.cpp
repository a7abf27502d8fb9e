#include "runtime/scene_sources.h"

#include "hierarchy/tom_codec.h"

namespace cuesta {
namespace {

Result<Tom> read_prefix(const SceneFile& file, std::uint32_t part, const Tom* have,
                        std::uint32_t have_segments, std::uint32_t segments) {
  Tom tom = have ? *have : Tom{};
  for (std::uint32_t s = have_segments; s < segments; ++s) {
    const auto bytes = file.read_segment(part, s);
    if (!bytes) return fail(bytes.error());
    if (auto ok = decode_tom_segment(*bytes, tom); !ok) {
      Error error = ok.error();
      error.file = file.path().string();
      error.place = "part " + std::to_string(part) + ", segment " + std::to_string(s);
      return fail(error);
    }
  }
  return tom;
}

}  // namespace

SceneSources sources_of(const SceneFile& file, Clock clock, std::uint32_t load_threads) {
  SceneSources sources;
  sources.tom = [&file](std::uint32_t part, const Tom* have, std::uint32_t have_segments,
                        std::uint32_t segments) {
    return read_prefix(file, part, have, have_segments, segments);
  };
  sources.surface = [&file, clock = std::move(clock), load_threads](
                        std::uint32_t part, std::uint64_t cache_bytes) -> Result<std::unique_ptr<Cut>> {
    auto surface = file.open_surface(part);
    if (!surface) return fail(surface.error());
    return Cut::open(std::move(*surface), cache_bytes, clock, load_threads);
  };
  return sources;
}

}  // namespace cuesta
