#include "ooc/raw_surface.h"

#include <algorithm>
#include <cstring>

#include "ooc/byte_stream.h"
#include "ooc/choose_grid.h"
#include "ooc/oct_normal.h"

namespace cuesta {
namespace {

constexpr std::size_t column_buffer_bytes = std::size_t{1} << 20;
constexpr std::uint32_t bucket_buffer_bytes = 1u << 18;
constexpr std::uint64_t most_used_bits = std::uint64_t{1} << 29;
constexpr std::array<const char*, 4> column_names{"positions", "normals", "colours", "texcoords"};

// A column that an input lacks is a hole in its file, which reads as zeros: so attributes are stored such
// that zero is what a vertex without them has.
constexpr std::int16_t no_normal = -(1 << (normal_bits - 1));
OctNormal stored(OctNormal n) {
  return {static_cast<std::int16_t>(n[0] - no_normal), static_cast<std::int16_t>(n[1] - no_normal)};
}
OctNormal unstored(OctNormal n) {
  return {static_cast<std::int16_t>(n[0] + no_normal), static_cast<std::int16_t>(n[1] + no_normal)};
}
Rgba8 complement(Rgba8 c) {
  for (std::uint8_t& x : c) x = static_cast<std::uint8_t>(~x);
  return c;
}
FixedTexCoord fixed(TexCoord t) {
  const auto one = [](float f) {
    return static_cast<std::int32_t>(std::lround(std::clamp(f, -32767.0f, 32767.0f) * 65536.0f));
  };
  return {one(t[0]), one(t[1])};
}

template <class T, class F>
std::vector<std::byte> converted(std::span<const T> values, F f) {
  using Out = decltype(f(values[0]));
  std::vector<std::byte> bytes(values.size() * sizeof(Out));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Out value = f(values[i]);
    std::memcpy(bytes.data() + i * sizeof(Out), &value, sizeof(Out));
  }
  return bytes;
}

template <class T>
Result<void> read_column(const FileHandle& file, std::uint64_t first, std::uint64_t count,
                         std::vector<T>& out) {
  out.resize(count);
  return file.read_at(first * sizeof(T), std::as_writable_bytes(std::span(out)));
}

}  // namespace

Result<RawSurface> RawSurface::create(const std::filesystem::path& folder, std::uint64_t block_vertices) {
  RawSurface out;
  out.block_vertices_ = block_vertices;
  for (std::size_t c = 0; c < column_count; ++c) {
    auto file = FileHandle::create(folder / column_names[c]);
    if (!file) return fail(file.error());
    out.columns_[c] = std::move(*file);
  }
  auto triangles = BucketFile::create(folder / "triangles");
  if (!triangles) return fail(triangles.error());
  auto corners = BucketFile::create(folder / "corners");
  if (!corners) return fail(corners.error());
  out.triangles_ = std::make_unique<BucketFile>(std::move(*triangles));
  out.corners_ = std::make_unique<BucketFile>(std::move(*corners));
  out.triangle_writer_ = std::make_unique<BucketFile::Writer>(*out.triangles_, bucket_buffer_bytes);
  out.corner_writer_ = std::make_unique<BucketFile::Writer>(*out.corners_, bucket_buffer_bytes);
  return out;
}

void RawSurface::remove(const std::filesystem::path& folder) {
  std::error_code ignored;
  for (const char* name : column_names) std::filesystem::remove(folder / name, ignored);
  std::filesystem::remove(folder / "triangles", ignored);
  std::filesystem::remove(folder / "corners", ignored);
}

void RawSurface::begin_input() {
  first_of_input_ = counts_.vertices;
  inputs_.push_back({});
}

Result<void> RawSurface::put(Column column, std::span<const std::byte> bytes) {
  Pending& p = pending_[column];
  const std::uint64_t expected = p.first + p.bytes.size() / element_bytes[column];
  if (expected != counts_.vertices) {
    if (auto r = flush(column); !r) return r;
    p.first = counts_.vertices;
  }
  p.bytes.insert(p.bytes.end(), bytes.begin(), bytes.end());
  return p.bytes.size() < column_buffer_bytes ? Result<void>{} : flush(column);
}

Result<void> RawSurface::flush(Column column) {
  Pending& p = pending_[column];
  if (p.bytes.empty()) return {};
  if (auto r = columns_[column].write_at(p.first * element_bytes[column], p.bytes); !r) return r;
  p.first += p.bytes.size() / element_bytes[column];
  p.bytes.clear();
  return {};
}

