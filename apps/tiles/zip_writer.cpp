#include "apps/tiles/zip_writer.h"

#include <zlib.h>

#include <limits>

namespace cuesta::tiles {
namespace {

constexpr std::uint32_t in_zip64 = 0xFFFF'FFFFu;
constexpr std::uint16_t count_in_zip64 = 0xFFFFu;
constexpr std::uint16_t version_stored = 20, version_zip64 = 45;
constexpr std::uint16_t date_1980 = 0x21;

class Record {
 public:
  Record& u16(std::uint64_t v) { return put(v, 2); }
  Record& u32(std::uint64_t v) { return put(v, 4); }
  Record& u64(std::uint64_t v) { return put(v, 8); }
  Record& text(const std::string& s) {
    for (const char c : s) bytes_.push_back(static_cast<std::byte>(c));
    return *this;
  }
  std::span<const std::byte> bytes() const { return bytes_; }

 private:
  Record& put(std::uint64_t v, unsigned count) {
    for (unsigned i = 0; i < count; ++i) bytes_.push_back(static_cast<std::byte>(v >> (8 * i) & 0xFFu));
    return *this;
  }
  std::vector<std::byte> bytes_;
};

std::uint32_t crc_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));  // zlib's own view of bytes
}

/// What the header beside a file and the one in the directory share.
Record& put_common(Record& r, const ZipWriter::Entry& e) {
  r.u16(0).u16(0).u16(0).u16(date_1980).u32(e.crc).u32(e.bytes).u32(e.bytes);
  return r.u16(e.name.size());
}

Record local_header(const ZipWriter::Entry& e) {
  Record r;
  r.u32(0x0403'4b50).u16(version_stored);
  put_common(r, e).u16(0).text(e.name);
  return r;
}

Record directory_header(const ZipWriter::Entry& e) {
  const bool far = e.offset >= in_zip64;
  Record r;
  r.u32(0x0201'4b50).u16(far ? version_zip64 : version_stored).u16(far ? version_zip64 : version_stored);
  put_common(r, e).u16(far ? 12 : 0).u16(0).u16(0).u16(0).u32(0).u32(far ? in_zip64 : e.offset).text(e.name);
  if (far) r.u16(1).u16(8).u64(e.offset);
  return r;
}

Record end_record(std::uint64_t count, std::uint64_t start, std::uint64_t end) {
  Record r;
  const bool large = count >= count_in_zip64 || start >= in_zip64 || end - start >= in_zip64;
  if (large) {
    r.u32(0x0606'4b50).u64(44).u16(version_zip64).u16(version_zip64).u32(0).u32(0);
    r.u64(count).u64(count).u64(end - start).u64(start);
    r.u32(0x0706'4b50).u32(0).u64(end).u32(1);
  }
  r.u32(0x0605'4b50).u16(0).u16(0).u16(large ? count_in_zip64 : count).u16(large ? count_in_zip64 : count);
  return r.u32(large ? in_zip64 : end - start).u32(large ? in_zip64 : start).u16(0);
}

}  // namespace

Result<ZipWriter> ZipWriter::create(const std::filesystem::path& path) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  return ZipWriter(std::move(*file));
}

Result<void> ZipWriter::add(const std::string& name, std::span<const std::byte> bytes) {
  if (bytes.size() >= in_zip64)
    return fail(ErrorCode::invalid_input, "", name, "files of 4 GiB and more do not go into an archive");
  entries_.push_back({name, file_.bytes_written(), static_cast<std::uint32_t>(bytes.size()), crc_of(bytes)});
  if (auto r = file_.write(local_header(entries_.back()).bytes()); !r) return r;
  return file_.write(bytes);
}

Result<void> ZipWriter::commit() {
  const std::uint64_t start = file_.bytes_written();
  for (const Entry& e : entries_)
    if (auto r = file_.write(directory_header(e).bytes()); !r) return r;
  if (auto r = file_.write(end_record(entries_.size(), start, file_.bytes_written()).bytes()); !r) return r;
  return file_.commit();
}

}  // namespace cuesta::tiles
