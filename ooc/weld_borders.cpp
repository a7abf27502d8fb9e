#include "ooc/weld_borders.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <optional>
#include <system_error>

#include "ooc/border_points.h"
#include "ooc/border_sweep.h"
#include "ooc/byte_stream.h"
#include "ooc/distribute.h"
#include "ooc/journal.h"
#include "ooc/ordered_tasks.h"

namespace cuesta {
namespace {

constexpr const char* records_name = "moved";
constexpr const char* ordinals_name = "replaced";
constexpr const char* points_name = "borders";
constexpr const char* moves_name = "moves";
constexpr std::uint32_t most_ranges = 1024;
constexpr std::uint32_t buffer_bytes = 1u << 13;
/// Buffers of the sweep, which writes for all chunks.
constexpr std::uint64_t move_buffers_bytes = std::uint64_t{8} << 20;
/// What the sweep holds per byte of the points within its reach: 16 of a point become at most 160.
constexpr std::uint64_t sweep_bytes_per_byte = 10;

/// From where to where a point goes, for one chunk.
struct Move {
  Vec3i from, to;
};

bool is_before(const BorderPoint& a, const BorderPoint& b) {
  const std::int64_t x = BorderSweep::order(a.position), y = BorderSweep::order(b.position);
  if (x != y) return x < y;
  return a.position != b.position ? a.position < b.position : a.chunk < b.chunk;
}

/// Parts of the sweep, as even as they come, for what is sorted at one time.
class Ranges {
 public:
  Ranges(const Box3<std::int32_t>& box, std::uint64_t triangles)
      : count_(static_cast<std::uint32_t>(std::clamp<std::uint64_t>(triangles >> 14, 1, most_ranges))) {
    if (box.empty()) return;
    low_ = BorderSweep::order(box.lo);
    width_ = (BorderSweep::order(box.hi) - low_) / count_ + 1;
  }
  std::uint32_t count() const { return count_; }
  std::int64_t width() const { return width_; }
  std::uint32_t of(Vec3i p) const {
    const std::int64_t range = (BorderSweep::order(p) - low_) / width_;
    return static_cast<std::uint32_t>(std::clamp<std::int64_t>(range, 0, count_ - 1));
  }

 private:
  std::uint32_t count_ = 1;
  std::int64_t low_ = 0, width_ = 1;
};

Result<std::unique_ptr<BucketFile>> made(const std::filesystem::path& path) {
  auto file = BucketFile::create(path);
  if (!file) return fail(file.error());
  return std::make_unique<BucketFile>(std::move(*file));
}

}  // namespace

Result<MovedTriangles> MovedTriangles::create(const std::filesystem::path& folder) {
  auto records = made(folder / records_name);
  if (!records) return fail(records.error());
  auto ordinals = made(folder / ordinals_name);
  if (!ordinals) return fail(ordinals.error());
  MovedTriangles out;
  out.records_ = std::move(*records);
  out.ordinals_ = std::move(*ordinals);
  return out;
}

std::vector<std::byte> MovedTriangles::encode() const {
  const auto records = records_->encode_index();
  ByteWriter w;
  w.put(border_points);
  w.put(points_welded);
  w.put(std::uint64_t{records.size()});
  w.put_bytes(records);
  w.put_bytes(ordinals_->encode_index());
  return w.take();
}

Result<MovedTriangles> MovedTriangles::open(const std::filesystem::path& folder,
                                            std::span<const std::byte> state) {
  MovedTriangles out;
  ByteReader r(state);
  out.border_points = r.get<std::uint64_t>();
  out.points_welded = r.get<std::uint64_t>();
  const auto size = r.get<std::uint64_t>();
  if (!r.ok() || size > r.remaining()) return damaged_journal();
  auto records = BucketFile::open(folder / records_name, state.subspan(r.position(), size));
  if (!records) return fail(records.error());
  auto ordinals = BucketFile::open(folder / ordinals_name, state.subspan(r.position() + size));
  if (!ordinals) return fail(ordinals.error());
  out.records_ = std::make_unique<BucketFile>(std::move(*records));
  out.ordinals_ = std::make_unique<BucketFile>(std::move(*ordinals));
  return out;
}

void MovedTriangles::remove(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : {records_name, ordinals_name}) std::filesystem::remove(folder / name, ignored);
}

