#include "hierarchy/round_journal.h"

#include "ooc/byte_arrays.h"
#include "ooc/journal.h"

namespace cuesta {

std::vector<std::byte> encode_record(const ChunkRoundRecord& record) {
  ByteWriter w;
  w.put(record.container_end);
  w.put(record.survivors_end);
  w.put_varint(record.cells.size());
  for (const CellRecord& cell : record.cells) {
    put_page_entry(w, cell.facts.entry);
    put_array(w, cell.facts.sources);
    w.put(cell.facts.fans);
    w.put(cell.facts.substitutions);
    w.put(cell.facts.stream_bytes);
    w.put(cell.facts.survivor_triangles);
    w.put(cell.facts.survivor_box);
    put_array(w, cell.facts.centres);
    w.put(cell.survivors_offset);
    w.put(cell.survivors_bytes);
    w.put(cell.survivors_checksum);
  }
  return w.take();
}

Result<ChunkRoundRecord> decode_record(std::span<const std::byte> bytes) {
  ChunkRoundRecord record;
  ByteReader r(bytes);
  record.container_end = r.get<std::uint64_t>();
  record.survivors_end = r.get<std::uint64_t>();
  const std::uint64_t cells = r.get_varint();
  bool good = r.ok() && cells <= r.remaining();
  for (std::uint64_t c = 0; good && c < cells; ++c) {
    CellRecord& cell = record.cells.emplace_back();
    good = get_page_entry(r, 0, cell.facts.entry) && get_array(r, cell.facts.sources);
    cell.facts.fans = r.get<std::uint64_t>();
    cell.facts.substitutions = r.get<std::uint64_t>();
    cell.facts.stream_bytes = r.get<PageStreamBytes>();
    cell.facts.survivor_triangles = r.get<std::uint32_t>();
    cell.facts.survivor_box = r.get<Box3<float>>();
    good = good && get_array(r, cell.facts.centres);
    cell.survivors_offset = r.get<std::uint64_t>();
    cell.survivors_bytes = r.get<std::uint64_t>();
    cell.survivors_checksum = r.get<std::uint64_t>();
  }
  if (!good || !r.at_end()) return damaged_journal();
  return record;
}

}  // namespace cuesta