Result<void> RawSurface::vertices(const VertexBlock& block) {
  const auto add = [&](Column column, std::span<const std::byte> bytes) { return put(column, bytes); };
  if (auto r = add(positions, std::as_bytes(block.positions)); !r) return r;
  if (!block.normals.empty()) {
    const auto bytes = converted(block.normals, [&](const Vec3f& n) {
      const OctNormal code = encode_oct(n, normal_bits);
      counts_.has_missing_normals |= code[0] == no_normal && code[1] == no_normal;
      return stored(code);
    });
    if (auto r = add(normals, bytes); !r) return r;
  }
  if (!block.colours.empty())
    if (auto r = add(colours, converted(block.colours, complement)); !r) return r;
  if (!block.texcoords.empty())
    if (auto r = add(texcoords, converted(block.texcoords, fixed)); !r) return r;
  note_nonfinite(block.positions);
  counts_.vertices += block.positions.size();
  Input& input = inputs_.back();
  input.vertices += block.positions.size();
  input.attributes.normals |= !block.normals.empty();
  input.attributes.colours |= !block.colours.empty();
  input.attributes.texcoords |= !block.texcoords.empty();
  return {};
}

void RawSurface::note_nonfinite(std::span<const Vec3d> block) {
  for (std::size_t i = 0; i < block.size(); ++i) {
    const Vec3d& p = block[i];
    if (is_finite(p)) continue;
    const std::uint64_t v = counts_.vertices + i;
    if (v >= most_used_bits) return;  // their faces are found later
    if (v / 64 >= nonfinite_.size()) nonfinite_.resize(std::max(v / 64 + 1, nonfinite_.size() * 2));
    nonfinite_[v / 64] |= std::uint64_t{1} << (v % 64);
  }
}

void RawSurface::note_used(std::uint64_t v) {
  while ((v >> used_shift_) >= most_used_bits) {
    for (std::size_t w = 0; w < used_.size(); ++w) {
      const std::uint64_t pairs = used_[w] | used_[w] >> 1;
      std::uint64_t half = 0;
      for (int bit = 0; bit < 32; ++bit) half |= (pairs >> (2 * bit) & 1) << bit;
      used_[w] = 0;
      used_[w / 2] |= half << (w % 2 * 32);
    }
    ++used_shift_;
  }
  const std::uint64_t bit = v >> used_shift_;
  if (bit / 64 >= used_.size()) used_.resize(std::max(bit / 64 + 1, used_.size() * 2));
  used_[bit / 64] |= std::uint64_t{1} << (bit % 64);
}

void RawSurface::note_sample(std::uint64_t ordinal, const std::array<std::uint64_t, 3>& t) {
  if (ordinal % sample_stride_ != 0) return;
  if (sample_.size() == 2 * kEdgeSampleTriangles) {
    for (std::size_t i = 0; i < kEdgeSampleTriangles; ++i) sample_[i] = sample_[2 * i];
    sample_.resize(kEdgeSampleTriangles);
    sample_stride_ *= 2;
    if (ordinal % sample_stride_ != 0) return;
  }
  sample_.push_back(t);
}

Result<void> RawSurface::triangles(TriangleBlock block) {
  for (const auto& local : block) {
    const std::array<std::uint64_t, 3> t{local[0] + first_of_input_, local[1] + first_of_input_,
                                         local[2] + first_of_input_};
    const std::uint64_t ordinal = counts_.triangles++;
    if (!nonfinite_.empty() && (is_nonfinite(t[0]) || is_nonfinite(t[1]) || is_nonfinite(t[2]))) {
      ++counts_.nonfinite_faces;
      continue;
    }
    for (const std::uint64_t v : t) note_used(v);
    note_sample(ordinal, t);
    const std::array<std::uint64_t, 3> b{t[0] / block_vertices_, t[1] / block_vertices_,
                                         t[2] / block_vertices_};
    const auto within = [&](std::uint64_t v) { return static_cast<std::uint32_t>(v % block_vertices_); };
    if (b[0] == b[1] && b[1] == b[2]) {
      const LocalTriangle record{static_cast<std::uint32_t>(ordinal),
                                 static_cast<std::uint32_t>(ordinal >> 32),
                                 {within(t[0]), within(t[1]), within(t[2])}};
      if (auto r = triangle_writer_->append(static_cast<std::uint32_t>(b[0]), record); !r) return r;
      continue;
    }
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint64_t slot = ordinal * 4 + k;
      const LocalCorner record{static_cast<std::uint32_t>(slot), static_cast<std::uint32_t>(slot >> 32),
                               within(t[k])};
      if (auto r = corner_writer_->append(static_cast<std::uint32_t>(b[k]), record); !r) return r;
    }
  }
  return {};
}

