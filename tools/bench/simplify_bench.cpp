// cuesta-bench-simplify [--mesh=FILE] [--cells=N] [Google Benchmark's options]: the kernel simplify_cell,
// round by round. Without FILE the surface is a noisy sphere made here: 881,792 triangles, the same on every
// machine.
//
// Per round: µs per triangle of that round, and `result`, a fingerprint of all its pages and survivors in 52
// bits. Two versions with equal fingerprints gave the same results, bit for bit.
#include <benchmark/benchmark.h>
#include <unistd.h>
#include <xxhash.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "hierarchy/cell_task.h"
#include "hierarchy/input_chunk.h"
#include "hierarchy/page_survivors.h"
#include "hierarchy/simplify_cell.h"
#include "ooc/ingest.h"
#include "ooc/mesh_reader.h"

namespace {

using namespace cuesta;

constexpr std::uint32_t cell_triangles = 1u << 15;
constexpr std::uint32_t reduction = 4;
constexpr std::uint64_t memory_bytes = std::uint64_t{1} << 34;

void stop(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  std::exit(exit_status(error.code));
}

template <class T>
T value_of(Result<T> result) {
  if (!result) stop(result.error());
  return std::move(*result);
}

/// A point of an octahedron, on a sphere with waves down to the length of an edge.
Vec3d noisy_point(int x, int y, int z, int finest) {
  const Vec3d p = normalized(Vec3d{double(x), double(y), double(z)});
  double radius = 1, amplitude = 0.05;
  for (double f = 3; f < finest; f *= 2.3, amplitude *= 0.45)
    radius += amplitude * std::sin(f * p.x + f) * std::cos(f * p.y - 1) * std::sin(f * 0.8 * p.z + 2);
  return p * radius;
}

/// Octahedron whose edges are cut `n` times: 8 n² triangles, each with corners of its own, row by row.
Result<std::vector<ReadReport>> noisy_sphere(RawSurface& sink, int n) {
  sink.begin_input();
  std::uint64_t corners = 0;
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto corner = [&](int i, int j) { return noisy_point(sx * i, sy * j, sz * (n - i - j), n); };
    for (int i = 0; i < n; ++i) {
      std::vector<Vec3d> row;
      const auto add = [&](Vec3d a, Vec3d b, Vec3d c) {
        if (sx * sy * sz < 0) std::swap(b, c);
        row.insert(row.end(), {a, b, c});
      };
      for (int j = 0; i + j < n; ++j) {
        add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
      if (auto r = sink.vertices({row, {}, {}, {}}); !r) return fail(r.error());
      std::vector<std::array<std::uint64_t, 3>> triangles;
      for (std::size_t t = 0; t < row.size(); t += 3, corners += 3)
        triangles.push_back({corners, corners + 1, corners + 2});
      if (auto r = sink.triangles(triangles); !r) return fail(r.error());
    }
  }
  return std::vector<ReadReport>(1);
}

/// The whole surface as one chunk of the first round.
InputChunk load_surface(const std::string& file) {
  const auto path = std::filesystem::temp_directory_path() / ("cuesta-bench-" + std::to_string(::getpid()));
  WorkFolder folder = value_of(WorkFolder::open(path, "bench", false));
  MemoryBudget memory(memory_bytes);
  const auto read = [&](RawSurface& sink) -> Result<std::vector<ReadReport>> {
    if (file.empty()) return noisy_sphere(sink, 332);
    sink.begin_input();
    const auto report = read_mesh(file, sink, memory_bytes);
    if (!report) return fail(report.error());
    return std::vector{*report};
  };
  auto surface = ingest(folder, {.make_normals = false, .chunk_triangles = ~0u}, memory, read);
  if (!surface) folder.remove();
  auto chunk = load_input_chunk(value_of(std::move(surface)), 0, cell_triangles);
  folder.remove();
  return value_of(std::move(chunk));
}

/// What one round's benchmark needs: its cells, at most `most_cells` of them, and all results' fingerprint.
struct Work {
  std::vector<CellMesh> cells;
  std::uint64_t triangles = 0, samples = 0, fingerprint = 0;
  bool base = false;

  void add(const CellMesh& cell) {
    cells.push_back(cell);
    triangles += cell.triangles.size();
    samples += cell.samples.points.size();
  }
  void add_result(const std::vector<std::byte>& bytes) {
    fingerprint = XXH3_64bits_withSeed(bytes.data(), bytes.size(), fingerprint);
  }
};

std::vector<Work> all_rounds(InputChunk input, std::size_t most_cells) {
  std::vector<Work> rounds;
  RoundChunk chunk = std::move(input.chunk);
  Partition partition = std::move(input.cells);
  const SpaceTree everywhere({}, 1, identity_axes);
  for (std::uint32_t round = 0;; ++round) {
    const CellOptions options{round, partition.cell_count() == 1, reduction, nullptr};
    const RoundCells cells(chunk, std::move(partition));
    ChunkCollector next(everywhere, 0);
    Work& work = rounds.emplace_back();
    work.base = options.base;
    for (std::uint32_t c = 0; c < cells.cell_count(); ++c) {
      Cell cell = cells.cell(c);
      if (c < most_cells) work.add(cell.mesh);
      const CellOutput out = value_of(run_cell_task(std::move(cell), chunk, IngestedSurface(), options));
      work.add_result(out.page);
      work.add_result(out.survivors);
      if (!options.base) next.add(c, value_of(decode_survivors(out.survivors)));
    }
    if (options.base) return rounds;
    chunk = next.take();
    partition = partition_cells(triangle_centres(chunk.triangles, chunk.vertices.positions), cell_triangles,
                                round + 1);
  }
}

void simplify_round(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    for (const CellMesh& cell : work.cells) {
      state.PauseTiming();
      CellMesh copy = cell;
      SimplifyOptions options;
      if (!work.base)
        options.target_triangles = static_cast<std::uint32_t>(cell.triangles.size()) / reduction;
      state.ResumeTiming();
      benchmark::DoNotOptimize(simplify_cell(std::move(copy), options));
    }
  }
  const auto triangles = static_cast<double>(work.triangles);
  state.counters["s/triangle"] = benchmark::Counter(
      triangles, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["samples/triangle"] = static_cast<double>(work.samples) / triangles;
  state.counters["cells"] = static_cast<double>(work.cells.size());
  state.SetLabel("result " + std::to_string(work.fingerprint & ((std::uint64_t{1} << 52) - 1)));
}

/// Takes --NAME=VALUE out of the arguments.
std::string take_option(int& argc, char** argv, const std::string& prefix) {
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]).substr(0, prefix.size()) != prefix) continue;
    std::string value = argv[i] + prefix.size();
    std::copy(argv + i + 1, argv + argc, argv + i);
    --argc;
    return value;
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  const std::string file = take_option(argc, argv, "--mesh=");
  const std::string cells = take_option(argc, argv, "--cells=");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  const std::vector<Work> rounds = all_rounds(load_surface(file), cells.empty() ? 8 : std::stoul(cells));
  for (std::size_t r = 0; r < rounds.size(); ++r)
    benchmark::RegisterBenchmark(("round_" + std::to_string(r)).c_str(), [&work = rounds[r]](
                                                                             benchmark::State& s) {
      simplify_round(s, work);
    })->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
