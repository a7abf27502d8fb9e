/// Writes one good input for fuzz_work_files of each kind, and one for fuzz_journal: work_file_seeds FOLDER

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

#include "hierarchy/page_survivors.h"
#include "hierarchy/round_journal.h"
#include "ooc/clean_chunk.h"
#include "ooc/journal.h"
#include "tests/fuzz/work_file_kinds.h"

namespace {

using namespace cuesta;
using Path = std::filesystem::path;

void write(const Path& path, fuzz::WorkFile kind, std::span<const std::byte> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.put(static_cast<char>(kind));
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

/// A strip of triangles along x, in two chunks that meet at x = 4.
std::vector<std::byte> strip_records(const SoupLayout& layout) {
  std::vector<std::byte> records;
  for (std::int32_t i = 0; i < 8; ++i) {
    SoupTriangle t;
    t.ordinal = static_cast<std::uint64_t>(i);
    t.owner = i < 4 ? 0 : 1;
    t.positions = {Vec3i{i, i & 1, 0}, Vec3i{i + 1, (i + 1) & 1, 0}, Vec3i{i + 2, i & 1, 0}};
    if ((i & 1) != 0) std::swap(t.positions[1], t.positions[2]);
    t.area_normal = {0, 0, 1};
    std::array<std::byte, max_soup_record_bytes> buffer{};
    const auto record = encode(t, 0, layout, buffer);
    records.insert(records.end(), record.begin(), record.end());
  }
  return records;
}

CleanChunk strip_chunk(const SoupLayout& layout, float border) {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  Box3<float> box;
  box.lo = {-infinity, -infinity, -infinity};
  box.hi = {border, infinity, infinity};
  return clean_chunk(decode_soup(strip_records(layout), 0, layout), 0, box, layout.area_normals).chunk;
}

PageSurvivors survivors_of(const CleanChunk& chunk) {
  PageSurvivors s;
  s.vertices = chunk.vertices;
  s.wedge = chunk.wedge;
  for (std::uint32_t v = 0; v < s.wedge.size(); ++v) s.ids.push_back(vertex_id(0, v));
  for (const Triangle& t : chunk.triangles)
    if (std::max({t[0], t[1], t[2]}) < s.ids.size()) s.triangles.push_back(t);
  s.births.resize(s.triangles.size());
  s.samples.begin.assign(s.triangles.size() + 1, 0);
  s.samples.points.resize(2);
  s.samples.begin.back() = 2;
  return s;
}

ChunkRoundRecord record() {
  ChunkRoundRecord r{4096, 512, {}};
  CellRecord& cell = r.cells.emplace_back();
  cell.facts.entry.vertices = cell.facts.entry.triangles = 8;
  cell.facts.sources = {0, 1};
  cell.facts.centres = {{1, 2, 3}};
  cell.survivors_bytes = 512;
  r.cells.push_back(cell);
  return r;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: work_file_seeds FOLDER\n", stderr);
    return 1;
  }
  using fuzz::WorkFile;
  const Path folder = argv[1];
  std::filesystem::create_directories(folder / "work_files");
  std::filesystem::create_directories(folder / "journal");
  const SoupLayout layout{{true, true, true}, true};
  const auto out = [&](const char* name) { return folder / "work_files" / name; };
  write(out("chunk"), WorkFile::chunk, encode_chunk(strip_chunk(layout, 4)));
  const CleanChunk whole = strip_chunk(layout, std::numeric_limits<float>::infinity());
  write(out("survivors"), WorkFile::survivors, encode_survivors(survivors_of(whole)));
  write(out("record"), WorkFile::record, encode_record(record()));
  for (std::uint8_t how = 0; how < 32; how += 5) {
    std::vector<std::byte> soup{std::byte{how}};
    const auto records = strip_records({{(how & 1) != 0, (how & 2) != 0, (how & 4) != 0}, (how & 8) != 0});
    soup.insert(soup.end(), records.begin(), records.end());
    write(out(("soup" + std::to_string(how)).c_str()), WorkFile::soup, soup);
  }
  // 4096 bytes, two buckets: of two pieces and of one.
  const std::array<unsigned char, 12> index{0x80, 0x20, 2, 2, 0, 100, 0x80, 2, 50, 1, 100, 100};
  write(out("bucket_index"), WorkFile::bucket_index, std::as_bytes(std::span(index)));

  auto journal = Journal::open(folder / "journal" / "good", "build");
  const std::vector<std::byte> result(40, std::byte{3});
  bool good = journal.has_value();
  for (std::uint64_t i = 0; good && i < 4; ++i)
    good = journal->record("read", i, result) && journal->record("clean", i, result);
  if (!good) std::fputs("cannot write the journal\n", stderr);
  return good ? 0 : 1;
}
