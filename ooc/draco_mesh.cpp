#include "ooc/draco_mesh.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <cstring>
#include <exception>
#include <limits>

#include "ooc/mesh_emitter.h"

namespace cuesta {
namespace {

/// What decoding takes at its peak, rounded up: meshes with positions alone were seen to take 65 to 75 bytes
/// per face (libdraco 1.5.5, edgebreaker, 0.5 to 40 million faces); every further attribute with seams adds a
/// corner table.
constexpr std::uint64_t decode_bytes_per_face = 120;
constexpr std::uint64_t decode_bytes_per_vertex = 80;
constexpr std::uint64_t decode_bytes_fixed = 1 << 20;

struct EncodedCounts {
  std::uint64_t faces = 0;
  std::uint64_t vertices = 0;
};

tl::unexpected<Error> corrupt(std::string what) {
  return fail(ErrorCode::corrupt, "", "", "Draco data: " + std::move(what));
}

bool read_count(draco::DecoderBuffer& buffer, bool varint, std::uint64_t& count) {
  std::uint32_t value = 0;
  const bool good = varint ? draco::DecodeVarint(&value, &buffer) : buffer.Decode(&value);
  count = value;
  return good;
}

/// Reads ahead of the library: what the bitstream says it holds, before anything is allocated for it.
Result<EncodedCounts> peek_counts(std::span<const char> bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  std::array<char, 5> magic{};
  std::uint8_t major = 0, minor = 0, kind = 0, method = 0;
  std::uint16_t flags = 0;
  if (!buffer.Decode(magic.data(), magic.size()) || std::memcmp(magic.data(), "DRACO", 5) != 0 ||
      !buffer.Decode(&major) || !buffer.Decode(&minor) || !buffer.Decode(&kind) || !buffer.Decode(&method) ||
      !buffer.Decode(&flags)) {
    return corrupt("expected a header of 11 bytes that starts with DRACO");
  }
  if (kind != 1) {
    return fail(ErrorCode::unsupported_version, "", "",
                "Draco data holds a point cloud, expected a triangle mesh");
  }
  if (major > 2 || (major == 2 && minor > 2)) {
    return fail(ErrorCode::unsupported_version, "", "",
                fmt::format("Draco bitstream {}.{}; 2.2 can be read", major, minor));
  }
  const int version = major * 16 + minor;
  buffer.set_bitstream_version(static_cast<std::uint16_t>(major << 8 | minor));
  if (flags & 0x8000) {
    draco::GeometryMetadata metadata;
    if (!draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata)) return corrupt("bad metadata");
  }
  EncodedCounts counts;
  bool good = true;
  if (method == 0) {
    good = read_count(buffer, version >= 0x22, counts.faces) &&
           read_count(buffer, version >= 0x22, counts.vertices);
  } else {
    std::uint8_t traversal = 0;
    std::uint64_t split_vertices = 0;
    good = buffer.Decode(&traversal) &&
           (version >= 0x22 || read_count(buffer, version >= 0x20, split_vertices)) &&
           read_count(buffer, version >= 0x20, counts.vertices) &&
           read_count(buffer, version >= 0x20, counts.faces);
  }
  if (!good) return corrupt("it ends before the numbers of faces and vertices");
  return counts;
}

template <class T>
double number(const T value, bool normalised) {
  const double v = static_cast<double>(value);
  if constexpr (std::is_integral_v<T>) {
    if (normalised) return std::max(v / static_cast<double>(std::numeric_limits<T>::max()), -1.0);
  }
  return v;
}

template <class T>
void read_values(const draco::PointAttribute& a, bool normalised, std::uint32_t first, std::uint32_t count,
                 std::size_t stride, double* out) {
  const std::size_t components = std::min<std::size_t>(a.num_components(), stride);
  std::array<T, 4> value{};
  for (std::uint32_t i = 0; i < count; ++i) {
    const draco::AttributeValueIndex index = a.mapped_index(draco::PointIndex(first + i));
    if (index.value() >= a.size()) continue;
    std::memcpy(value.data(), a.GetAddress(index), components * sizeof(T));
    for (std::size_t k = 0; k < components; ++k) out[i * stride + k] = number(value[k], normalised);
  }
}

}  // namespace

struct DracoMesh::Impl {
  std::unique_ptr<draco::Mesh> mesh;
  ReadBudget* budget = nullptr;
  std::uint64_t charged = 0;

  ~Impl() {
    if (budget) budget->release(charged);
  }
  std::uint64_t kept_bytes() const {
    std::uint64_t bytes = std::uint64_t{mesh->num_faces()} * 12;
    for (int i = 0; i < mesh->num_attributes(); ++i) {
      const draco::PointAttribute& a = *mesh->attribute(i);
      bytes += a.size() * static_cast<std::uint64_t>(a.byte_stride());
      if (!a.is_mapping_identity()) bytes += std::uint64_t{4} * mesh->num_points();
    }
    return bytes;
  }
};

