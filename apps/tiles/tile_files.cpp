#include "apps/tiles/tile_files.h"

#include <md5.h>

#include <algorithm>
#include <array>
#include <set>
#include <system_error>

#include "apps/tiles/zip_writer.h"
#include "ooc/file_handle.h"

namespace cuesta::tiles {
namespace {

namespace fs = std::filesystem;

Error io_error(const fs::path& path, const std::error_code& code) {
  return {ErrorCode::io, path.string(), "", code.message()};
}

class TileFolder : public TileFiles {
 public:
  explicit TileFolder(fs::path path) : path_(std::move(path)), part_(path_.string() + ".part") {}
  ~TileFolder() override {
    std::error_code ignored;
    if (!done_) fs::remove_all(part_, ignored);
  }

  Result<void> begin() {
    std::error_code code;
    fs::remove_all(part_, code);
    if (!code) fs::create_directories(part_, code);
    if (code) return fail(io_error(part_, code));
    return {};
  }

  Result<void> add(const std::string& name, std::span<const std::byte> bytes) override {
    const fs::path path = part_ / name;
    const fs::path folder = path.parent_path();
    if (folder != part_ && folders_.insert(folder).second) {
      std::error_code code;
      fs::create_directories(folder, code);
      if (code) return fail(io_error(folder, code));
    }
    auto file = FileHandle::create(path);
    if (!file) return fail(file.error());
    return file->write_at(0, bytes);
  }

  Result<void> finish() override {
    std::error_code code;
    fs::rename(part_, path_, code);
    if (code) return fail(io_error(path_, code));
    done_ = true;
    return {};
  }

 private:
  fs::path path_, part_;
  std::set<fs::path> folders_;
  bool done_ = false;
};

using Digest = std::array<std::uint8_t, MD5_DIGEST_LENGTH>;

Digest md5_of(const std::string& text) {
  Digest digest{};
  MD5_CTX context;
  MD5Init(&context);
  MD5Update(&context, reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  MD5Final(digest.data(), &context);
  return digest;
}

/// The index is in the order of the digests as two little-endian numbers, the first half first.
std::array<std::uint64_t, 2> halves(const Digest& digest) {
  std::array<std::uint64_t, 2> h{};
  for (std::size_t i = 0; i < digest.size(); ++i) h[i / 8] |= std::uint64_t{digest[i]} << (8 * (i % 8));
  return h;
}

class TileArchive : public TileFiles {
 public:
  explicit TileArchive(ZipWriter zip) : zip_(std::move(zip)) {}

  Result<void> add(const std::string& name, std::span<const std::byte> bytes) override {
    return zip_.add(name, bytes);
  }

  Result<void> finish() override {
    if (auto r = zip_.add("@3dtilesIndex1@", index()); !r) return r;
    return zip_.commit();
  }

 private:
  std::vector<std::byte> index() const {
    std::vector<std::pair<Digest, std::uint64_t>> rows;
    for (const auto& e : zip_.entries()) rows.emplace_back(md5_of(e.name), e.offset);
    std::sort(rows.begin(), rows.end(),
              [](const auto& a, const auto& b) { return halves(a.first) < halves(b.first); });
    std::vector<std::byte> bytes;
    bytes.reserve(rows.size() * 24);
    for (const auto& [digest, offset] : rows) {
      for (const std::uint8_t b : digest) bytes.push_back(static_cast<std::byte>(b));
      for (unsigned i = 0; i < 8; ++i) bytes.push_back(static_cast<std::byte>(offset >> (8 * i) & 0xFFu));
    }
    return bytes;
  }

  ZipWriter zip_;
};

}  // namespace

Result<std::unique_ptr<TileFiles>> tile_folder(const fs::path& path) {
  std::error_code code;
  if (fs::exists(path, code))
    return fail(ErrorCode::invalid_input, path.string(), "",
                "there is a file or folder of that name; remove it, or choose another one");
  auto folder = std::make_unique<TileFolder>(path);
  if (auto r = folder->begin(); !r) return fail(r.error());
  return std::unique_ptr<TileFiles>(std::move(folder));
}

Result<std::unique_ptr<TileFiles>> tile_archive(const fs::path& path) {
  auto zip = ZipWriter::create(path);
  if (!zip) return fail(zip.error());
  return std::unique_ptr<TileFiles>(new TileArchive(std::move(*zip)));
}

Result<std::unique_ptr<TileFiles>> tile_files(const fs::path& path) {
  return path.extension() == ".3tz" ? tile_archive(path) : tile_folder(path);
}

}  // namespace cuesta::tiles
