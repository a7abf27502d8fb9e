#pragma once
/// The task of a build: one cell of a round → a page, and what the next round gets. Pure: addressed by
/// (round, cell), a function of the surface, the cell and the options alone.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hierarchy/cell_cache.h"
#include "hierarchy/directory.h"
#include "hierarchy/page_codec.h"
#include "hierarchy/page_survivors.h"
#include "hierarchy/round_chunk.h"
#include "ooc/input_surface.h"
#include "ooc/result.h"

namespace cuesta {

struct CellOptions {
  std::uint32_t round = 0;
  bool base = false;           ///< the last page: everything stays
  double round_reduction = 4;  ///< the cell is simplified to its triangles divided by this, > 1
  CellCache* cache = nullptr;  ///< what cells became before; changes no result
};

/// What is kept in the journal of a finished task, but for where its bytes lie.
struct CellFacts {
  PageEntry entry;              ///< `block` and `coarser` are not known yet
  std::vector<PageId> sources;  ///< pages of the round before that it holds survivors of
  std::uint64_t fans = 0, substitutions = 0;
  PageStreamBytes stream_bytes{};
  std::uint32_t survivor_triangles = 0;
  Box3<float> survivor_box;    ///< of survivors' vertices and centres, next round's axes
  std::vector<Vec3f> centres;  ///< of some of the surviving triangles, evenly: where the next round is dense
};

struct CellOutput {
  CellFacts facts;
  std::vector<std::byte> page;
  std::vector<std::byte> survivors;  ///< encode_survivors(); empty for the base page
};

/// One surviving triangle of so many is in CellFacts::centres.
inline constexpr std::uint32_t centre_stride = 64;

/// @param surface  what a field of heights is measured against
/// @error those of InputSurface::measure()
Result<CellOutput> run_cell_task(Cell cell, const RoundChunk& chunk, const InputSurface& surface,
                                 const CellOptions& options);

}  // namespace cuesta
