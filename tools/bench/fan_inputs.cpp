#include "tools/bench/fan_inputs.h"

#include <tbb/global_control.h>

#include <chrono>
#include <ctime>

#include "ooc/ingest.h"
#include "ooc/mesh_reader.h"
#include "ooc/mesh_writer.h"
#include "runtime/extract.h"
#include "runtime/view_fit.h"

namespace cuesta::bench {
namespace {

constexpr std::uint64_t memory_bytes = std::uint64_t{6} << 30;

class Stopwatch {
 public:
  Seconds seconds() const { return {wall() - wall_, processor() - processor_}; }

 private:
  static double wall() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
  }
  static double processor() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) * 1e-9;
  }
  double wall_ = wall(), processor_ = processor();
};

Result<std::vector<ReadReport>> read_into(RawSurface& sink, const std::filesystem::path& mesh,
                                          const std::filesystem::path& temp) {
  sink.begin_input();
  auto report = read_mesh(mesh, sink, memory_bytes / 2, {}, temp);
  if (!report) return fail(report.error());
  return std::vector<ReadReport>{*report};
}

}  // namespace

Result<Built> build_file(const std::filesystem::path& mesh, const std::filesystem::path& out, int threads) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(threads));
  auto folder = WorkFolder::open(out.string() + ".work", "fan bench", false);
  if (!folder) return fail(folder.error());
  MemoryBudget memory(memory_bytes);
  Built built;
  const Stopwatch ingesting;
  const auto surface =
      ingest(*folder, {}, memory, [&](RawSurface& sink) { return read_into(sink, mesh, folder->path()); });
  if (!surface) return fail(surface.error());
  built.ingest = ingesting.seconds();
  const Stopwatch building;
  auto report = build_hierarchy(*surface, out, {}, *folder, memory);
  if (!report) return fail(report.error());
  built.build = building.seconds();
  built.report = *report;
  folder->remove();
  return built;
}

Result<BuiltTree> build_tree(Cut& cut) {
  const Grid& grid = cut.directory().grid;
  cut.settle(ErrorScale::uniform(grid), -1, {});
  auto mesh = extract_mesh(cut.draw_list(), {false, false});
  if (!mesh) return fail(mesh.error());
  std::vector<Vec3f> positions;
  positions.reserve(mesh->positions.size());
  for (const Vec3d& p : mesh->positions) positions.push_back(vec_cast<float>(grid.snap(p)));
  mesh->positions = {};
  const Stopwatch building;
  BuiltTree built{baselines::build_view_dependence_tree(positions, mesh->triangles), {}};
  built.build = building.seconds();
  return built;
}

Result<void> write_scene(const std::filesystem::path& out, std::span<const std::filesystem::path> meshes) {
  SurfaceMesh scene;
  double along = 0;
  for (const auto& path : meshes) {
    auto mesh = load_mesh(path, memory_bytes);
    if (!mesh) return fail(mesh.error());
    const Box3d box = box_of(mesh->positions);
    const double scale = 1 / length(box.hi - box.lo);
    const auto first = static_cast<std::uint32_t>(scene.positions.size());
    for (const Vec3d& p : mesh->positions)
      scene.positions.push_back((p - box.lo) * scale + Vec3d{along, 0, 0});
    for (const auto& [a, b, c] : mesh->triangles)
      scene.triangles.push_back({first + a, first + b, first + c});
    along += (box.hi.x - box.lo.x) * scale + 0.1;
  }
  return write_mesh(out, scene);
}

}  // namespace cuesta::bench
