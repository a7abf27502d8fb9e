#include "ooc/ingest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <system_error>
#include <type_traits>

#include "ooc/assemble_chunk.h"
#include "ooc/byte_arrays.h"
#include "ooc/check.h"
#include "ooc/distribute.h"
#include "ooc/fingerprint.h"
#include "ooc/ordered_tasks.h"
#include "ooc/space_tree.h"
#include "ooc/survey.h"
#include "ooc/weld_borders.h"

namespace cuesta {
namespace {

constexpr const char* soup_name = "soup";
constexpr const char* chunks_name = "chunks";

/// What is kept of the first stage when its files are gone.
struct ReadState {
  RawCounts counts;
  Survey survey;
  std::vector<ReadReport> inputs;
};

std::vector<std::byte> encode(const RawSurface& raw, const ReadState& state) {
  static_assert(std::is_trivially_copyable_v<ReadReport> && std::is_trivially_copyable_v<RawCounts>);
  ByteWriter w;
  w.put(state.counts);
  w.put(state.survey.grid);
  w.put(state.survey.box);
  put_array(w, state.survey.samples);
  w.put(state.survey.nonfinite_vertices);
  w.put(state.survey.unused_vertices);
  w.put(state.survey.used_vertices);
  put_array(w, state.inputs);
  w.put_bytes(raw.encode());
  return w.take();
}

/// @param files  set to where the state of the files begins
Result<ReadState> decode_read(std::span<const std::byte> bytes, std::size_t& files) {
  ReadState s;
  ByteReader r(bytes);
  s.counts = r.get<RawCounts>();
  s.survey.grid = r.get<Grid>();
  s.survey.box = r.get<Box3<std::int32_t>>();
  bool good = get_array(r, s.survey.samples);
  s.survey.nonfinite_vertices = r.get<std::uint64_t>();
  s.survey.unused_vertices = r.get<std::uint64_t>();
  s.survey.used_vertices = r.get<std::uint64_t>();
  good = good && get_array(r, s.inputs);
  files = r.position();
  if (!good || !r.ok()) return damaged_journal();
  return s;
}

/// A chunk's task as the journal knows it.
struct ChunkRecord {
  std::uint64_t offset = 0, bytes = 0, checksum = 0;
  std::uint64_t triangles = 0, vertices = 0, vertices_used = 0;
  Box3<std::int32_t> box;
  CleanReport report;
};
struct LetterRecord {
  std::uint32_t to = 0, corners = 0;
  std::uint64_t checksum = 0;
};

}  // namespace

/// The stages; each is skipped if the journal knows its result.
class Ingest {
 public:
  Ingest(WorkFolder& folder, const IngestOptions& options, MemoryBudget& memory,
         const BuildProgress& progress)
      : folder_(folder), options_(options), memory_(memory), progress_(progress) {}

  Result<IngestedSurface> run(const InputReader& read) {
    if (!(options_.weld_tolerance >= 0) || !std::isfinite(options_.weld_tolerance))
      return fail(ErrorCode::invalid_input, "", "", "the weld tolerance must be a number from 0 on");
    if (auto r = read_stage(read); !r) return fail(r.error());
    if (auto r = check_tolerance(); !r) return fail(r.error());
    if (auto r = distribute_stage(); !r) return fail(r.error());
    if (auto r = weld_stage(); !r) return fail(r.error());
    if (auto r = clean_stage(); !r) return fail(r.error());
    return finish();
  }

