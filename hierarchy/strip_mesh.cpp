#include "hierarchy/strip_mesh.h"

#include <algorithm>
#include <cstring>

#include "hierarchy/strip_reduction.h"
#include "ooc/check.h"

namespace cuesta {
namespace {

template <class T>
std::uint64_t bytes_of(const std::vector<T>& v) {
  return v.size() * sizeof(T);
}

}  // namespace

std::size_t StripMesh::band_of(std::uint32_t resolution) const {
  const auto coarser = [](std::uint32_t r, const Band& b) { return b.finest < r; };
  return static_cast<std::size_t>(std::upper_bound(bands_.begin(), bands_.end(), resolution, coarser) -
                                  bands_.begin()) -
         1;
}

StripChanges StripMesh::set_resolution(std::uint32_t resolution) {
  CUESTA_CHECK(resolution >= base_resolution_ && resolution <= vertex_count(), resolution, base_resolution_);
  resolution_ = resolution;
  Band& band = bands_[band_of(resolution)];
  const std::uint32_t before = band.resolution;
  while (band.resolution > resolution) coarsen(band);
  while (band.resolution < resolution) refine(band);
  const std::uint32_t n = vertex_count();
  const auto [fine, coarse] = std::minmax({n - before, n - resolution});
  return {coarse - fine, steps_[coarse].first_write - steps_[fine].first_write,
          steps_[coarse].first_cut - steps_[fine].first_cut};
}

void StripMesh::coarsen(Band& band) {
  const std::uint32_t v = --band.resolution;
  const Step &from = steps_[vertex_count() - 1 - v], &to = steps_[vertex_count() - v];
  for (std::uint32_t i = from.first_write; i < to.first_write; ++i) entries_[writes_[i]] = substitute_[v];
  for (std::uint32_t i = from.first_cut; i < to.first_cut; ++i) apply(band, cuts_[i]);
}

void StripMesh::refine(Band& band) {
  const std::uint32_t v = band.resolution++;
  const Step &from = steps_[vertex_count() - 1 - v], &to = steps_[vertex_count() - v];
  for (std::uint32_t i = to.first_cut; i-- > from.first_cut;) undo(band, cuts_[i]);
  for (std::uint32_t i = from.first_write; i < to.first_write; ++i) entries_[writes_[i]] = v;
}

void StripMesh::apply(Band& band, Cut cut) {
  Live& strip = strips_[cut.strip];
  std::uint32_t* const e = entries_.data();
  const std::uint32_t where = cut.where;
  switch (cut.kind) {
    case CutKind::move_head:
      std::memmove(e + strip.begin + 2, e + strip.begin, (where - strip.begin) * sizeof *e);
      strip.begin += 2;
      break;
    case CutKind::move_tail:
      std::memmove(e + where + 2, e + where + 4, (strip.end - where - 4) * sizeof *e);
      strip.end -= 2;
      break;
    case CutKind::trim_head:
      strip.begin += where;
      break;
    case CutKind::trim_tail:
      strip.end -= where;
      break;
  }
  band.live_strips -= strip.begin == strip.end;
}

void StripMesh::undo(Band& band, Cut cut) {
  Live& strip = strips_[cut.strip];
  std::uint32_t* const e = entries_.data();
  const std::uint32_t where = cut.where;
  band.live_strips += strip.begin == strip.end;
  switch (cut.kind) {
    case CutKind::move_head:
      strip.begin -= 2;
      std::memmove(e + strip.begin, e + strip.begin + 2, (where - strip.begin) * sizeof *e);
      std::memcpy(e + where, e + where + 2, 2 * sizeof *e);
      break;
    case CutKind::move_tail:
      std::memmove(e + where + 4, e + where + 2, (strip.end - where - 2) * sizeof *e);
      std::memcpy(e + where + 2, e + where, 2 * sizeof *e);
      strip.end += 2;
      break;
    case CutKind::trim_head:
      strip.begin -= where;
      break;
    case CutKind::trim_tail:
      strip.end += where;
      break;
  }
}

std::size_t StripMesh::write_indices(std::span<std::uint32_t> out) const {
  CUESTA_CHECK(out.size() >= index_bound_, out.size(), index_bound_);
  const Band& band = bands_[band_of(resolution_)];
  std::uint32_t* to = out.data();
  for (const Live& strip : std::span(strips_).subspan(band.first_strip, band.live_strips)) {
    const std::uint32_t length = strip.end - strip.begin;
    const std::uint32_t* from = entries_.data() + strip.begin;
    to += skips_when_drawn_ ? reduce_strip({from, length}, to) : copy_strip(from, length, to);
  }
  return static_cast<std::size_t>(to - out.data());
}

std::uint64_t StripMesh::bytes() const {
  return bytes_of(substitute_) + bytes_of(bands_) + bytes_of(strips_) + bytes_of(entries_) +
         bytes_of(steps_) + bytes_of(writes_) + bytes_of(cuts_);
}

}  // namespace cuesta
