#include "hierarchy/scene_parts.h"

#include "hierarchy/cuesta_file.h"
#include "ooc/byte_arrays.h"
#include "ooc/fingerprint.h"

namespace cuesta {
namespace {

constexpr const char* parts_name = "parts";
constexpr const char* stage = "part";

/// What the journal keeps of a TOM, with where its blocks lie.
struct SegmentRecord {
  BlockRef block;
  std::uint32_t vertices = 0, triangles = 0;
  float error = 0;
  std::uint32_t zero = 0;  ///< in place of padding
};
static_assert(sizeof(SegmentRecord) == 40);

std::vector<std::byte> encode_record(const StoredPart& part) {
  ByteWriter w;
  w.put(part.entry.box);
  w.put(part.entry.vertices);
  w.put(part.entry.triangles);
  w.put(part.entry.attributes);
  std::vector<SegmentRecord> segments;
  for (const TomSegment& s : part.entry.segments)
    segments.push_back({s.block, s.vertices, s.triangles, s.error, 0});
  put_array(w, segments);
  w.put(part.clean);
  return w.take();
}

bool decode_record(std::span<const std::byte> bytes, StoredPart& part) {
  ByteReader r(bytes);
  part.entry.box = r.get<Box3d>();
  part.entry.vertices = r.get<std::uint64_t>();
  part.entry.triangles = r.get<std::uint64_t>();
  part.entry.attributes = r.get<AttributeSet>();
  std::vector<SegmentRecord> segments;
  if (!get_array(r, segments)) return false;
  for (const SegmentRecord& s : segments)
    part.entry.segments.push_back({s.block, s.vertices, s.triangles, s.error});
  part.clean = r.get<CleanReport>();
  return r.at_end();
}

}  // namespace

Result<SceneParts> SceneParts::open(WorkFolder& folder) {
  SceneParts parts(folder);
  const auto count = folder.journal().count(stage);
  if (!count) return fail(count.error());
  auto file = *count > 0 ? FileHandle::open(folder.path() / parts_name)
                         : FileHandle::create(folder.path() / parts_name);
  if (!file) return fail(file.error());
  parts.file_ = std::move(*file);
  for (std::uint64_t i = 0; i < *count; ++i) {
    const auto record = folder.journal().find(stage, i);
    if (!record) return fail(record.error());
    if (!*record) return damaged_journal();
    if (auto r = parts.adopt(**record); !r) return fail(r.error());
  }
  return parts;
}

Result<void> SceneParts::adopt(std::span<const std::byte> record) {
  StoredPart& part = toms_.emplace_back();
  if (!decode_record(record, part)) return damaged_journal();
  for (const TomSegment& s : part.entry.segments) end_ = std::max(end_, s.block.offset + s.block.bytes);
  return {};
}

Result<BlockRef> SceneParts::append(std::span<const std::byte> bytes) {
  const BlockRef block{end_, bytes.size(), checksum(bytes)};
  if (auto r = file_.write_at(end_, bytes); !r) return fail(r.error());
  end_ += bytes.size();
  return block;
}

Result<void> SceneParts::add_tom(const EncodedPart& part) {
  StoredPart stored{part.entry, part.clean};
  for (std::size_t i = 0; i < part.segments.size(); ++i) {
    const auto block = append(part.segments[i]);
    if (!block) return fail(block.error());
    stored.entry.segments[i].block = *block;
  }
  if (auto r = folder_->journal().record(stage, toms_.size(), encode_record(stored)); !r) return r;
  toms_.push_back(std::move(stored));
  return {};
}

std::filesystem::path SceneParts::surface_path(std::uint64_t i) const {
  return folder_->path() / ("surface-" + std::to_string(i) + ".cuesta");
}

Result<void> SceneParts::add_surface(const SurfacePartOptions& options, const InputReader& read,
                                     MemoryBudget& memory, const BuildProgress& progress) {
  const std::uint64_t number = surfaces_.size();
  const auto path = surface_path(number);
  const auto known = folder_->journal().find("surface", number);
  if (!known) return fail(known.error());
  CleanReport clean;
  if (*known) {
    ByteReader r(**known);
    clean = r.get<CleanReport>();
  } else {
    auto folder = WorkFolder::open(folder_->path() / ("surface-" + std::to_string(number)), "part");
    if (!folder) return fail(folder.error());
    auto surface = ingest(*folder, options.ingest, memory, read, progress);
    if (!surface) return fail(surface.error());
    const auto built = build_hierarchy(*surface, path, options.build, *folder, memory, progress);
    if (!built) return fail(built.error());
    clean = surface->report;
    ByteWriter w;
    w.put(clean);
    if (auto r = folder_->journal().record("surface", number, w.bytes()); !r) return r;
    folder->remove();
  }
  auto stored = store_surface(number);
  if (!stored) return fail(stored.error());
  stored->clean = clean;
  surfaces_.push_back(std::move(*stored));
  return {};
}

/// Directory and base page into the work file; the others stay where they are until the scene is written.
Result<StoredPart> SceneParts::store_surface(std::uint64_t i) {
  const auto file = CuestaFile::open(surface_path(i));
  if (!file) return fail(file.error());
  const auto container = ContainerReader::open(surface_path(i), ContainerKind::surface);
  if (!container) return fail(container.error());
  Directory d = file->directory();
  EmbeddedSurface surface;
  const auto base = container->read(d.pages.back().block);
  if (!base) return fail(base.error());
  d.pages.back().block.offset = 0;
  for (std::size_t p = d.pages.size() - 1; p-- > 0;) {
    BlockRef& block = d.pages[p].block;
    block.offset = container_aligned(surface.pages_bytes);
    surface.pages_bytes = block.offset + block.bytes;
  }
  const auto directory_block = append(encode_directory(d));
  if (!directory_block) return fail(directory_block.error());
  const auto base_block = append(*base);
  if (!base_block) return fail(base_block.error());
  surface.directory = *directory_block;
  surface.base = *base_block;
  StoredPart part;
  part.entry.box.add(d.grid.world(d.lo));
  part.entry.box.add(d.grid.world(d.hi));
  part.entry.vertices = d.vertices;
  part.entry.triangles = d.triangles;
  part.entry.attributes = {d.has_normals, d.has_colours, d.has_texcoords};
  part.entry.surface = surface;
  return part;
}

Result<std::vector<std::byte>> SceneParts::read(const BlockRef& block) const {
  std::vector<std::byte> bytes(block.bytes);
  if (auto r = file_.read_at(block.offset, bytes); !r) return fail(r.error());
  if (checksum(bytes) == block.checksum) return bytes;
  return fail(ErrorCode::corrupt, file_.path().string(), "byte " + std::to_string(block.offset),
              "a part does not match its checksum; run the same command again with --resume never");
}

}  // namespace cuesta
