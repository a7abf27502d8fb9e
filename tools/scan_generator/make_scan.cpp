#include "tools/scan_generator/make_scan.h"

#include <bit>
#include <cstring>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "ooc/atomic_file.h"
#include "tools/scan_generator/random.h"
#include "tools/scan_generator/subdivide.h"
#include "tools/scan_generator/surface_noise.h"

namespace cuesta::tools {
namespace {

static_assert(std::endian::native == std::endian::little, "records are copied as they are");
constexpr std::uint32_t unused = 0xffffffffu;
constexpr std::size_t block_bytes = 1u << 20;

double bounding_diagonal(const SurfaceMesh& mesh) {
  Box3d box;
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) box.add(mesh.positions[v]);
  }
  return box.empty() ? 0 : length(box.hi - box.lo);
}

/// A triangle soup, which subdivision would tear apart.
bool shares_no_vertex(const SurfaceMesh& mesh) {
  std::vector<bool> used(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (used[v]) return false;
      used[v] = true;
    }
  }
  return true;
}

/// Collects records and hands them to the file in large blocks.
class BlockWriter {
 public:
  explicit BlockWriter(AtomicFile& file) : file_(file) { block_.reserve(block_bytes + 64); }

  template <class Record>
  Result<void> add(const Record& record) {
    const auto bytes = std::as_bytes(std::span(&record, 1));
    block_.insert(block_.end(), bytes.begin(), bytes.end());
    return block_.size() < block_bytes ? Result<void>{} : flush();
  }
  Result<void> flush() {
    Result<void> written = file_.write(block_);
    block_.clear();
    return written;
  }

 private:
  AtomicFile& file_;
  std::vector<std::byte> block_;
};

struct Orders {
  std::vector<std::uint32_t> vertices;   ///< old numbers in file order
  std::vector<std::uint32_t> number;     ///< old number → place in the file
  std::vector<std::uint32_t> triangles;  ///< old numbers in file order; empty: as they are
};

Orders file_orders(const SurfaceMesh& mesh, ScanOrder order, std::uint64_t seed) {
  Orders orders;
  orders.number.assign(mesh.positions.size(), unused);
  for (const auto& t : mesh.triangles) {
    for (const std::uint32_t v : t) {
      if (orders.number[v] != unused) continue;
      orders.number[v] = static_cast<std::uint32_t>(orders.vertices.size());
      orders.vertices.push_back(v);
    }
  }
  if (order == ScanOrder::first_use) return orders;
  shuffle(std::span(orders.vertices), mixed(seed));
  for (std::uint32_t i = 0; i < orders.vertices.size(); ++i) orders.number[orders.vertices[i]] = i;
  orders.triangles.resize(mesh.triangles.size());
  std::iota(orders.triangles.begin(), orders.triangles.end(), 0u);
  shuffle(std::span(orders.triangles), mixed(seed + 1));
  return orders;
}

std::string header(std::size_t vertices, std::size_t triangles) {
  std::string text = "ply\nformat binary_little_endian 1.0\ncomment made by cuesta-make-scan\n";
  text += "element vertex " + std::to_string(vertices) + "\n";
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    text += std::string("property float ") + name + "\n";
  text +=
      "element face " + std::to_string(triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";
  return text;
}

Result<void> write_vertices(BlockWriter& writer, const SurfaceMesh& mesh, const Orders& orders) {
  for (const std::uint32_t v : orders.vertices) {
    const std::array<Vec3f, 2> record{vec_cast<float>(mesh.positions[v]), mesh.normals[v]};
    if (auto added = writer.add(record); !added) return added;
  }
  return {};
}

Result<void> write_triangles(BlockWriter& writer, const SurfaceMesh& mesh, const Orders& orders) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[orders.triangles.empty() ? i : orders.triangles[i]];
    std::array<std::byte, 13> record{std::byte{3}};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      std::memcpy(&record[1 + 4 * corner], &orders.number[t[corner]], 4);
    }
    if (auto added = writer.add(record); !added) return added;
  }
  return {};
}

}  // namespace

Result<SurfaceMesh> make_scan(const SurfaceMesh& input, const ScanOptions& options) {
  if (input.triangles.empty())
    return fail(ErrorCode::invalid_input, "", "", "expected a surface, found no triangles");
  if (input.triangles.size() > 1 && shares_no_vertex(input)) {
    return fail(ErrorCode::invalid_input, "", "",
                "no two triangles share a vertex; weld the mesh first (STL never is)");
  }
  SurfaceMesh mesh;
  mesh.positions = input.positions;
  mesh.triangles = input.triangles;
  while (mesh.triangles.size() < options.triangles) {
    Result<SurfaceMesh> finer = subdivide_loop(mesh);
    if (!finer) return finer;
    mesh = std::move(*finer);
  }
  set_normals(mesh);
  roughen(mesh, scan_octaves(mean_edge_length(mesh), options.roughness * bounding_diagonal(mesh)),
          options.seed);
  set_normals(mesh);
  return mesh;
}

Result<void> write_scan(const std::filesystem::path& path, const SurfaceMesh& mesh, ScanOrder order,
                        std::uint64_t seed) {
  if (mesh.normals.size() != mesh.positions.size()) {
    return fail(ErrorCode::invalid_input, path.string(), "", "expected one normal per vertex");
  }
  Result<AtomicFile> file = AtomicFile::create(path);
  if (!file) return fail(file.error());
  const Orders orders = file_orders(mesh, order, seed);
  const std::string text = header(orders.vertices.size(), mesh.triangles.size());
  if (auto ok = file->write(std::as_bytes(std::span(text))); !ok) return ok;
  BlockWriter writer(*file);
  if (auto ok = write_vertices(writer, mesh, orders); !ok) return ok;
  if (auto ok = write_triangles(writer, mesh, orders); !ok) return ok;
  if (auto ok = writer.flush(); !ok) return ok;
  return file->commit();
}

}  // namespace cuesta::tools