Result<std::vector<std::byte>> MovedTriangles::apply(std::uint32_t chunk, std::vector<std::byte> records,
                                                     const SoupLayout& layout) const {
  if (!ordinals_) return records;
  const auto replaced = ordinals_->read(chunk);
  if (!replaced) return fail(replaced.error());
  auto ordinals = records_of<std::uint64_t>(*replaced);
  std::sort(ordinals.begin(), ordinals.end());
  remove_triangles(records, ordinals, layout);
  const auto moved = records_->read(chunk);
  if (!moved) return fail(moved.error());
  records.insert(records.end(), moved->begin(), moved->end());
  return records;
}

class BorderWelder {
 public:
  BorderWelder(const SoupChunks& chunks, double tolerance, MemoryBudget& memory,
               const std::filesystem::path& folder, const std::function<bool(std::uint64_t)>& progress)
      : chunks_(chunks),
        tolerance_(tolerance),
        memory_(memory),
        folder_(folder),
        progress_(progress),
        ranges_(chunks.box, chunks.triangles) {}

  Result<MovedTriangles> run() {
    auto out = MovedTriangles::create(folder_);
    if (!out || tolerance_ < 1) return out;
    out_ = std::move(*out);
    auto points = made(folder_ / points_name);
    if (!points) return fail(points.error());
    auto moves = made(folder_ / moves_name);
    if (!moves) return fail(moves.error());
    if (auto r = find(**points); !r) return fail(r.error());
    if (auto r = sweep(**points, **moves); !r) return fail(r.error());
    if (auto r = move(**moves); !r) return fail(r.error());
    std::error_code ignored;
    for (const char* name : {points_name, moves_name}) std::filesystem::remove(folder_ / name, ignored);
    return std::move(out_);
  }