Result<void> RawSurface::finish() {
  for (const Column c : {positions, normals, colours, texcoords})
    if (auto r = flush(c); !r) return r;
  if (auto r = triangle_writer_->flush(); !r) return r;
  if (auto r = corner_writer_->flush(); !r) return r;
  triangle_writer_.reset();
  corner_writer_.reset();
  for (auto& p : pending_) p = {};
  used_.resize(((counts_.vertices >> used_shift_) + 64) / 64);
  for (const Input& input : inputs_) {
    counts_.attributes.normals |= input.attributes.normals;
    counts_.attributes.colours |= input.attributes.colours;
    counts_.attributes.texcoords |= input.attributes.texcoords;
  }
  const AttributeSet with = counts_.attributes;
  for (const Input& input : inputs_) {
    if (with.normals && !input.attributes.normals) counts_.missing.normals += input.vertices;
    if (with.colours && !input.attributes.colours) counts_.missing.colours += input.vertices;
    if (with.texcoords && !input.attributes.texcoords) counts_.missing.texcoords += input.vertices;
  }
  counts_.has_missing_normals |= !with.normals || counts_.missing.normals > 0;
  // A hole at a column's end is part of it too.
  const std::array<bool, column_count> there{true, with.normals, with.colours, with.texcoords};
  for (std::size_t c = 0; c < column_count; ++c)
    if (there[c])
      if (auto r = columns_[c].resize(counts_.vertices * element_bytes[c]); !r) return r;
  return {};
}

std::uint32_t RawSurface::block_count() const {
  return static_cast<std::uint32_t>((counts_.vertices + block_vertices_ - 1) / block_vertices_);
}

Result<RawVertices> RawSurface::block(std::uint32_t b) const {
  const std::uint64_t first = b * block_vertices_;
  const std::uint64_t count = std::min(block_vertices_, counts_.vertices - first);
  RawVertices out;
  if (auto r = read_column(columns_[positions], first, count, out.positions); !r) return fail(r.error());
  if (counts_.attributes.normals) {
    if (auto r = read_column(columns_[normals], first, count, out.normals); !r) return fail(r.error());
    for (OctNormal& n : out.normals) n = unstored(n);
  }
  if (counts_.attributes.colours) {
    if (auto r = read_column(columns_[colours], first, count, out.colours); !r) return fail(r.error());
    for (Rgba8& c : out.colours) c = complement(c);
  }
  if (counts_.attributes.texcoords)
    if (auto r = read_column(columns_[texcoords], first, count, out.texcoords); !r) return fail(r.error());
  return out;
}

Result<std::vector<Vec3d>> RawSurface::positions_run(std::uint64_t first, std::uint64_t count) const {
  std::vector<Vec3d> out;
  if (auto r = read_column(columns_[positions], first, count, out); !r) return fail(r.error());
  return out;
}

Result<std::vector<Vec3d>> RawSurface::positions_of(std::span<const std::uint64_t> vertices) const {
  // Vertices that are near each other in the file come in one read.
  constexpr std::uint64_t near = 256, most = 1u << 16;
  std::vector<Vec3d> out;
  out.reserve(vertices.size());
  for (std::size_t begin = 0, end = 0; begin < vertices.size(); begin = end) {
    const std::uint64_t first = vertices[begin];
    for (end = begin + 1;
         end < vertices.size() && vertices[end] - vertices[end - 1] < near && vertices[end] - first < most;)
      ++end;
    const auto run = positions_run(first, vertices[end - 1] - first + 1);
    if (!run) return fail(run.error());
    for (std::size_t i = begin; i < end; ++i) out.push_back((*run)[vertices[i] - first]);
  }
  return out;
}

std::vector<std::byte> RawSurface::encode() const {
  ByteWriter w;
  w.put(counts_);
  w.put(block_vertices_);
  for (const BucketFile* file : {triangles_.get(), corners_.get()}) {
    const auto index = file->encode_index();
    w.put_varint(index.size());
    w.put_bytes(index);
  }
  return w.take();
}

Result<RawSurface> RawSurface::open(const std::filesystem::path& folder, std::span<const std::byte> state) {
  RawSurface out;
  ByteReader r(state);
  out.counts_ = r.get<RawCounts>();
  out.block_vertices_ = r.get<std::uint64_t>();
  for (std::size_t c = 0; c < column_count; ++c) {
    auto file = FileHandle::open(folder / column_names[c]);
    if (!file) return fail(file.error());
    out.columns_[c] = std::move(*file);
  }
  for (const auto& [name, file] : {std::pair{"triangles", &out.triangles_}, {"corners", &out.corners_}}) {
    auto opened = BucketFile::open(folder / name, r.get_bytes(r.get_varint()));
    if (!opened) return fail(opened.error());
    *file = std::make_unique<BucketFile>(std::move(*opened));
  }
  return out;
}

}  // namespace cuesta
