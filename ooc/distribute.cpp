#include "ooc/distribute.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>

#include "ooc/ordered_tasks.h"

namespace cuesta {
namespace {

/// Triangles whose corners are brought together at one time.
constexpr std::uint64_t gather_triangles = std::uint64_t{1} << 17;
constexpr std::uint64_t writer_bytes = std::uint64_t{32} << 20;

/// A corner of a triangle with all that its vertex has.
struct Corner {
  Vec3d position;
  OctNormal normal{};
  Rgba8 colour{};
  FixedTexCoord texcoord{};
};

/// A corner on its way to its triangle.
struct TravellingCorner {
  std::uint64_t slot = 0;  ///< 4 · ordinal + corner
  Corner corner;
};

Corner corner_of(const RawVertices& block, std::uint32_t v) {
  Corner c;
  c.position = block.positions[v];
  if (!block.normals.empty()) c.normal = block.normals[v];
  if (!block.colours.empty()) c.colour = block.colours[v];
  if (!block.texcoords.empty()) c.texcoord = block.texcoords[v];
  return c;
}

using Writers = tbb::enumerable_thread_specific<BucketFile::Writer>;

std::uint32_t buffer_bytes(std::size_t buckets) {
  const std::uint64_t share = writer_bytes / arena_threads() / std::max<std::size_t>(1, buckets);
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(share, 1u << 12, 1u << 16));
}

Result<void> flush(Writers& writers) {
  for (auto& w : writers)
    if (auto r = w.flush(); !r) return r;
  return {};
}

class Distributor {
 public:
  Distributor(const RawSurface& raw, const Grid& grid, const SpaceTree& tree, const SoupLayout& layout,
              const std::filesystem::path& folder, BucketFile& soup, const TriangleProgress& progress)
      : raw_(raw),
        grid_(grid),
        tree_(tree),
        layout_(layout),
        folder_(folder),
        progress_(progress),
        writers_([&soup, size = buffer_bytes(tree.leaf_count())] { return BucketFile::Writer(soup, size); }) {
  }

  Result<std::uint64_t> run(MemoryBudget& memory) {
    const std::uint64_t block_bytes =
        std::min(raw_.block_vertices(), raw_.counts().vertices) * raw_vertex_bytes;
    auto reserved = memory.reserve(block_bytes + 2 * writer_bytes, "joining triangles with vertices");
    if (!reserved) return fail(reserved.error());
    auto travelling = BucketFile::create(folder_ / "travelling");
    if (!travelling) return fail(travelling.error());
    if (auto r = join_blocks(*travelling); !r) return fail(r.error());
    if (auto r = gather(*travelling); !r) return fail(r.error());
    if (auto r = flush(writers_); !r) return fail(r.error());
    std::error_code ignored;
    std::filesystem::remove(folder_ / "travelling", ignored);
    return nonfinite_.load();
  }

 private:
  Result<void> join_blocks(BucketFile& travelling) {
    const std::uint64_t ranges = raw_.counts().triangles / gather_triangles + 1;
    Writers corner_writers([&, size = buffer_bytes(ranges)] { return BucketFile::Writer(travelling, size); });
    const BucketFile& triangles = raw_.local_triangles();
    const BucketFile& corners = raw_.local_corners();
    const std::size_t tokens = arena_threads() * 2;
    for (std::uint32_t b = 0; b < raw_.block_count(); ++b) {
      const auto block = raw_.block(b);
      if (!block) return fail(block.error());
      auto r = run_all(triangles.piece_count(b), tokens, [&](std::uint64_t piece) -> Result<void> {
        const auto bytes = triangles.read_piece(b, piece);
        if (!bytes) return fail(bytes.error());
        return join(*block, records_of<LocalTriangle>(*bytes));
      });
      if (!r) return r;
      r = run_all(corners.piece_count(b), tokens, [&](std::uint64_t piece) -> Result<void> {
        const auto bytes = corners.read_piece(b, piece);
        if (!bytes) return fail(bytes.error());
        auto& writer = corner_writers.local();
        for (const LocalCorner& c : records_of<LocalCorner>(*bytes)) {
          const TravellingCorner t{c.slot(), corner_of(*block, c.vertex)};
          const auto range = static_cast<std::uint32_t>(c.slot() / 4 / gather_triangles);
          if (auto w = writer.append(range, t); !w) return w;
        }
        return {};
      });
      if (!r) return r;
    }
    return flush(corner_writers);
  }