 private:
  Result<void> report(std::string_view stage, std::uint64_t done, std::uint64_t total) {
    const std::lock_guard lock(progress_mutex_);
    if (progress_ && !progress_(stage, done, total))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  Result<void> read_stage(const InputReader& read) {
    auto known = folder_.journal().find("read", 0);
    if (!known) return fail(known.error());
    if (!*known) {
      const std::uint64_t block = options_.block_vertices > 0
                                      ? options_.block_vertices
                                      : memory_.limit_bytes() * 2 / 5 / raw_vertex_bytes + 1;
      auto raw = RawSurface::create(folder_.path(), block);
      if (!raw) return fail(raw.error());
      auto inputs = read(*raw);
      if (!inputs) return fail(inputs.error());
      if (auto r = raw->finish(); !r) return r;
      if (auto r = check_disk(raw->counts()); !r) return r;
      auto surveyed = survey(*raw, options_.step);
      if (!surveyed) return fail(surveyed.error());
      const ReadState state{raw->counts(), std::move(*surveyed), std::move(*inputs)};
      *known = encode(*raw, state);
      if (auto r = folder_.journal().record("read", 0, **known); !r) return r;
    }
    read_bytes_ = std::move(**known);
    auto state = decode_read(read_bytes_, read_files_);
    if (!state) return fail(state.error());
    read_ = std::move(*state);
    layout_.attributes = read_.counts.attributes;
    layout_.area_normals = options_.make_normals && read_.counts.has_missing_normals;
    const std::uint64_t chunks =
        (read_.counts.triangles + options_.chunk_triangles - 1) / options_.chunk_triangles;
    if (chunks > 0xFFFFFF)
      return fail(ErrorCode::invalid_input, "", "", "more triangles than a build can have");
    tree_ = std::make_unique<SpaceTree>(read_.survey.samples,
                                        std::max(1u, static_cast<std::uint32_t>(chunks)), identity_axes);
    return {};
  }

  Result<void> check_disk(const RawCounts& counts) const {
    // The soup beside what was read; then chunks, survivors and the file itself in its place.
    const std::uint64_t bytes = counts.triangles * (layout_of(counts).typical_record_bytes() + 8);
    return folder_.check_room(bytes, "the rest of this build");
  }
  SoupLayout layout_of(const RawCounts& counts) const {
    return {counts.attributes, options_.make_normals && counts.has_missing_normals};
  }

  /// More than the width of any crack would pull the surface together, and hold much of it in the sweep.
  Result<void> check_tolerance() const {
    const Box3<std::int32_t>& box = read_.survey.box;
    if (options_.weld_tolerance == 0 || box.empty()) return {};
    const Vec3d size = (vec_cast<double>(box.hi) - vec_cast<double>(box.lo)) * read_.survey.grid.step;
    const double most = std::max({size.x, size.y, size.z}) * kMostWeldPart;
    if (options_.weld_tolerance <= most) return {};
    return fail(
        ErrorCode::invalid_input, "", "",
        fmt::format("a weld tolerance of {} is too large for this surface, {} at most: give a little more "
                    "than the width of the cracks",
                    options_.weld_tolerance, most));
  }

  Result<void> distribute_stage() {
    auto known = folder_.journal().find("distribute", 0);
    if (!known) return fail(known.error());
    if (!*known) {
      auto raw = RawSurface::open(folder_.path(), std::span(read_bytes_).subspan(read_files_));
      if (!raw) return fail(raw.error());
      auto soup = BucketFile::create(folder_.path() / soup_name);
      if (!soup) return fail(soup.error());
      const auto nonfinite = distribute(
          *raw, read_.survey.grid, *tree_, layout_, memory_, folder_.path(), *soup,
          [&](std::uint64_t done) { return report("sort", done, read_.counts.triangles).has_value(); });
      if (!nonfinite) return fail(nonfinite.error());
      ByteWriter w;
      w.put(*nonfinite);
      w.put_bytes(soup->encode_index());
      *known = w.take();
      if (auto r = folder_.journal().record("distribute", 0, **known); !r) return r;
    }
    RawSurface::remove(folder_.path());
    read_bytes_ = {};
    ByteReader r(**known);
    nonfinite_faces_ = r.get<std::uint64_t>();
    soup_index_.assign((*known)->begin() + static_cast<std::ptrdiff_t>(r.position()), (*known)->end());
    return {};
  }

  Result<void> weld_stage() {
    if (options_.weld_tolerance == 0) return {};
    auto known = folder_.journal().find("weld", 0);
    if (!known) return fail(known.error());
    if (!*known) {
      auto soup = BucketFile::open(folder_.path() / soup_name, soup_index_);
      if (!soup) return fail(soup.error());
      const SoupChunks chunks{
          *soup, *tree_, layout_, read_.survey.box, read_.counts.triangles, bytes_of_largest(*soup)};
      const auto moved = weld_borders(
          chunks, options_.weld_tolerance / read_.survey.grid.step, memory_, folder_.path(),
          [&](std::uint64_t done) { return report("weld", done, read_.counts.triangles).has_value(); });
      if (!moved) return fail(moved.error());
      *known = moved->encode();
      if (auto r = folder_.journal().record("weld", 0, **known); !r) return r;
    }
    moved_index_ = std::move(**known);
    return {};
  }

  /// What cleaning the largest chunk takes: records, the soup that they become, and what is made of it.
  std::uint64_t bytes_of_largest(const BucketFile& soup, const MovedTriangles& moved = {}) const {
    std::uint64_t largest = 0;
    for (std::uint32_t c = 0; c < tree_->leaf_count(); ++c)
      largest = std::max(largest, soup.bytes(c) + moved.bytes(c));
    return largest * 3 + largest / layout_.typical_record_bytes() * 270;
  }

  Result<void> clean_stage() {
    const std::uint32_t chunks = tree_->leaf_count();
    const auto finished = folder_.journal().count("clean");
    if (!finished) return fail(finished.error());
    const std::filesystem::path path = folder_.path() / chunks_name;
    auto file = *finished > 0 ? FileHandle::open(path) : FileHandle::create(path);
    if (!file) return fail(file.error());
    out_.file_ = std::make_unique<FileHandle>(std::move(*file));
    out_.chunks_.resize(chunks);
    for (std::uint32_t c = 0; c < *finished; ++c) {
      auto record = folder_.journal().find("clean", c);
      if (!record) return fail(record.error());
      if (!*record || !adopt(c, **record)) return damaged_journal();
    }
    if (!moved_index_.empty()) {
      ByteReader r(moved_index_);
      out_.report.border_points = r.get<std::uint64_t>();
      out_.report.border_points_welded = r.get<std::uint64_t>();
    }
    if (*finished == chunks) return {};
    MovedTriangles moved;
    if (!moved_index_.empty()) {
      auto opened = MovedTriangles::open(folder_.path(), moved_index_);
      if (!opened) return fail(opened.error());
      moved = std::move(*opened);
    }
    auto soup = BucketFile::open(folder_.path() / soup_name, soup_index_);
    if (!soup) return fail(soup.error());
    auto reserved = memory_.reserve_some(bytes_of_largest(*soup, moved), arena_threads() + 1,
                                         "cleaning a chunk of the surface");
    if (!reserved) return fail(reserved.error());
    auto done = run_in_order<CleanedChunk>(
        *finished, chunks, reserved->second,
        [&](std::uint64_t c) -> Result<CleanedChunk> {
          const auto chunk = static_cast<std::uint32_t>(c);
          auto records = soup->read(chunk);
          if (records) records = moved.apply(chunk, std::move(*records), layout_);
          if (!records) return fail(records.error());
          TriangleSoup triangles = decode_soup(*records, chunk, layout_);
          *records = {};
          return clean_chunk(triangles, chunk, tree_->leaf_box(chunk), layout_.area_normals);
        },
        [&](std::uint64_t c, CleanedChunk cleaned) -> Result<void> {
          if (auto r = keep(static_cast<std::uint32_t>(c), cleaned); !r) return r;
          soup->discard(static_cast<std::uint32_t>(c));
          return report("clean", out_.triangles, read_.counts.triangles);
        });
    if (!done) return done;
    std::error_code ignored;
    std::filesystem::remove(folder_.path() / soup_name, ignored);
    MovedTriangles::remove(folder_.path());
    return {};
  }

  /// Writes a chunk and its letters, then records that it is done.
  Result<void> keep(std::uint32_t c, const CleanedChunk& cleaned) {
    ChunkRecord record;
    record.offset = end_;
    const auto chunk_bytes = encode_chunk(cleaned.chunk);
    record.bytes = chunk_bytes.size();
    record.checksum = checksum(chunk_bytes);
    record.triangles = cleaned.chunk.triangles.size();
    record.vertices = cleaned.chunk.vertices.size();
    record.vertices_used = cleaned.vertices_used;
    for (const Vec3i& p : cleaned.chunk.vertices.positions) record.box.add(p);
    record.report = cleaned.report;
    ByteWriter letters;
    std::vector<LetterRecord> letter_records;
    for (const ChunkReplies& r : cleaned.replies) {
      const auto letter = std::as_bytes(std::span(r.corners));
      letters.put_bytes(letter);
      letter_records.push_back({r.chunk, static_cast<std::uint32_t>(r.corners.size()), checksum(letter)});
    }
    if (auto r = out_.file_->write_at(end_, chunk_bytes); !r) return r;
    if (auto r = out_.file_->write_at(end_ + record.bytes, letters.bytes()); !r) return r;
    ByteWriter w;
    w.put(record);
    put_array(w, letter_records);
    if (auto r = folder_.journal().record("clean", c, w.bytes()); !r) return r;
    CUESTA_CHECK(adopt(c, w.bytes()));
    return {};
  }

  /// Takes over what a finished task has written. False if that is not what it has recorded.
  bool adopt(std::uint32_t c, std::span<const std::byte> bytes) {
    ByteReader r(bytes);
    const auto record = r.get<ChunkRecord>();
    std::vector<LetterRecord> letters;
    if (!get_array(r, letters) || !r.at_end()) return false;
    out_.chunks_[c].part = {record.offset, record.bytes, record.checksum};
    out_.chunks_[c].triangles = record.triangles;
    out_.triangles += record.triangles;
    out_.vertices += record.vertices;
    out_.box.add(record.box);
    out_.report.add(record.report);
    vertices_used_ += record.vertices_used;
    end_ = record.offset + record.bytes;
    for (const LetterRecord& l : letters) {
      if (l.to >= out_.chunks_.size()) return false;
      const std::uint64_t size = l.corners * sizeof(CornerReply);
      out_.chunks_[l.to].letters.push_back({c, {end_, size, l.checksum}});
      end_ += size;
    }
    return true;
  }

  Result<IngestedSurface> finish() {
    if (out_.triangles == 0)
      return fail(ErrorCode::invalid_input, "", "", "no triangle is left after cleaning");
    out_.grid = read_.survey.grid;
    out_.attributes = read_.counts.attributes;
    out_.attributes.normals |= layout_.area_normals;
    out_.inputs = std::move(read_.inputs);
    out_.missing = read_.counts.missing;
    out_.report.nonfinite_vertices = read_.survey.nonfinite_vertices;
    out_.report.faces_nonfinite = read_.counts.nonfinite_faces + nonfinite_faces_;
    out_.report.vertices_unused += read_.survey.unused_vertices;
    out_.report.vertices_welded =
        read_.survey.used_vertices - std::min(read_.survey.used_vertices, vertices_used_);
    return std::move(out_);
  }

  WorkFolder& folder_;
  const IngestOptions& options_;
  MemoryBudget& memory_;
  const BuildProgress& progress_;
  std::mutex progress_mutex_;

  std::vector<std::byte> read_bytes_;
  std::size_t read_files_ = 0;
  ReadState read_;
  SoupLayout layout_;
  std::unique_ptr<SpaceTree> tree_;
  std::vector<std::byte> soup_index_, moved_index_;
  std::uint64_t nonfinite_faces_ = 0, vertices_used_ = 0, end_ = 0;
  IngestedSurface out_;
};

Result<void> IngestedSurface::read(const Part& part, std::span<std::byte> bytes) const {
  if (auto r = file_->read_at(part.offset, bytes); !r) return r;
  if (checksum(bytes) == part.checksum) return {};
  return fail(ErrorCode::corrupt, file_->path().string(), "byte " + std::to_string(part.offset),
              "a part of the surface does not match its checksum; run the same command again to start over");
}

Result<SurfaceChunk> IngestedSurface::chunk(std::uint32_t c) const {
  const Part& part = chunks_[c].part;
  std::vector<std::byte> bytes(part.bytes);
  if (auto r = read(part, bytes); !r) return fail(r.error());
  auto clean = decode_chunk(bytes);
  if (!clean) return fail(clean.error());
  auto replies = replies_to(c);
  if (!replies) return fail(replies.error());
  return assemble_chunk(c, std::move(*clean), *replies);
}

Result<std::vector<ChunkReplies>> IngestedSurface::replies_to(std::uint32_t c) const {
  std::vector<ChunkReplies> out;
  for (const Letter& letter : chunks_[c].letters) {
    ChunkReplies& replies = out.emplace_back();
    replies.chunk = letter.from;
    replies.corners.resize(letter.part.bytes / sizeof(CornerReply));
    if (auto r = read(letter.part, std::as_writable_bytes(std::span(replies.corners))); !r)
      return fail(r.error());
  }
  return out;
}

void IngestedSurface::prefetch(std::uint32_t c) const {
  file_->prefetch(chunks_[c].part.offset, chunks_[c].part.bytes);
}

void IngestedSurface::discard(std::uint32_t c) const {
  file_->discard(chunks_[c].part.offset, chunks_[c].part.bytes);
}

Result<IngestedSurface> ingest(WorkFolder& folder, const IngestOptions& options, MemoryBudget& memory,
                               const InputReader& read, const BuildProgress& progress) {
  return Ingest(folder, options, memory, progress).run(read);
}

}  // namespace cuesta
