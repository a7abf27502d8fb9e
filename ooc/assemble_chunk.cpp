#include "ooc/assemble_chunk.h"

#include <algorithm>
#include <numeric>

namespace cuesta {
namespace {

/// What a neighbour says about a corner at one of its points.
struct ForeignCorner {
  std::uint64_t slot = 0;
  VertexId id = 0;
  std::uint32_t wedge = 0;
  OctNormal normal{};
};

Result<std::vector<ForeignCorner>> foreign_corners(const CleanChunk& chunk,
                                                   std::span<const ChunkReplies> replies) {
  std::vector<ForeignCorner> corners;
  for (const ChunkReplies& letter : replies)
    for (const CornerReply& r : letter.corners)
      corners.push_back({r.slot, vertex_id(letter.chunk, r.vertex), r.wedge, r.normal});
  std::sort(corners.begin(), corners.end(),
            [](const ForeignCorner& a, const ForeignCorner& b) { return a.slot < b.slot; });
  const bool complete =
      std::equal(corners.begin(), corners.end(), chunk.foreign_slots.begin(), chunk.foreign_slots.end(),
                 [](const ForeignCorner& a, std::uint64_t slot) { return a.slot == slot; });
  if (!complete) return fail(ErrorCode::corrupt, "", "", "chunks in the work folder do not fit together");
  return corners;
}

/// All vertices that triangles use, in ascending order of ids; the chunk's own keep its numbers.
class ChunkAssembler {
 public:
  ChunkAssembler(std::uint32_t c, CleanChunk chunk, std::vector<ForeignCorner> foreign)
      : c_(c), chunk_(std::move(chunk)), foreign_(std::move(foreign)) {}

  SurfaceChunk run() {
    find_used();
    order_foreign();
    number_.assign(chunk_.vertices.size() + foreign_.size(), 0);
    std::size_t next = add_foreign(0, [this](VertexId id) { return id < vertex_id(c_, 0); });
    for (std::uint32_t v = 0; v < chunk_.vertices.size(); ++v)
      if (used_[v]) add(v, vertex_id(c_, v), chunk_.wedge[v], chunk_.vertices, v, v < chunk_.shared);
    add_foreign(next, [](VertexId) { return true; });
    for (const Triangle& t : chunk_.triangles)
      out_.triangles.push_back({number_[t[0]], number_[t[1]], number_[t[2]]});
    out_.first_free = vertex_id(c_, chunk_.shared);
    return std::move(out_);
  }

 private:
  void find_used() {
    used_.assign(chunk_.vertices.size(), 0);
    for (const Triangle& t : chunk_.triangles)
      for (std::uint32_t v : t)
        if (v < used_.size()) used_[v] = 1;
  }

  void order_foreign() {
    order_.resize(foreign_.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(), [this](std::uint32_t a, std::uint32_t b) {
      return foreign_[a].id != foreign_[b].id ? foreign_[a].id < foreign_[b].id : a < b;
    });
  }

  void add(std::uint32_t corner, VertexId id, std::uint32_t wedge, const VertexTable& table, std::size_t i,
           bool locked) {
    number_[corner] = static_cast<std::uint32_t>(out_.ids.size());
    out_.ids.push_back(id);
    out_.wedge.push_back(wedge);
    out_.vertices.append(table, i);
    out_.locked.push_back(locked);
  }

  /// Adds foreign vertices from the next-th on while `wanted`; each once. @return where it stopped
  template <class Wanted>
  std::size_t add_foreign(std::size_t next, Wanted wanted) {
    const auto own = static_cast<std::uint32_t>(chunk_.vertices.size());
    for (; next < order_.size() && wanted(foreign_[order_[next]].id); ++next) {
      const std::uint32_t f = order_[next];
      const ForeignCorner& corner = foreign_[f];
      if (next > 0 && foreign_[order_[next - 1]].id == corner.id) {
        number_[own + f] = static_cast<std::uint32_t>(out_.ids.size() - 1);
        continue;
      }
      if (!chunk_.foreign.normals.empty()) chunk_.foreign.normals[f] = corner.normal;
      add(own + f, corner.id, corner.wedge, chunk_.foreign, f, true);
    }
    return next;
  }

  std::uint32_t c_;
  CleanChunk chunk_;
  std::vector<ForeignCorner> foreign_;
  std::vector<std::uint8_t> used_;
  std::vector<std::uint32_t> order_, number_;
  SurfaceChunk out_;
};

}  // namespace

Result<SurfaceChunk> assemble_chunk(std::uint32_t c, CleanChunk chunk,
                                    std::span<const ChunkReplies> replies) {
  auto foreign = foreign_corners(chunk, replies);
  if (!foreign) return fail(foreign.error());
  return ChunkAssembler(c, std::move(chunk), std::move(*foreign)).run();
}

}  // namespace cuesta
