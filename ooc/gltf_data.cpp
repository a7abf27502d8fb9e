#include "ooc/gltf_data.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <algorithm>
#include <cstring>

#include "ooc/local_name.h"

namespace cuesta::gltf {
namespace {

constexpr std::uint64_t bytes_of(Component component) {
  switch (component) {
    case Component::i8:
    case Component::u8:
      return 1;
    case Component::i16:
    case Component::u16:
      return 2;
    case Component::u32:
    case Component::f32:
      return 4;
  }
  return 4;
}

template <class T>
T load(const char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && hex_digit(uri[i + 1]) >= 0 && hex_digit(uri[i + 2]) >= 0) {
      text += static_cast<char>(hex_digit(uri[i + 1]) * 16 + hex_digit(uri[i + 2]));
      i += 2;
    } else {
      text += uri[i];
    }
  }
  return text;
}

}  // namespace

double Numbers::real(std::uint64_t element, std::uint32_t k) const {
  const char* at = first + element * stride + k * bytes_of(component);
  switch (component) {
    case Component::i8: {
      const double v = load<std::int8_t>(at);
      return normalised ? std::max(v / 127, -1.0) : v;
    }
    case Component::u8: {
      const double v = load<std::uint8_t>(at);
      return normalised ? v / 255 : v;
    }
    case Component::i16: {
      const double v = load<std::int16_t>(at);
      return normalised ? std::max(v / 32767, -1.0) : v;
    }
    case Component::u16: {
      const double v = load<std::uint16_t>(at);
      return normalised ? v / 65535 : v;
    }
    case Component::u32:
      return load<std::uint32_t>(at);
    case Component::f32:
      break;
  }
  return static_cast<double>(load<float>(at));
}

std::uint64_t Numbers::index(std::uint64_t element) const {
  const char* at = first + element * stride;
  switch (component) {
    case Component::u8:
      return load<std::uint8_t>(at);
    case Component::u16:
      return load<std::uint16_t>(at);
    case Component::u32:
      return load<std::uint32_t>(at);
    default:
      return ~std::uint64_t{0};  // out of range of every mesh
  }
}

std::vector<std::filesystem::path> Data::paths_of_others() const {
  std::vector<std::filesystem::path> paths;
  for (const Buffer& b : document_.buffers) {
    const std::string name = percent_decoded(b.uri);
    if (!b.uri.starts_with("data:") && is_local_name(name)) paths.push_back(job_.path.parent_path() / name);
  }
  return paths;
}

Result<std::vector<char>*> Data::allocate(Memory& memory, std::uint64_t count, std::uint64_t element_bytes,
                                          const char* what) {
  CUESTA_TRY(job_.budget.charge(count, element_bytes, what));
  memory.push_back(std::make_unique<std::vector<char>>(count * element_bytes));
  return memory.back().get();
}

void Data::forget_decoded() {
  std::uint64_t held = 0;
  for (const auto& bytes : decoded_) held += bytes->size();
  if (held <= job_.budget.left() / 2) return;
  meshopt_views_.clear();
  materialised_.clear();
  decoded_.clear();
  job_.budget.release(held);
}

void Data::release(const char* begin, const char* end) const {
  if (job_.file && job_.file->contains(begin)) job_.file->release(begin, end);
  for (const MappedFile& file : files_) {
    if (file.contains(begin)) file.release(begin, end);
  }
}

Result<void> Data::check_unchanged() const {
  for (const MappedFile& file : files_) CUESTA_TRY(file.check_unchanged());
  return {};
}

Result<std::span<const char>> Data::buffer(Id id) {
  if (const auto found = buffers_.find(id); found != buffers_.end()) return found->second;
  auto loaded = load_buffer(id);
  if (!loaded) return loaded;
  const std::uint64_t wanted = document_.buffers[id].bytes;
  if (loaded->size() < wanted) {
    return job_.error(ErrorCode::corrupt, fmt::format("buffer {}", id),
                      fmt::format("expected {} bytes, found {}", wanted, loaded->size()));
  }
  return buffers_[id] = loaded->first(wanted);
}