DracoMesh::DracoMesh(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DracoMesh::DracoMesh(DracoMesh&&) noexcept = default;
DracoMesh& DracoMesh::operator=(DracoMesh&&) noexcept = default;
DracoMesh::~DracoMesh() = default;

Result<DracoMesh> DracoMesh::decode(std::span<const char> bytes, ReadBudget& budget) {
  const auto counts = peek_counts(bytes);
  if (!counts) return fail(counts.error());
  const std::uint64_t needed = counts->faces * decode_bytes_per_face +
                               counts->vertices * decode_bytes_per_vertex + decode_bytes_fixed + bytes.size();
  CUESTA_TRY(budget.charge(needed, 1, "bytes to decode Draco data"));
  auto impl = std::make_unique<Impl>();
  impl->budget = &budget;
  impl->charged = needed;
  try {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok()) return corrupt(decoded.status().error_msg_string());
    impl->mesh = std::move(decoded).value();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::out_of_budget, "", "", "Draco data needs more memory than the system has");
  } catch (const std::exception& e) {
    return corrupt(e.what());
  }
  if (!impl->mesh) return corrupt("no mesh in it");
  const std::uint64_t kept = impl->kept_bytes();
  budget.release(needed);
  impl->charged = 0;
  CUESTA_TRY(budget.charge(kept, 1, "bytes of decoded Draco data"));
  impl->charged = kept;
  return DracoMesh(std::move(impl));
}

std::uint32_t DracoMesh::vertices() const {
  return impl_->mesh->num_points();
}
std::uint32_t DracoMesh::triangles() const {
  return impl_->mesh->num_faces();
}
std::array<std::uint32_t, 3> DracoMesh::triangle(std::uint32_t i) const {
  const draco::Mesh::Face& face = impl_->mesh->face(draco::FaceIndex(i));
  return {face[0].value(), face[1].value(), face[2].value()};
}

int DracoMesh::find(DracoSemantic semantic) const {
  switch (semantic) {
    case DracoSemantic::position:
      return impl_->mesh->GetNamedAttributeId(draco::GeometryAttribute::POSITION);
    case DracoSemantic::normal:
      return impl_->mesh->GetNamedAttributeId(draco::GeometryAttribute::NORMAL);
    case DracoSemantic::colour:
      return impl_->mesh->GetNamedAttributeId(draco::GeometryAttribute::COLOR);
    case DracoSemantic::texcoord:
      return impl_->mesh->GetNamedAttributeId(draco::GeometryAttribute::TEX_COORD);
  }
  return -1;
}
int DracoMesh::find_id(std::uint32_t unique_id) const {
  return impl_->mesh->GetAttributeIdByUniqueId(unique_id);
}
int DracoMesh::components(int attribute) const {
  return impl_->mesh->attribute(attribute)->num_components();
}
bool DracoMesh::is_normalised(int attribute) const {
  return impl_->mesh->attribute(attribute)->normalized();
}
bool DracoMesh::is_real(int attribute) const {
  const draco::DataType type = impl_->mesh->attribute(attribute)->data_type();
  return type == draco::DT_FLOAT32 || type == draco::DT_FLOAT64;
}

void DracoMesh::read(int attribute, bool normalised, std::uint32_t first, std::uint32_t count,
                     std::size_t stride, double* out) const {
  const draco::PointAttribute& a = *impl_->mesh->attribute(attribute);
  switch (a.data_type()) {
    case draco::DT_INT8:
      return read_values<std::int8_t>(a, normalised, first, count, stride, out);
    case draco::DT_UINT8:
    case draco::DT_BOOL:
      return read_values<std::uint8_t>(a, normalised, first, count, stride, out);
    case draco::DT_INT16:
      return read_values<std::int16_t>(a, normalised, first, count, stride, out);
    case draco::DT_UINT16:
      return read_values<std::uint16_t>(a, normalised, first, count, stride, out);
    case draco::DT_INT32:
      return read_values<std::int32_t>(a, normalised, first, count, stride, out);
    case draco::DT_UINT32:
      return read_values<std::uint32_t>(a, normalised, first, count, stride, out);
    case draco::DT_INT64:
      return read_values<std::int64_t>(a, normalised, first, count, stride, out);
    case draco::DT_UINT64:
      return read_values<std::uint64_t>(a, normalised, first, count, stride, out);
    case draco::DT_FLOAT32:
      return read_values<float>(a, normalised, first, count, stride, out);
    case draco::DT_FLOAT64:
      return read_values<double>(a, normalised, first, count, stride, out);
    default:
      return;
  }
}

}  // namespace cuesta
