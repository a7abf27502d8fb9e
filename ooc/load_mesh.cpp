/// load_mesh() and load_meshes(): files of any number into one mesh in memory.

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "ooc/mapped_file.h"
#include "ooc/mesh_reader.h"
#include "ooc/read_job.h"

namespace cuesta {
namespace {

constexpr std::uint64_t most_vertices = 0xffff'fffe;
constexpr Vec3f no_normal{0, 0, 0};
constexpr Rgba8 no_colour{255, 255, 255, 255};
constexpr TexCoord no_texcoord{0, 0};

/// Collects blocks in vectors whose capacity is charged before they grow.
class CollectingSink : public MeshSink {
 public:
  CollectingSink(SurfaceMesh& mesh, ReadBudget& budget) : mesh_(mesh), budget_(budget) {}

  Result<void> expect(std::uint64_t vertices, std::uint64_t triangles) {
    if (vertices > most_vertices) return too_many();
    CUESTA_TRY(make_room(mesh_.positions, vertices, "vertices"));
    return make_room(mesh_.triangles, triangles, "triangles");
  }
  /// What comes next is another file: its indices count from its own first vertex.
  void begin_file() { first_vertex_ = mesh_.positions.size(); }
  std::uint64_t held_bytes() const { return held_bytes_; }
  /// @return the vertices that have got a value for want of one, by attribute.
  Result<MissingAttributes> finish() {
    CUESTA_TRY(fill_up(mesh_.positions.size()));
    return missing_;
  }

  Result<void> vertices(const VertexBlock& block) override {
    CUESTA_TRY(check_count(mesh_.positions.size() + block.positions.size()));
    const std::size_t before = mesh_.positions.size();
    CUESTA_TRY(append(mesh_.positions, block.positions, "vertices"));
    CUESTA_TRY(append_attribute(mesh_.normals, block.normals, no_normal, before, missing_.normals));
    CUESTA_TRY(append_attribute(mesh_.colours, block.colours, no_colour, before, missing_.colours));
    return append_attribute(mesh_.texcoords, block.texcoords, no_texcoord, before, missing_.texcoords);
  }

  Result<void> triangles(TriangleBlock block) override {
    CUESTA_TRY(make_room(mesh_.triangles, block.size(), "triangles"));
    for (auto [a, b, c] : block) {
      if ((a | b | c) >> 32) return too_many();
      a += first_vertex_, b += first_vertex_, c += first_vertex_;
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
    held_bytes_ += v.capacity() * sizeof(T) - old_bytes;
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

  /// Elements up to `count` for the vertices whose file has no such attribute, if any file has it.
  template <class T>
  Result<void> fill(std::vector<T>& v, const T& value, std::size_t count, std::uint64_t& missing) {
    CUESTA_TRY(make_room(v, count - v.size(), "vertex attributes"));
    missing += count - v.size();
    v.resize(count, value);
    return {};
  }
  template <class T>
  Result<void> append_attribute(std::vector<T>& v, std::span<const T> block, const T& value,
                                std::size_t before, std::uint64_t& missing) {
    if (block.empty()) return {};
    CUESTA_TRY(fill(v, value, before, missing));
    return append(v, block, "vertex attributes");
  }
  Result<void> fill_up(std::size_t count) {
    if (!mesh_.normals.empty()) CUESTA_TRY(fill(mesh_.normals, no_normal, count, missing_.normals));
    if (!mesh_.colours.empty()) CUESTA_TRY(fill(mesh_.colours, no_colour, count, missing_.colours));
    if (!mesh_.texcoords.empty()) CUESTA_TRY(fill(mesh_.texcoords, no_texcoord, count, missing_.texcoords));
    return {};
  }

  SurfaceMesh& mesh_;
  std::uint64_t first_vertex_ = 0;
  std::uint64_t held_bytes_ = 0;
  MissingAttributes missing_;
  ReadBudget& budget_;
};

/// Sizes for the progress; a name that is wrong is told before hours of reading.
Result<std::vector<std::uint64_t>> file_sizes(std::span<const std::filesystem::path> paths) {
  std::vector<std::uint64_t> sizes;
  for (const auto& path : paths) {
    const auto file = MappedFile::open(path);
    if (!file) return fail(file.error());
    sizes.push_back(file->bytes().size());
  }
  return sizes;
}

}  // namespace

Result<LoadedMeshes> load_meshes(std::span<const std::filesystem::path> paths, std::uint64_t memory_bytes,
                                 const ReadProgress& progress, const std::filesystem::path& temp,
                                 const VolumeOptions& volume) {
  const auto sizes = file_sizes(paths);
  if (!sizes) return fail(sizes.error());
  const std::uint64_t total = std::accumulate(sizes->begin(), sizes->end(), std::uint64_t{0});
  LoadedMeshes loaded;
  ReadBudget budget(memory_bytes);
  CollectingSink sink(loaded.mesh, budget);
  for (std::uint64_t before = 0; const auto& path : paths) {
    sink.begin_file();
    const std::uint64_t size = (*sizes)[loaded.files.size()];
    const ReadProgress within = [&](std::uint64_t done, std::uint64_t) {
      return !progress || progress(std::min(before + done, total), total);
    };
    auto report = read_into(
        path, sink, budget, within, temp,
        [&sink](std::uint64_t v, std::uint64_t t) { return sink.expect(v, t); }, volume);
    if (!report) return fail(std::move(report).error());
    budget.keep(sink.held_bytes());
    loaded.files.push_back(*report);
    before += size;
  }
  auto missing = sink.finish();
  if (!missing) return fail(std::move(missing).error());
  loaded.missing = *missing;
  return loaded;
}

Result<SurfaceMesh> load_mesh(const std::filesystem::path& path, std::uint64_t memory_bytes,
                              ReadReport* report, const ReadProgress& progress,
                              const std::filesystem::path& temp, const VolumeOptions& volume) {
  auto loaded = load_meshes({&path, 1}, memory_bytes, progress, temp, volume);
  if (!loaded) return fail(std::move(loaded).error());
  if (report) *report = loaded->files.front();
  return std::move(loaded->mesh);
}

}  // namespace cuesta