  Result<void> join(const RawVertices& block, const std::vector<LocalTriangle>& triangles) {
    auto& writer = writers_.local();
    for (const LocalTriangle& t : triangles) {
      const std::array<Corner, 3> corners{corner_of(block, t.corners[0]), corner_of(block, t.corners[1]),
                                          corner_of(block, t.corners[2])};
      if (auto r = emit(t.ordinal(), corners, writer); !r) return r;
    }
    return report(triangles.size());
  }

  /// Brings the corners of a range of triangles together.
  Result<void> gather(const BucketFile& travelling) {
    return run_all(travelling.bucket_count(), arena_threads(), [&](std::uint64_t range) -> Result<void> {
      const auto bytes = travelling.read(static_cast<std::uint32_t>(range));
      if (!bytes) return fail(bytes.error());
      auto corners = records_of<TravellingCorner>(*bytes);
      std::sort(corners.begin(), corners.end(),
                [](const TravellingCorner& a, const TravellingCorner& b) { return a.slot < b.slot; });
      auto& writer = writers_.local();
      for (std::size_t i = 0; i + 2 < corners.size(); i += 3)
        if (auto r = emit(corners[i].slot / 4,
                          {corners[i].corner, corners[i + 1].corner, corners[i + 2].corner}, writer);
            !r)
          return r;
      travelling.discard(static_cast<std::uint32_t>(range));
      return report(corners.size() / 3);
    });
  }

  /// Snaps a triangle and writes it to its chunk and to its neighbours.
  Result<void> emit(std::uint64_t ordinal, const std::array<Corner, 3>& corners, BucketFile::Writer& writer) {
    if (!is_finite(corners[0].position) || !is_finite(corners[1].position) ||
        !is_finite(corners[2].position)) {
      ++nonfinite_;
      return {};
    }
    SoupTriangle t;
    t.ordinal = ordinal;
    for (std::size_t k = 0; k < 3; ++k) {
      t.positions[k] = grid_.snap(corners[k].position);
      t.normals[k] = corners[k].normal;
      t.colours[k] = corners[k].colour;
      t.texcoords[k] = corners[k].texcoord;
    }
    if (layout_.area_normals) {
      const Vec3d a = corners[0].position;
      t.area_normal = vec_cast<float>(
          cross((corners[1].position - a) / grid_.step, (corners[2].position - a) / grid_.step));
    }
    return put_in_chunks(t, tree_, layout_, writer);
  }

  Result<void> report(std::size_t triangles) {
    const std::uint64_t done = done_ += triangles;
    if (progress_ && !progress_(done))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  const RawSurface& raw_;
  const Grid& grid_;
  const SpaceTree& tree_;
  const SoupLayout& layout_;
  const std::filesystem::path& folder_;
  const TriangleProgress& progress_;
  Writers writers_;
  std::atomic<std::uint64_t> done_{0}, nonfinite_{0};
};

}  // namespace

TriangleChunks chunks_of(const std::array<Vec3i, 3>& corners, const SpaceTree& tree) {
  const Vec3d sum =
      vec_cast<double>(corners[0]) + vec_cast<double>(corners[1]) + vec_cast<double>(corners[2]);
  TriangleChunks out;
  const std::uint32_t owner = tree.leaf_of(vec_cast<float>(sum / 3.0));
  out.chunks[out.count++] = owner;
  for (const Vec3i& corner : corners) {
    const Vec3f p = vec_cast<float>(corner);
    if (holds(tree.leaf_box(owner), p)) continue;
    const std::uint32_t leaf = tree.leaf_of(p);
    const auto told = out.all();
    if (std::find(told.begin(), told.end(), leaf) == told.end()) out.chunks[out.count++] = leaf;
  }
  return out;
}

Result<void> put_in_chunks(SoupTriangle& t, const SpaceTree& tree, const SoupLayout& layout,
                           BucketFile::Writer& writer) {
  const TriangleChunks chunks = chunks_of(t.positions, tree);
  t.owner = chunks.chunks[0];
  std::array<std::byte, max_soup_record_bytes> buffer;
  for (const std::uint32_t chunk : chunks.all())
    if (auto r = writer.append(chunk, encode(t, chunk, layout, buffer)); !r) return r;
  return {};
}

Result<std::uint64_t> distribute(const RawSurface& raw, const Grid& grid, const SpaceTree& tree,
                                 const SoupLayout& layout, MemoryBudget& memory,
                                 const std::filesystem::path& folder, BucketFile& soup,
                                 const TriangleProgress& progress) {
  return Distributor(raw, grid, tree, layout, folder, soup, progress).run(memory);
}

}  // namespace cuesta