Result<std::span<const char>> Data::load_buffer(Id id) {
  const std::string& uri = document_.buffers[id].uri;
  if (uri.empty()) {
    if (id == 0) return binary_chunk_;
    return job_.error(ErrorCode::corrupt, fmt::format("buffer {}", id), "it has no uri");
  }
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == uri.npos)
      return job_.error(ErrorCode::corrupt, fmt::format("buffer {}", id), "expected base64 data");
    return decode_base64(std::string_view(uri).substr(comma + 8));
  }
  const std::string name = percent_decoded(uri);
  if (!is_local_name(name)) {
    return job_.error(
        ErrorCode::invalid_input, fmt::format("buffer {}", id),
        "refused to read " + quote_word(name) + ": only files in the glTF file's folder are read");
  }
  auto file = MappedFile::open(job_.path.parent_path() / name);
  if (!file) return fail(std::move(file).error());
  file->close_descriptor();
  files_.push_back(std::move(*file));
  return files_.back().bytes();
}

Result<std::span<const char>> Data::decode_base64(std::string_view text) {
  while (text.ends_with('=')) text.remove_suffix(1);
  auto out = allocate(base64_, text.size() / 4 * 3 + text.size() % 4 * 3 / 4, 1, "bytes of base64 data");
  if (!out) return fail(std::move(out).error());
  std::uint32_t bits = 0;
  int held = 0;
  std::size_t n = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) return job_.error(ErrorCode::corrupt, "JSON", "a base64 buffer holds something else");
    bits = (bits << 6 | static_cast<std::uint32_t>(digit)) & 0xffffff;
    held += 6;
    if (held < 8) continue;
    held -= 8;
    (**out)[n++] = static_cast<char>(bits >> held & 0xff);
  }
  return std::span<const char>(**out);
}

Result<std::span<const char>> Data::slice(Id id, std::uint64_t offset, std::uint64_t bytes) {
  auto whole = buffer(id);
  if (!whole) return whole;
  if (offset > whole->size() || bytes > whole->size() - offset) {
    return job_.error(ErrorCode::corrupt, fmt::format("buffer {}", id),
                      fmt::format("{} bytes at {} reach beyond its {} bytes", bytes, offset, whole->size()));
  }
  return whole->subspan(offset, bytes);
}

Result<std::span<const char>> Data::view(Id id) {
  const View& v = document_.views[id];
  if (!v.meshopt) return slice(v.buffer, v.offset, v.bytes);
  if (const auto found = meshopt_views_.find(id); found != meshopt_views_.end()) return found->second;
  auto decoded = decode_meshopt(*v.meshopt);
  if (decoded) meshopt_views_[id] = *decoded;
  return decoded;
}

Result<std::span<const char>> Data::decode_meshopt(const Meshopt& m) {
  const auto corrupt = [&](const char* what) { return job_.error(ErrorCode::corrupt, "meshopt view", what); };
  const bool attributes = m.mode == MeshoptMode::attributes;
  const bool good_stride =
      attributes ? m.stride % 4 == 0 && m.stride >= 4 && m.stride <= 256 : m.stride == 2 || m.stride == 4;
  if (!good_stride) return corrupt("byteStride does not suit the mode");
  if (m.mode == MeshoptMode::triangles && m.count % 3 != 0)
    return corrupt("the count is not a multiple of three");
  if (m.filter == MeshoptFilter::octahedral && m.stride != 4 && m.stride != 8)
    return corrupt("byteStride does not suit the filter");
  if (m.filter == MeshoptFilter::quaternion && m.stride != 8)
    return corrupt("byteStride does not suit the filter");
  if (m.filter != MeshoptFilter::identity && !attributes)
    return corrupt("a filter needs the attributes mode");
  auto in = slice(m.buffer, m.offset, m.bytes);
  if (!in) return in;
  auto out = allocate(decoded_, m.count, m.stride, "meshopt elements");
  if (!out) return fail(std::move(out).error());
  // Its pages are in memory while it is decoded.
  CUESTA_TRY(job_.budget.charge(in->size(), 1, "bytes of meshopt data"));
  job_.budget.release(in->size());
  const auto* bytes = reinterpret_cast<const unsigned char*>(in->data());
  char* to = (**out).data();
  if (m.count == 0) return std::span<const char>(**out);
  const int status = attributes ? meshopt_decodeVertexBuffer(to, m.count, m.stride, bytes, in->size())
                     : m.mode == MeshoptMode::triangles
                         ? meshopt_decodeIndexBuffer(to, m.count, m.stride, bytes, in->size())
                         : meshopt_decodeIndexSequence(to, m.count, m.stride, bytes, in->size());
  release(in->data(), in->data() + in->size());
  if (status != 0) return corrupt("the compressed data is malformed");
  switch (m.filter) {
    case MeshoptFilter::identity:
      break;
    case MeshoptFilter::octahedral:
      meshopt_decodeFilterOct(to, m.count, m.stride);
      break;
    case MeshoptFilter::quaternion:
      meshopt_decodeFilterQuat(to, m.count, m.stride);
      break;
    case MeshoptFilter::exponential:
      meshopt_decodeFilterExp(to, m.count, m.stride);
      break;
  }
  return std::span<const char>(**out);
}

