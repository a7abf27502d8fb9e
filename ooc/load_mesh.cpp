/// load_mesh(): a file into a mesh in memory.

#include <algorithm>
#include <utility>
#include <vector>

#include "ooc/mesh_reader.h"
#include "ooc/read_job.h"

namespace cuesta {
namespace {

constexpr std::uint64_t most_vertices = 0xffff'fffe;

/// Collects blocks in vectors whose capacity is charged before they grow.
class CollectingSink : public MeshSink {
 public:
  CollectingSink(SurfaceMesh& mesh, ReadBudget& budget) : mesh_(mesh), budget_(budget) {}

  Result<void> expect(std::uint64_t vertices, std::uint64_t triangles) {
    if (vertices > most_vertices) return too_many();
    CUESTA_TRY(make_room(mesh_.positions, vertices, "vertices"));
    return make_room(mesh_.triangles, triangles, "triangles");
  }
  Result<void> vertices(const VertexBlock& block) override {
    CUESTA_TRY(check_count(mesh_.positions.size() + block.positions.size()));
    CUESTA_TRY(append(mesh_.positions, block.positions, "vertices"));
    CUESTA_TRY(append(mesh_.normals, block.normals, "vertex attributes"));
    CUESTA_TRY(append(mesh_.colours, block.colours, "vertex attributes"));
    return append(mesh_.texcoords, block.texcoords, "vertex attributes");
  }

  Result<void> triangles(TriangleBlock block) override {
    CUESTA_TRY(make_room(mesh_.triangles, block.size(), "triangles"));
    for (const auto& [a, b, c] : block) {
      if (std::max({a, b, c}) > most_vertices) return too_many();
      mesh_.triangles.push_back(
          {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
    }
    return {};
  }

 private:
  static tl::unexpected<Error> too_many() {
    return fail(ErrorCode::out_of_budget, "", "", "more than 2^32 - 2 vertices do not fit an in-memory mesh");
  }
  static Result<void> check_count(std::uint64_t count) {
    if (count > most_vertices) return too_many();
    return {};
  }

  /// While a vector moves, the old and the new storage both exist.
  template <class T>
  Result<void> reserve(std::vector<T>& v, std::uint64_t count, const char* what) {
    if (count <= v.capacity()) return {};
    const std::uint64_t old_bytes = v.capacity() * sizeof(T);
    CUESTA_TRY(budget_.charge(count, sizeof(T), what));
    v.reserve(count);
    budget_.release(old_bytes);
    return {};
  }
  /// Grows by half, or by less when only less is left.
  template <class T>
  Result<void> make_room(std::vector<T>& v, std::uint64_t more, const char* what) {
    const std::uint64_t needed = v.size() + more;
    if (needed <= v.capacity()) return {};
    const std::uint64_t generous = std::max<std::uint64_t>(needed, v.capacity() + v.capacity() / 2);
    return reserve(v, generous <= budget_.left() / sizeof(T) ? generous : needed, what);
  }
  template <class T>
  Result<void> append(std::vector<T>& v, std::span<const T> block, const char* what) {
    CUESTA_TRY(make_room(v, block.size(), what));
    v.insert(v.end(), block.begin(), block.end());
    return {};
  }

  SurfaceMesh& mesh_;
  ReadBudget& budget_;
};

}  // namespace

Result<SurfaceMesh> load_mesh(const std::filesystem::path& path, std::uint64_t memory_bytes,
                              ReadReport* report, const ReadProgress& progress,
                              const std::filesystem::path& temp, const VolumeOptions& volume) {
  SurfaceMesh mesh;
  ReadBudget budget(memory_bytes);
  CollectingSink sink(mesh, budget);
  const auto read = read_into(
      path, sink, budget, progress, temp,
      [&sink](std::uint64_t v, std::uint64_t t) { return sink.expect(v, t); }, volume);
  if (!read) return fail(read.error());
  if (report) *report = *read;
  return mesh;
}

}  // namespace cuesta
