#include "hierarchy/build_hierarchy.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <system_error>

#include "hierarchy/bounding_sphere.h"
#include "hierarchy/directory.h"
#include "hierarchy/input_chunk.h"
#include "hierarchy/round_journal.h"
#include "ooc/check.h"
#include "ooc/fingerprint.h"
#include "ooc/ordered_tasks.h"

namespace cuesta {
namespace {

/// Cells keep positions as floats about their own corner: exact up to this extent.
constexpr std::int64_t largest_extent = 1 << 24;
/// Rounds that may pass without losing a tenth of the triangles.
constexpr std::uint32_t patience = 2;
/// Chunks of later rounds hold about this much of the survivors, and as many triangles at most as an input
/// chunk: with many samples a triangle takes hundreds of bytes.
constexpr std::uint64_t chunk_survivor_bytes = std::uint64_t{32} << 20;
constexpr std::uint64_t chunk_triangles = std::uint64_t{1} << 18;
/// Memory of a cell while it is simplified and encoded, and of a triangle of an input chunk. Measured.
constexpr std::uint64_t cell_bytes_per_triangle = 700;
constexpr std::uint64_t input_bytes_per_triangle = 180;

std::string extent_problem(const Box3<std::int32_t>& box) {
  const Vec3<std::int64_t> e = vec_cast<std::int64_t>(box.hi) - vec_cast<std::int64_t>(box.lo);
  if (std::max({e.x, e.y, e.z}) < largest_extent) return "";
  return "the surface is " + std::to_string(std::max({e.x, e.y, e.z})) +
         " grid steps wide, at most 2^24 are possible; give a larger --step";
}

/// A page of the round before, as the next round knows it.
struct SurvivingPage {
  PageId page = 0;
  std::uint64_t offset = 0, bytes = 0, checksum = 0;
  std::uint32_t triangles = 0;
  Box3<float> box;
  std::vector<Vec3f> centres;
};

/// The surface at the start of a round, on disk.
struct RoundState {
  std::uint32_t round = 0;
  std::uint64_t triangles = 0;
  std::unique_ptr<FileHandle> file;  ///< null in round 0
  std::vector<SurvivingPage> pages;
};

/// How a round is cut into chunks.
struct RoundPlan {
  bool base = false;
  std::uint32_t chunks = 0;
  std::optional<SpaceTree> tree;                  ///< not in round 0
  std::vector<std::vector<std::uint32_t>> pages;  ///< per chunk: those of the state with a vertex in it
  std::uint64_t largest_bytes = 0;                ///< memory of the largest chunk
};

struct ChunkOutput {
  std::vector<CellOutput> cells;
};

bool overlap(const Box3<float>& a, const Box3<float>& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

std::string stage_of(std::uint32_t round) {
  return "round " + std::to_string(round);
}

class HierarchyBuilder {
 public:
  HierarchyBuilder(const InputSurface& surface, const BuildOptions& options, WorkFolder& folder,
                   MemoryBudget& memory, const BuildProgress& progress)
      : surface_(surface), options_(options), folder_(folder), memory_(memory), progress_(progress) {}

  Result<BuildReport> run(const std::filesystem::path& path) {
    if (auto r = open_container(path); !r) return fail(r.error());
    RoundState state;
    state.triangles = surface_.triangles;
    std::uint32_t rounds_without_progress = 0;
    for (bool base = false; !base;) {
      if (rounds_without_progress > 2 * patience)
        return fail(ErrorCode::invalid_input, "", stage_of(state.round),
                    std::to_string(state.triangles) +
                        " triangles cannot be simplified any further: more than fit a base page");
      // A surface that no longer gets smaller (thousands of knots, say) becomes a large base page.
      base = is_one_chunk(state) &&
             (state.triangles <= options_.cell_triangles ||
              (rounds_without_progress >= patience && state.triangles <= max_page_elements / 4));
      auto next = run_round(state, plan(state, base));
      if (!next) return fail(next.error());
      rounds_without_progress = next->triangles <= state.triangles / 10 * 9 ? 0 : rounds_without_progress + 1;
      remove_survivors(state);
      state = std::move(*next);
      ++report_.rounds;
    }
    if (auto r = finish(); !r) return fail(r.error());
    return report_;
  }

 private:
  /// Whether a round can be one cell: what was read may be many chunks even if little of it is left.
  bool is_one_chunk(const RoundState& state) const { return state.round > 0 || surface_.chunk_count() == 1; }
  std::filesystem::path survivors_path(std::uint32_t round) const {
    return folder_.path() / ("survivors." + std::to_string(round));
  }
  void remove_survivors(const RoundState& state) const {
    std::error_code ignored;
    std::filesystem::remove(survivors_path(state.round), ignored);
  }

  /// Goes on with the unfinished file of an earlier run, or makes a new one.
  Result<void> open_container(const std::filesystem::path& path) {
    std::uint64_t end = 0;
    std::uint32_t rounds = 0;
    for (;; ++rounds) {
      const auto count = folder_.journal().count(stage_of(rounds));
      if (!count) return fail(count.error());
      if (*count == 0) break;
      const auto last = read_record(rounds, *count - 1);
      if (!last) return fail(last.error());
      end = last->container_end;
    }
    // Chunks that were used are gone, so without the part there is nothing to go on from.
    auto writer = end > 0 ? ContainerWriter::resume(path, end) : ContainerWriter::create(path);
    if (!writer) {
      Error error = writer.error();
      if (end > 0) error.message += "; run the same command again to start over";
      return fail(error);
    }
    writer_.emplace(std::move(*writer));
    writer_->keep_part();
    return {};
  }

  Result<ChunkRoundRecord> read_record(std::uint32_t round, std::uint64_t chunk) {
    auto bytes = folder_.journal().find(stage_of(round), chunk);
    if (!bytes) return fail(bytes.error());
    return decode_record(*bytes ? std::span<const std::byte>(**bytes) : std::span<const std::byte>());
  }

  RoundPlan plan(const RoundState& state, bool base) const {
    RoundPlan plan;
    plan.base = base;
    if (state.round == 0) {
      plan.chunks = surface_.chunk_count();
      std::uint64_t largest = 0;
      for (std::uint32_t c = 0; c < plan.chunks; ++c) largest = std::max(largest, surface_.triangles_of(c));
      plan.largest_bytes =
          largest * (input_bytes_per_triangle + (base ? cell_bytes_per_triangle : std::uint64_t{0}));
      return plan;
    }
    std::vector<Vec3f> centres;
    std::uint64_t bytes = 0;
    for (const SurvivingPage& p : state.pages) {
      centres.insert(centres.end(), p.centres.begin(), p.centres.end());
      bytes += p.bytes;
    }
    const std::uint64_t leaves =
        base ? 1 : std::max(state.triangles / chunk_triangles, bytes / chunk_survivor_bytes) + 1;
    plan.tree.emplace(std::move(centres), static_cast<std::uint32_t>(leaves), axes_of(state.round));
    plan.chunks = plan.tree->leaf_count();
    plan.pages.resize(plan.chunks);
    for (std::uint32_t c = 0; c < plan.chunks; ++c) {
      std::uint64_t chunk_bytes = 0;
      for (std::uint32_t i = 0; i < state.pages.size(); ++i) {
        if (!overlap(state.pages[i].box, plan.tree->leaf_box(c))) continue;
        plan.pages[c].push_back(i);
        chunk_bytes += state.pages[i].bytes;
      }
      plan.largest_bytes = std::max(plan.largest_bytes, chunk_bytes * 2);
    }
    if (base) plan.largest_bytes += state.triangles * cell_bytes_per_triangle;
    return plan;
  }

  Result<RoundState> run_round(const RoundState& state, const RoundPlan& plan) {
    RoundState next;
    next.round = state.round + 1;
    triangles_in_round_ = 0;
    const auto finished = folder_.journal().count(stage_of(state.round));
    if (!finished) return fail(finished.error());
    std::uint64_t end = 0;
    for (std::uint64_t c = 0; c < *finished; ++c) {
      const auto record = read_record(state.round, c);
      if (!record) return fail(record.error());
      if (!fits(*record)) return damaged_journal(stage_of(state.round));
      adopt(*record, next);
      end = record->survivors_end;
    }
    const auto path = survivors_path(next.round);
    auto file = *finished > 0 ? FileHandle::open(path) : FileHandle::create(path);
    // An earlier run has removed them if it finished the next round too.
    const bool gone = !file && file.error().code == ErrorCode::not_found && *finished == plan.chunks;
    if (!file && !gone) return fail(file.error());
    if (!gone) next.file = std::make_unique<FileHandle>(std::move(*file));

    // As many cells at a time as fit, on as many threads.
    const std::uint64_t cell_bytes = plan.base ? 0 : options_.cell_triangles * cell_bytes_per_triangle;
    auto for_cells = memory_.reserve_some(cell_bytes, arena_threads(), "simplifying a cell");
    if (!for_cells) return fail(for_cells.error());
    auto for_chunks = memory_.reserve_some(plan.largest_bytes, for_cells->second + 1, "a chunk of a round");
    if (!for_chunks) return fail(for_chunks.error());
    tbb::task_arena arena(static_cast<int>(for_cells->second));
    const Result<void> done = arena.execute([&] {
      return run_in_order<ChunkOutput>(
          *finished, plan.chunks, for_chunks->second,
          [&](std::uint64_t c) { return run_chunk(state, plan, static_cast<std::uint32_t>(c)); },
          [&](std::uint64_t c, ChunkOutput out) -> Result<void> {
            if (auto r = keep(c, std::move(out), end, state, next); !r) return r;
            if (state.round == 0) surface_.discard(static_cast<std::uint32_t>(c));
            return report_progress(state.round);
          });
    });
    if (!done) return fail(done.error());
    if (triangles_in_round_ != state.triangles)
      return fail(ErrorCode::corrupt, folder_.path().string(), stage_of(state.round),
                  "expected " + std::to_string(state.triangles) + " triangles in its cells, found " +
                      std::to_string(triangles_in_round_) + "; run the same command again to start over");
    return next;
  }

  /// The pure part of a chunk's work: everything but writing.
  Result<ChunkOutput> run_chunk(const RoundState& state, const RoundPlan& plan, std::uint32_t c) const {
    RoundChunk chunk;
    Partition partition;
    if (state.round == 0) {
      if (c + 1 < plan.chunks) surface_.prefetch(c + 1);
      const std::uint32_t cell =
          plan.base ? std::max(1u, static_cast<std::uint32_t>(state.triangles)) : options_.cell_triangles;
      auto input = load_input_chunk(surface_, c, cell);
      if (!input) return fail(input.error());
      chunk = std::move(input->chunk);
      partition = std::move(input->cells);
    } else {
      if (!state.file)
        return fail(ErrorCode::corrupt, survivors_path(state.round).string(), "",
                    "the survivors of a round are gone; run the same command again to start over");
      ChunkCollector collector(*plan.tree, c);
      for (const std::uint32_t i : plan.pages[c]) {
        const SurvivingPage& page = state.pages[i];
        std::vector<std::byte> bytes(page.bytes);
        if (auto r = state.file->read_at(page.offset, bytes); !r) return fail(r.error());
        if (checksum(bytes) != page.checksum)
          return fail(ErrorCode::corrupt, survivors_path(state.round).string(),
                      "byte " + std::to_string(page.offset),
                      "survivors do not match their checksum; run the same command again to start over");
        auto survivors = decode_survivors(bytes);
        if (!survivors) return fail(survivors.error());
        collector.add(page.page, std::move(*survivors));
      }
      chunk = collector.take();
      const auto all = static_cast<std::uint32_t>(chunk.triangles.size());
      partition = partition_cells(triangle_centres(chunk.triangles, chunk.vertices.positions),
                                  plan.base ? std::max(1u, all) : options_.cell_triangles, state.round);
    }
    const RoundCells cells(chunk, std::move(partition));
    ChunkOutput out;
    out.cells.resize(cells.cell_count());
    const CellOptions options{state.round, plan.base, options_.round_reduction, options_.cache};
    const auto done = run_all(cells.cell_count(), arena_threads(), [&](std::uint64_t i) -> Result<void> {
      auto cell = run_cell_task(cells.cell(static_cast<std::uint32_t>(i)), chunk, surface_, options);
      if (!cell) return fail(std::move(cell).error());
      out.cells[i] = std::move(*cell);
      return {};
    });
    if (!done) return fail(done.error());
    return out;
  }

  /// Writes what a chunk gave, then records that it is done.
  Result<void> keep(std::uint64_t c, ChunkOutput out, std::uint64_t& end, const RoundState& state,
                    RoundState& next) {
    ChunkRoundRecord record;
    for (CellOutput& cell : out.cells) {
      auto ref = writer_->append(cell.page);
      if (!ref) return fail(ref.error());
      cell.facts.entry.block = *ref;
      if (auto r = next.file->write_at(end, cell.survivors); !r) return r;
      record.cells.push_back({std::move(cell.facts), end, cell.survivors.size(), checksum(cell.survivors)});
      end += cell.survivors.size();
      cell = {};
    }
    record.container_end = writer_->bytes_written();
    record.survivors_end = end;
    if (auto r = folder_.journal().record(stage_of(state.round), c, encode_record(record)); !r) return r;
    adopt(record, next);
    return {};
  }

  /// Whether a record of an earlier run names only pages that there are.
  bool fits(const ChunkRoundRecord& record) const {
    const auto is_known = [this](PageId source) { return source < directory_.pages.size(); };
    return std::all_of(record.cells.begin(), record.cells.end(), [&](const CellRecord& cell) {
      return std::all_of(cell.facts.sources.begin(), cell.facts.sources.end(), is_known);
    });
  }

  /// Takes over a chunk that is done, in this run or in an earlier one.
  void adopt(const ChunkRoundRecord& record, RoundState& next) {
    for (const CellRecord& cell : record.cells) {
      const CellFacts& facts = cell.facts;
      const auto page = static_cast<PageId>(directory_.pages.size());
      directory_.pages.push_back(facts.entry);
      // A page's coarser pages are those that name it as a source.
      for (PageId source : facts.sources) directory_.pages[source].coarser.push_back(page);
      done_ += facts.entry.owned_triangles;
      triangles_in_round_ += facts.entry.triangles;
      report_.fans += facts.fans;
      report_.substitutions += facts.substitutions;
      for (std::size_t s = 0; s < page_stream_count; ++s) report_.stream_bytes[s] += facts.stream_bytes[s];
      next.triangles += facts.survivor_triangles;
      next.pages.push_back({page, cell.survivors_offset, cell.survivors_bytes, cell.survivors_checksum,
                            facts.survivor_triangles, facts.survivor_box, facts.centres});
    }
  }

  Result<void> report_progress(std::uint32_t round) {
    if (progress_ && !progress_(stage_of(round), done_, surface_.triangles))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  /// A page is never wanted without the pages it leans on: their error and bound cover its own.
  void saturate_pages() {
    std::vector<std::vector<Sphere>> balls(directory_.pages.size());
    for (PageId id = 0; id < directory_.pages.size(); ++id) {
      PageEntry& e = directory_.pages[id];
      if (!balls[id].empty()) {
        balls[id].push_back(e.bound);
        const Vec3i at = vec_cast<std::int32_t>(e.bound.centre);
        e.bound = decode_sphere(enclose(balls[id], at), at);
      }
      for (PageId c : e.coarser) {
        PageEntry& coarser = directory_.pages[c];
        coarser.largest_error = std::max(coarser.largest_error, e.largest_error);
        balls[c].push_back(e.bound);
      }
    }
  }

  Result<void> finish() {
    saturate_pages();
    directory_.grid = surface_.grid;
    directory_.lo = surface_.box.lo;
    directory_.hi = surface_.box.hi;
    directory_.vertices = surface_.vertices;
    directory_.triangles = surface_.triangles;
    directory_.has_normals = surface_.attributes.normals;
    directory_.has_colours = surface_.attributes.colours;
    directory_.has_texcoords = surface_.attributes.texcoords;
    directory_.vertical = surface_.vertical;
    directory_.metadata = options_.metadata;
    const auto bytes = encode_directory(directory_);
    if (auto r = writer_->finish(bytes); !r) return r;
    report_.pages = static_cast<std::uint32_t>(directory_.pages.size());
    report_.file_bytes = writer_->bytes_written();
    return {};
  }

  const InputSurface& surface_;
  const BuildOptions& options_;
  WorkFolder& folder_;
  MemoryBudget& memory_;
  const BuildProgress& progress_;
  std::optional<ContainerWriter> writer_;
  Directory directory_;
  BuildReport report_;
  std::uint64_t done_ = 0;
  std::uint64_t triangles_in_round_ = 0;
};

}  // namespace

Result<BuildReport> build_hierarchy(const InputSurface& surface, const std::filesystem::path& path,
                                    const BuildOptions& options, WorkFolder& folder, MemoryBudget& memory,
                                    const BuildProgress& progress) {
  CUESTA_CHECK(surface.triangles > 0);
  CUESTA_CHECK(options.round_reduction > 1, options.round_reduction);
  if (auto problem = extent_problem(surface.box); !problem.empty())
    return fail(ErrorCode::invalid_input, path.string(), "", std::move(problem));
  return HierarchyBuilder(surface, options, folder, memory, progress).run(path);
}

}  // namespace cuesta
