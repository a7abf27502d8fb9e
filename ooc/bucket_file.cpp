#include "ooc/bucket_file.h"

#include "ooc/byte_stream.h"

namespace cuesta {

Result<BucketFile> BucketFile::create(const std::filesystem::path& path) {
  auto file = FileHandle::create(path);
  if (!file) return fail(file.error());
  BucketFile out;
  out.file_ = std::move(*file);
  return out;
}

Result<BucketFile> BucketFile::open(const std::filesystem::path& path, std::span<const std::byte> index) {
  auto file = FileHandle::open(path);
  if (!file) return fail(file.error());
  const auto size = file->size();
  if (!size) return fail(size.error());
  BucketFile out;
  out.file_ = std::move(*file);
  ByteReader r(index);
  const std::uint64_t end = r.get_varint();
  *out.end_ = end;
  const std::uint64_t buckets = r.get_varint();
  bool good = end <= *size && buckets <= r.remaining();
  for (std::uint64_t b = 0; good && b < buckets; ++b) {
    const std::uint64_t count = r.get_varint();
    good = count <= r.remaining();
    auto& extents = out.extents_.emplace_back();
    for (std::uint64_t i = 0; good && i < count; ++i) {
      const Extent e{r.get_varint(), static_cast<std::uint32_t>(r.get_varint())};
      good = e.offset <= end && e.bytes <= end - e.offset;
      extents.push_back(e);
    }
  }
  if (!good || !r.at_end())
    return fail(ErrorCode::corrupt, path.string(), "", "the work file does not match its journal");
  return out;
}

std::vector<std::byte> BucketFile::encode_index() const {
  ByteWriter w;
  w.put_varint(*end_);
  w.put_varint(extents_.size());
  for (const auto& extents : extents_) {
    w.put_varint(extents.size());
    for (const Extent& e : extents) {
      w.put_varint(e.offset);
      w.put_varint(e.bytes);
    }
  }
  return w.take();
}

std::uint64_t BucketFile::bytes(std::uint32_t bucket) const {
  std::uint64_t sum = 0;
  if (bucket < extents_.size())
    for (const Extent& e : extents_[bucket]) sum += e.bytes;
  return sum;
}

Result<std::vector<std::byte>> BucketFile::read(std::uint32_t bucket) const {
  std::vector<std::byte> out(bytes(bucket));
  std::size_t done = 0;
  if (bucket < extents_.size())
    for (const Extent& e : extents_[bucket]) {
      if (auto r = file_.read_at(e.offset, std::span(out).subspan(done, e.bytes)); !r) return fail(r.error());
      done += e.bytes;
    }
  return out;
}

Result<std::vector<std::byte>> BucketFile::read_piece(std::uint32_t bucket, std::size_t piece) const {
  const Extent& e = extents_[bucket][piece];
  std::vector<std::byte> out(e.bytes);
  if (auto r = file_.read_at(e.offset, out); !r) return fail(r.error());
  return out;
}

void BucketFile::discard(std::uint32_t bucket) const {
  if (bucket < extents_.size())
    for (const Extent& e : extents_[bucket]) file_.discard(e.offset, e.bytes);
}

Result<void> BucketFile::add(std::uint32_t bucket, std::span<const std::byte> bytes) {
  const std::uint64_t offset = end_->fetch_add(bytes.size());
  {
    const std::lock_guard lock(*mutex_);
    if (bucket >= extents_.size()) extents_.resize(bucket + std::size_t{1});
    extents_[bucket].push_back({offset, static_cast<std::uint32_t>(bytes.size())});
  }
  return file_.write_at(offset, bytes);
}

Result<void> BucketFile::Writer::append(std::uint32_t bucket, std::span<const std::byte> record) {
  if (bucket >= buffers_.size()) buffers_.resize(bucket + std::size_t{1});
  auto& buffer = buffers_[bucket];
  if (buffer.capacity() == 0) buffer.reserve(buffer_bytes_);
  if (buffer.size() + record.size() > buffer_bytes_)
    if (auto r = flush(bucket); !r) return r;
  buffer.insert(buffer.end(), record.begin(), record.end());
  return {};
}

Result<void> BucketFile::Writer::flush(std::uint32_t bucket) {
  auto& buffer = buffers_[bucket];
  if (buffer.empty()) return {};
  if (auto r = file_.add(bucket, buffer); !r) return r;
  buffer.clear();
  return {};
}

Result<void> BucketFile::Writer::flush() {
  for (std::uint32_t b = 0; b < buffers_.size(); ++b)
    if (auto r = flush(b); !r) return r;
  return {};
}

}  // namespace cuesta