 private:
  Result<void> report(std::uint64_t triangles) {
    const std::uint64_t done = done_ += triangles;
    if (progress_ && !progress_(done))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  template <class Work>
  Result<void> for_chunks(const char* what, Work work) {
    auto reserved = memory_.reserve_some(chunks_.chunk_bytes, arena_threads(), what);
    if (!reserved) return fail(reserved.error());
    return run_all(chunks_.tree.leaf_count(), reserved->second,
                   [&](std::uint64_t c) { return work(static_cast<std::uint32_t>(c)); });
  }

  Result<TriangleSoup> soup_of(std::uint32_t chunk) const {
    const auto records = chunks_.soup.read(chunk);
    if (!records) return fail(records.error());
    return decode_soup(*records, chunk, chunks_.layout);
  }

  Result<void> find(BucketFile& points) {
    return for_chunks("finding the borders of a chunk", [&](std::uint32_t c) -> Result<void> {
      auto soup = soup_of(c);
      if (!soup) return fail(soup.error());
      const std::size_t triangles = soup->size();
      BucketFile::Writer writer(points, buffer_bytes);  // a chunk meets few ranges
      for (const BorderPoint& p : border_points(std::move(*soup), chunks_.tree.leaf_box(c)))
        if (auto r = writer.append(ranges_.of(p.position), p); !r) return r;
      if (auto r = writer.flush(); !r) return r;
      return report(triangles);
    });
  }

  /// The most that a range and the sweep's window around it can hold.
  std::uint64_t most_sweep_bytes(const BucketFile& points) const {
    const auto reach = static_cast<std::uint32_t>(
        std::min<std::int64_t>(2 * BorderSweep::reach_of(tolerance_) / ranges_.width() + 1, ranges_.count()));
    std::uint64_t most = 0;
    for (std::uint32_t b = 0; b < points.bucket_count(); ++b) {
      std::uint64_t window = 0;
      for (std::uint32_t n = b - std::min(b, reach); n <= b; ++n) window += points.bytes(n);
      most = std::max(most, 2 * points.bytes(b) + sweep_bytes_per_byte * window);
    }
    return most;
  }

  Result<void> sweep(const BucketFile& points, BucketFile& moves) {
    const auto reserved = memory_.reserve(most_sweep_bytes(points) + move_buffers_bytes,
                                          "welding the borders within the tolerance");
    if (!reserved) return fail(reserved.error());
    BorderSweep sweep(tolerance_);
    const std::uint64_t share = move_buffers_bytes / chunks_.tree.leaf_count();
    const auto size = static_cast<std::uint32_t>(std::clamp<std::uint64_t>(share, 512, buffer_bytes));
    BucketFile::Writer writer(moves, size);
    std::deque<BorderPoint> waiting;
    std::optional<Vec3i> last;
    const auto pass_on = [&]() -> Result<void> {
      std::pair<Vec3i, Vec3i> settled;
      while (sweep.take(settled)) {
        ++out_.border_points;
        const bool is_moved = settled.first != settled.second;
        out_.points_welded += is_moved;
        for (; !waiting.empty() && waiting.front().position == settled.first; waiting.pop_front())
          if (is_moved)
            if (auto r = writer.append(waiting.front().chunk, Move{settled.first, settled.second}); !r)
              return r;
      }
      return {};
    };
    for (std::uint32_t b = 0; b < points.bucket_count(); ++b) {
      const auto bytes = points.read(b);
      if (!bytes) return fail(bytes.error());
      auto range = records_of<BorderPoint>(*bytes);
      std::sort(range.begin(), range.end(), is_before);
      for (const BorderPoint& p : range) {
        waiting.push_back(p);
        if (last == p.position) continue;
        last = p.position;
        sweep.add(p.position);
        if (auto r = pass_on(); !r) return r;
      }
      points.discard(b);
      if (auto r = report(0); !r) return r;
    }
    sweep.finish();
    if (auto r = pass_on(); !r) return r;
    return writer.flush();
  }

  Result<void> move(const BucketFile& moves) {
    return for_chunks("welding the borders of a chunk", [&](std::uint32_t c) -> Result<void> {
      if (moves.bytes(c) == 0) return {};
      const auto bytes = moves.read(c);
      if (!bytes) return fail(bytes.error());
      auto targets = records_of<Move>(*bytes);
      std::sort(targets.begin(), targets.end(), [](const Move& a, const Move& b) { return a.from < b.from; });
      const auto soup = soup_of(c);
      if (!soup) return fail(soup.error());
      BucketFile::Writer records(*out_.records_, buffer_bytes), ordinals(*out_.ordinals_, buffer_bytes);
      for (std::size_t i = 0; i < soup->size(); ++i)
        if (soup->owners[i] == c)
          if (auto r = move_triangle(*soup, i, targets, records, ordinals); !r) return r;
      if (auto r = records.flush(); !r) return r;
      if (auto r = ordinals.flush(); !r) return r;
      return report(0);
    });
  }

  Result<void> move_triangle(const TriangleSoup& soup, std::size_t i, std::span<const Move> targets,
                             BucketFile::Writer& records, BucketFile::Writer& ordinals) {
    SoupTriangle t = triangle_of(soup, i);
    const std::array<Vec3i, 3> before = t.positions;
    for (Vec3i& p : t.positions) {
      const auto at = std::lower_bound(targets.begin(), targets.end(), p,
                                       [](const Move& m, const Vec3i& q) { return m.from < q; });
      if (at != targets.end() && at->from == p) p = at->to;
    }
    if (t.positions == before) return {};
    const auto chunks = chunks_of(before, chunks_.tree);
    for (const std::uint32_t chunk : chunks.all())
      if (auto r = ordinals.append(chunk, t.ordinal); !r) return r;
    return put_in_chunks(t, chunks_.tree, chunks_.layout, records);
  }

  const SoupChunks& chunks_;
  double tolerance_;
  MemoryBudget& memory_;
  const std::filesystem::path& folder_;
  const std::function<bool(std::uint64_t)>& progress_;
  Ranges ranges_;
  MovedTriangles out_;
  std::atomic<std::uint64_t> done_{0};
};

Result<MovedTriangles> weld_borders(const SoupChunks& chunks, double tolerance, MemoryBudget& memory,
                                    const std::filesystem::path& folder,
                                    const std::function<bool(std::uint64_t triangles)>& progress) {
  return BorderWelder(chunks, tolerance, memory, folder, progress).run();
}

}  // namespace cuesta
