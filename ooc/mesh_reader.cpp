#include "ooc/mesh_reader.h"

#include <fmt/format.h>

#include <cctype>
#include <cstring>
#include <new>
#include <string_view>

#include "ooc/map_window.h"
#include "ooc/mapped_file.h"
#include "ooc/read_job.h"
#include "ooc/text_cursor.h"
#include "ooc/unpacked_file.h"
#include "ooc/vdb_directory.h"

namespace cuesta {
namespace {

using Reader = Result<ReadReport> (*)(const ReadJob&);

/// A binary STL says its size: 84 bytes and 50 per triangle. Its 80-byte header may begin with "solid".
bool is_sized_like_binary_stl(std::span<const char> bytes) {
  if (bytes.size() < 84) return false;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + 80, 4);
  return bytes.size() == 84 + std::uint64_t{50} * count;
}

/// Looks at the first mebibyte: what is not text by then, or only comments, has no first word.
std::string_view first_word(std::span<const char> bytes) {
  bytes = bytes.first(std::min<std::size_t>(bytes.size(), std::size_t{1} << 20));
  TextCursor text{bytes.data(), bytes.data() + bytes.size()};
  text.skip_spaces();
  while (!text.done() && *text.at == '#') {
    text.skip_line();
    text.skip_spaces();
  }
  return text.word().substr(0, 16);
}

bool is_off_keyword(std::string_view word) {
  if (!word.ends_with("OFF")) return false;
  word.remove_suffix(3);
  for (const std::string_view prefix : {"ST", "C", "N", "4", "n"}) {
    if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
  }
  return word.empty();
}

Reader reader_by_content(std::span<const char> bytes) {
  const std::string_view start(bytes.data(), std::min<std::size_t>(bytes.size(), 64));
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return read_ply;
  if (start.starts_with("glTF")) return read_gltf;
  if (start.starts_with("DRACO")) return read_draco;
  if (is_vdb(bytes)) return read_vdb;
  if (is_sized_like_binary_stl(bytes)) return read_stl_binary;
  const std::string_view word = first_word(bytes);
  if (is_off_keyword(word)) return read_off;
  if (word == "solid" || word == "SOLID" || word == "Solid") return read_stl_ascii;
  return nullptr;
}

Reader reader_by_extension(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (extension == ".ply") return read_ply;
  if (extension == ".obj") return read_obj;
  if (extension == ".stl") return read_stl_binary;
  if (extension == ".off") return read_off;
  if (extension == ".gltf" || extension == ".glb") return read_gltf;
  if (extension == ".drc") return read_draco;
  if (extension == ".vdb") return read_vdb;
  return nullptr;
}

/// @param name  of the file, or of what was compressed in it
Result<ReadReport> read_bytes(const ReadJob& job, const std::filesystem::path& name) {
  if (job.bytes.empty()) return job.corrupt_at(0, "expected a mesh, found an empty file");
  Reader reader = reader_by_content(job.bytes);
  if (!reader) reader = reader_by_extension(name);
  if (!reader) {
    return job.error(
        ErrorCode::unsupported_version, "byte 0",
        "not a format known here; PLY, OBJ, STL, OFF, glTF, GLB, Draco (.drc) and OpenVDB files can be read");
  }
  try {
    return reader(job);
  } catch (const std::bad_alloc&) {
    return job.error(ErrorCode::out_of_budget, "", "the system has no memory left");
  }
}

/// A file that changed may look damaged, or may have been taken for a mesh of any size: the cause goes before
/// the symptom.
bool is_in_doubt(const Result<ReadReport>& report, const MappedFile& file) {
  if (report || report.error().code == ErrorCode::corrupt) return true;
  return file.has_faulted() && report.error().code != ErrorCode::cancelled;
}

/// Two passes over one file: unpacking is the first half of its bytes, reading the second.
Result<ReadReport> read_compressed(const ReadJob& job, Compression compression,
                                   const std::filesystem::path& temp) {
  const std::uint64_t packed_bytes = job.bytes.size(), half = packed_bytes / 2;
  UnpackLimits limits;
  limits.memory_bytes = job.budget.left();
  const auto unpacking = [&](std::uint64_t done) {
    job.passed(job.bytes.data() + done);
    return !job.progress || job.progress(done / 2, packed_bytes);
  };
  auto file = unpack_file(job.path, job.bytes, compression, temp, limits, unpacking);
  if (!file) return fail(std::move(file).error());
  CUESTA_TRY(job.file->check_unchanged());
  job.window->release_all();
  file->advise_sequential();
  MapWindow window(*file);
  const ReadProgress reading = [&](std::uint64_t done, std::uint64_t total) {
    const double part = total > 0 ? static_cast<double>(done) / static_cast<double>(total) : 1;
    return !job.progress ||
           job.progress(half + static_cast<std::uint64_t>(part * static_cast<double>(packed_bytes - half)),
                        packed_bytes);
  };
  ReadJob inner{job.path, file->bytes(), job.sink, job.budget, reading, job.expect, job.volume};
  inner.temp = temp;
  inner.file = &*file;
  inner.window = &window;
  auto report = read_bytes(inner, name_inside(job.path));
  if (is_in_doubt(report, *file)) CUESTA_TRY(file->check_unchanged());
  if (!report && !report.error().place.empty()) report.error().place += " unpacked";
  return report;
}

}  // namespace

Result<ReadReport> read_into(const std::filesystem::path& path, MeshSink& sink, ReadBudget& budget,
                             const ReadProgress& progress, const std::filesystem::path& temp, Expect expect,
                             const VolumeOptions& volume) {
  auto file = MappedFile::open(path);
  if (!file) return fail(std::move(file).error());
  file->advise_sequential();
  MapWindow window(*file);
  ReadJob job{path, file->bytes(), sink, budget, progress, std::move(expect), volume};
  job.temp = temp;
  job.file = &*file;
  job.window = &window;
  const Compression compression = compression_of(job.bytes);
  auto report =
      compression == Compression::none ? read_bytes(job, path) : read_compressed(job, compression, temp);
  if (is_in_doubt(report, *file)) CUESTA_TRY(file->check_unchanged());
  if (!report && report.error().file.empty()) report.error().file = path.string();
  return report;
}

Result<ReadReport> read_mesh(const std::filesystem::path& path, MeshSink& sink, std::uint64_t memory_bytes,
                             const ReadProgress& progress, const std::filesystem::path& temp,
                             const VolumeOptions& volume) {
  ReadBudget budget(memory_bytes);
  return read_into(path, sink, budget, progress, temp, {}, volume);
}

}  // namespace cuesta
