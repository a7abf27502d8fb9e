#pragma once
/// Cuts of files made for a test.

#include <limits>
#include <random>

#include "runtime/cut.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {

inline constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

inline std::unique_ptr<Cut> open_cut(
    const std::filesystem::path& path, std::uint64_t cache_bytes = unlimited,
    Clock clock = [] { return 0.0; }) {
  auto file = CuestaFile::open(path);
  if (!file) return nullptr;
  auto cut = Cut::open(std::move(*file), cache_bytes, std::move(clock));
  return cut ? std::move(*cut) : nullptr;
}

/// A camera somewhere near the model, looking at some of it; the same for the same numbers on every machine.
inline View random_view(const Directory& d, std::mt19937& random) {
  const auto unit = [&random] { return static_cast<double>(random() >> 8) / (1 << 24); };
  const Vec3d lo = d.grid.world(d.lo), hi = d.grid.world(d.hi);
  const double size = length(hi - lo);
  View view;
  view.target = lo + Vec3d{unit() * (hi.x - lo.x), unit() * (hi.y - lo.y), unit() * (hi.z - lo.z)};
  const Vec3d away = normalized(Vec3d{unit() - 0.5, unit() - 0.5, unit() - 0.45});
  view.eye = view.target + away * (size * (0.02 + 1.5 * unit() * unit()));
  return view;
}

}  // namespace cuesta::test