Result<Numbers> Data::packed(const Accessor& a, Id view_id, std::uint64_t offset, std::uint64_t count,
                             Component type, std::uint32_t components, std::uint64_t stride) {
  auto bytes = view(view_id);
  if (!bytes) return fail(std::move(bytes).error());
  const std::uint64_t element = bytes_of(type) * components;
  if (stride == 0) stride = element;
  const bool inside =
      count == 0 || (stride >= element && offset <= bytes->size() && element <= bytes->size() - offset &&
                     count - 1 <= (bytes->size() - offset - element) / stride);
  if (!inside) {
    return job_.error(
        ErrorCode::corrupt, fmt::format("bufferView {}", view_id),
        fmt::format("{} elements of {} bytes, {} apart, from byte {} on reach beyond its {} bytes", count,
                    element, stride, offset, bytes->size()));
  }
  return Numbers{
      count == 0 ? nullptr : bytes->data() + offset, stride, count, type, components, a.normalised};
}

Result<Numbers> Data::numbers(Id id) {
  const Accessor& a = document_.accessors[id];
  if (a.view != none && !a.sparse) {
    return packed(a, a.view, a.offset, a.count, a.component, a.components, document_.views[a.view].stride);
  }
  if (const auto found = materialised_.find(id); found != materialised_.end()) return found->second;
  auto made = materialised(a);
  if (made) materialised_[id] = *made;
  return made;
}

/// Accessors without a view are zeros; sparse ones replace some elements.
Result<Numbers> Data::materialised(const Accessor& a) {
  const std::uint64_t element = bytes_of(a.component) * a.components;
  auto out = allocate(decoded_, a.count, element, "elements of an accessor");
  if (!out) return fail(std::move(out).error());
  char* to = (**out).data();
  if (a.view != none) {
    auto base =
        packed(a, a.view, a.offset, a.count, a.component, a.components, document_.views[a.view].stride);
    if (!base) return base;
    for (std::uint64_t i = 0; i < a.count; ++i)
      std::memcpy(to + i * element, base->first + i * base->stride, element);
  }
  if (a.sparse) {
    const Sparse& s = *a.sparse;
    auto indices = packed(a, s.index_view, s.index_offset, s.count, s.index_type, 1, 0);
    if (!indices) return indices;
    auto values = packed(a, s.value_view, s.value_offset, s.count, a.component, a.components, 0);
    if (!values) return values;
    for (std::uint64_t i = 0; i < s.count; ++i) {
      const std::uint64_t target = indices->index(i);
      if (target >= a.count)
        return job_.error(ErrorCode::corrupt, "JSON", "a sparse index beyond the accessor's count");
      std::memcpy(to + target * element, values->first + i * values->stride, element);
    }
  }
  return Numbers{to, element, a.count, a.component, a.components, a.normalised};
}

}  // namespace cuesta::gltf
