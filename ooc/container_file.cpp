#include "ooc/container_file.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "ooc/byte_stream.h"
#include "ooc/fingerprint.h"

namespace cuesta {
namespace {

constexpr std::array<char, 8> magic{'C', 'U', 'E', 'S', 'T', 'A', '\r', '\n'};
constexpr std::size_t header_bytes = container_header_bytes;

std::vector<std::byte> make_header(const BlockRef& directory, std::uint64_t file_bytes, ContainerKind kind) {
  ByteWriter w;
  w.put(magic);
  w.put(container_version(kind));
  w.put(static_cast<std::uint32_t>(header_bytes));
  w.put(directory.offset);
  w.put(directory.bytes);
  w.put(directory.checksum);
  w.put(file_bytes);
  w.put(kind);
  w.put(checksum(w.bytes()));
  return w.take();
}

}  // namespace

Result<ContainerWriter> ContainerWriter::create(const std::filesystem::path& path, ContainerKind kind) {
  auto file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  const std::array<std::byte, header_bytes> blank{};
  if (auto r = file->write(blank); !r) return fail(r.error());
  return ContainerWriter(std::move(*file), kind);
}

Result<ContainerWriter> ContainerWriter::resume(const std::filesystem::path& path, std::uint64_t end) {
  auto file = AtomicFile::resume(path, end);
  if (!file) return fail(file.error());
  return ContainerWriter(std::move(*file), ContainerKind::surface);
}

Result<void> ContainerWriter::pad() {
  const std::array<std::byte, container_alignment> zeros{};
  const std::uint64_t over = file_.bytes_written() % container_alignment;
  return over == 0 ? Result<void>{} : file_.write(std::span(zeros).first(container_alignment - over));
}

Result<BlockRef> ContainerWriter::append(std::span<const std::byte> block) {
  if (auto r = pad(); !r) return fail(r.error());
  const BlockRef ref{file_.bytes_written(), block.size(), checksum(block)};
  if (auto r = file_.write(block); !r) return fail(r.error());
  return ref;
}

Result<void> ContainerWriter::finish(std::span<const std::byte> directory) {
  const auto ref = append(directory);
  if (!ref) return fail(ref.error());
  return finish(*ref);
}

Result<void> ContainerWriter::finish(const BlockRef& directory) {
  const auto header = make_header(directory, file_.bytes_written(), kind_);
  if (auto r = file_.rewrite(0, header); !r) return r;
  return file_.commit();
}

/// The version is looked at first: what else a later one has in its header is not known.
Result<ContainerKind> ContainerReader::read_header() {
  const std::string& file = path().native();
  std::array<std::byte, header_bytes> bytes{};
  const std::size_t got = std::min<std::uint64_t>(file_bytes(), header_bytes);
  if (auto r = source_->read_at(0, std::span(bytes).first(got)); !r) return fail(r.error());
  if (got < magic.size() || std::memcmp(bytes.data(), magic.data(), magic.size()) != 0)
    return fail(ErrorCode::corrupt, file, at_byte(0), "not a .cuesta file: it does not begin with CUESTA");
  if (got < header_bytes) return fail(ErrorCode::corrupt, file, at_byte(got), "the header is cut off");
  ByteReader r(std::span<const std::byte>(bytes).subspan(magic.size()));
  const auto version = r.get<std::uint32_t>();
  constexpr auto newest = container_version(ContainerKind::scene);
  if (version == 0 || version > newest)
    return fail(ErrorCode::unsupported_version, file, at_byte(8),
                "format version " + std::to_string(version) + ", this program reads versions up to " +
                    std::to_string(newest));
  r.get<std::uint32_t>();
  directory_.offset = r.get<std::uint64_t>();
  directory_.bytes = r.get<std::uint64_t>();
  directory_.checksum = r.get<std::uint64_t>();
  whole_bytes_ = r.get<std::uint64_t>();
  const auto kind = r.get<ContainerKind>();
  if (r.get<std::uint64_t>() != checksum(std::span<const std::byte>(bytes).first(56)))
    return fail(ErrorCode::corrupt, file, at_byte(0), "the header's checksum does not match");
  if (version == container_version(ContainerKind::surface)) return ContainerKind::surface;
  if (kind == ContainerKind::scene) return kind;
  return fail(ErrorCode::unsupported_version, file, at_byte(48),
              "holds something that this program does not know");
}

Result<ContainerKind> ContainerReader::kind_of(const std::filesystem::path& path) {
  auto file = open_local_file(path);
  if (!file) return fail(file.error());
  return ContainerReader(std::move(*file)).read_header();
}

Result<ContainerReader> ContainerReader::open(const std::filesystem::path& path, ContainerKind wanted) {
  auto file = open_local_file(path);
  if (!file) return fail(file.error());
  return open(std::move(*file), wanted);
}

Result<ContainerReader> ContainerReader::open(std::shared_ptr<const ByteSource> source,
                                              ContainerKind wanted) {
  ContainerReader reader(std::move(source));
  const std::string& file = reader.path().native();
  const auto kind = reader.read_header();
  if (!kind) return fail(kind.error());
  if (*kind != wanted)
    return fail(ErrorCode::invalid_input, file, "",
                wanted == ContainerKind::surface
                    ? "holds a scene of many parts, and a single surface is needed here"
                    : "holds a single surface, and a scene of many parts is needed here");
  const bool may_be_cut = wanted == ContainerKind::scene && reader.file_bytes() < reader.whole_bytes_;
  if (reader.whole_bytes_ != reader.file_bytes() && !may_be_cut)
    return fail(ErrorCode::corrupt, file, at_byte(40),
                "expected " + std::to_string(reader.whole_bytes_) + " bytes, found " +
                    std::to_string(reader.file_bytes()) + ": the file was cut off or appended to");
  return reader;
}

Result<std::vector<std::byte>> ContainerReader::read(const BlockRef& block) const {
  if (block.offset > file_bytes() || block.bytes > file_bytes() - block.offset)
    return fail(ErrorCode::corrupt, path().string(), at_byte(block.offset),
                "a block lies beyond the end of the file");
  std::vector<std::byte> bytes(block.bytes);
  if (auto r = source_->read_at(block.offset, bytes); !r) return fail(r.error());
  if (checksum(bytes) != block.checksum)
    return fail(ErrorCode::corrupt, path().string(), at_byte(block.offset),
                "a block of " + std::to_string(block.bytes) + " bytes does not match its checksum");
  return bytes;
}

}  // namespace cuesta
