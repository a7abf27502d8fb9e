// cuesta-bench-simplify [--mesh=FILE] [--cells=N] [Google Benchmark's options]: the kernel simplify_cell,
// round by round. Without FILE the surface is a noisy sphere made here: 884,736 triangles, the same on every
// machine.
//
// Per round: µs per triangle of that round, and `script`, a fingerprint of all scripts and survivors in 52
// bits. Two versions with equal fingerprints gave the same results, bit for bit.
#include <benchmark/benchmark.h>
#include <xxhash.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "hierarchy/simplify_cell.h"
#include "ooc/grid_mesh.h"
#include "ooc/mesh_reader.h"

namespace {

using namespace cuesta;

constexpr std::uint32_t cell_triangles = 1u << 15;
constexpr std::uint32_t reduction = 4;

/// Triangles of one round in global vertex numbers, with what they carry.
struct Round {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<Birth> births;
  TriangleSamples samples;
};

using Cells = std::vector<std::vector<std::uint32_t>>;  // triangle numbers, ascending

/// Octahedron whose edges are cut `n` times, on a sphere with waves down to the length of an edge: 8 n²
/// triangles.
SurfaceMesh noisy_sphere(int n) {
  SurfaceMesh mesh;
  std::map<std::array<int, 3>, std::uint32_t> known;
  const auto vertex = [&](std::array<int, 3> g) {
    const auto [it, fresh] = known.try_emplace(g, static_cast<std::uint32_t>(mesh.positions.size()));
    if (fresh) {
      const Vec3d p = normalized(Vec3d{double(g[0]), double(g[1]), double(g[2])});
      double radius = 1, amplitude = 0.05;
      for (double f = 3; f < n; f *= 2.3, amplitude *= 0.45)
        radius += amplitude * std::sin(f * p.x + f) * std::cos(f * p.y - 1) * std::sin(f * 0.8 * p.z + 2);
      mesh.positions.push_back(p * radius);
    }
    return it->second;
  };
  for (int octant = 0; octant < 8; ++octant) {
    const int sx = octant & 1 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 4 ? -1 : 1;
    const auto corner = [&](int i, int j) { return vertex({sx * i, sy * j, sz * (n - i - j)}); };
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      if (sx * sy * sz < 0) std::swap(b, c);
      mesh.triangles.push_back({a, b, c});
    };
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j) {
        add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j + 1 < n) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
  }
  return mesh;
}

GridMesh make_surface(const std::string& file) {
  SurfaceMesh mesh;
  if (file.empty()) {
    mesh = noisy_sphere(332);
  } else {
    auto loaded = load_mesh(file, std::uint64_t{1} << 34);
    if (!loaded) {
      std::fprintf(stderr, "%s\n", loaded.error().text().c_str());
      std::exit(exit_status(loaded.error().code));
    }
    mesh = std::move(*loaded);
  }
  CleanOptions options;
  options.make_normals = false;
  CleanReport report;
  auto clean = clean_mesh(std::move(mesh), options, report);
  if (!clean) {
    std::fprintf(stderr, "%s\n", clean.error().text().c_str());
    std::exit(1);
  }
  return std::move(*clean);
}

/// Cuts in halves across the longest extent, along axes that differ from round to round.
void cut(const std::vector<Vec3d>& centres, std::span<std::uint32_t> part, Cells& cells) {
  if (part.size() <= cell_triangles) {
    std::sort(part.begin(), part.end());
    cells.emplace_back(part.begin(), part.end());
    return;
  }
  Box3d box;
  for (std::uint32_t t : part) box.add(centres[t]);
  const Vec3d e = box.hi - box.lo;
  const int axis = e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  const auto middle = part.begin() + static_cast<std::ptrdiff_t>(part.size() / 2);
  std::nth_element(part.begin(), middle, part.end(), [&](std::uint32_t a, std::uint32_t b) {
    return centres[a][axis] != centres[b][axis] ? centres[a][axis] < centres[b][axis] : a < b;
  });
  cut(centres, part.first(part.size() / 2), cells);
  cut(centres, part.subspan(part.size() / 2), cells);
}

Cells cut_round(const GridMesh& mesh, const Round& round, std::uint32_t number) {
  const double c = std::cos(number), s = std::sin(number);
  std::vector<Vec3d> centres;
  centres.reserve(round.triangles.size());
  for (const auto& t : round.triangles) {
    Vec3d sum;
    for (std::uint32_t v : t) sum = sum + vec_cast<double>(mesh.positions[v]);
    const Vec3d turned{c * sum.x - s * sum.y, s * sum.x + c * sum.y, sum.z};
    centres.push_back({turned.x, c * turned.y - s * turned.z, s * turned.y + c * turned.z});
  }
  std::vector<std::uint32_t> all(round.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  Cells cells;
  cut(centres, all, cells);
  return cells;
}

/// 1 for wedge groups that several cells use.
std::vector<std::uint8_t> shared_groups(const GridMesh& mesh, const Round& round, const Cells& cells) {
  std::vector<std::uint32_t> user(mesh.positions.size(), 0);
  std::vector<std::uint8_t> shared(mesh.positions.size(), 0);
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    for (std::uint32_t t : cells[c])
      for (std::uint32_t v : round.triangles[t]) {
        const std::uint32_t g = mesh.wedge_group[v];
        if (user[g] != 0 && user[g] != c + 1) shared[g] = 1;
        user[g] = c + 1;
      }
  return shared;
}

/// A cell, and the global numbers of its vertices.
struct CellInput {
  CellMesh mesh;
  std::vector<std::uint32_t> vertices;
};

CellInput cell_input(const GridMesh& mesh, const Round& round, const std::vector<std::uint32_t>& triangles,
                     const std::vector<std::uint8_t>& shared) {
  CellInput out;
  for (std::uint32_t t : triangles)
    out.vertices.insert(out.vertices.end(), round.triangles[t].begin(), round.triangles[t].end());
  std::sort(out.vertices.begin(), out.vertices.end());
  out.vertices.erase(std::unique(out.vertices.begin(), out.vertices.end()), out.vertices.end());
  std::uint32_t first = 0;
  for (std::uint32_t i = 0; i < out.vertices.size(); ++i) {
    const std::uint32_t v = out.vertices[i];
    if (i == 0 || mesh.wedge_group[out.vertices[i - 1]] != mesh.wedge_group[v]) first = i;
    out.mesh.positions.push_back(mesh.positions[v]);
    out.mesh.wedge_group.push_back(first);
    out.mesh.locked.push_back(shared[mesh.wedge_group[v]]);
  }
  const auto local = [&](std::uint32_t v) {
    const auto at = std::lower_bound(out.vertices.begin(), out.vertices.end(), v);
    return static_cast<std::uint32_t>(at - out.vertices.begin());
  };
  TriangleSamples& samples = out.mesh.samples;
  if (!round.samples.begin.empty()) samples.begin.push_back(0);
  for (std::uint32_t t : triangles) {
    const auto& g = round.triangles[t];
    out.mesh.triangles.push_back({local(g[0]), local(g[1]), local(g[2])});
    out.mesh.births.push_back(round.births.empty() ? Birth{} : round.births[t]);
    if (round.samples.begin.empty()) continue;
    const auto points = round.samples.points.begin();
    samples.points.insert(samples.points.end(), points + round.samples.begin[t],
                          points + round.samples.begin[t + 1]);
    samples.begin.push_back(static_cast<std::uint32_t>(samples.points.size()));
  }
  return out;
}

SimplifyOptions options_for(const CellMesh& cell, bool base) {
  SimplifyOptions options;
  options.target_triangles = base ? 0 : static_cast<std::uint32_t>(cell.triangles.size()) / reduction;
  return options;
}

void append(Round& next, const CellInput& cell, const CellSurvivors& survivors) {
  if (next.samples.begin.empty()) next.samples.begin.push_back(0);
  const auto base = static_cast<std::uint32_t>(next.samples.points.size());
  for (const auto& t : survivors.corners)
    next.triangles.push_back({cell.vertices[t[0]], cell.vertices[t[1]], cell.vertices[t[2]]});
  next.births.insert(next.births.end(), survivors.births.begin(), survivors.births.end());
  for (std::size_t i = 1; i < survivors.samples.begin.size(); ++i)
    next.samples.begin.push_back(base + survivors.samples.begin[i]);
  next.samples.points.insert(next.samples.points.end(), survivors.samples.points.begin(),
                             survivors.samples.points.end());
}

template <class T>
void hash(std::uint64_t& state, const std::vector<T>& v) {
  state = XXH3_64bits_withSeed(v.data(), v.size() * sizeof(T), state);
}

/// Field by field: structs may have padding.
std::uint64_t fingerprint(const SimplifyResult& result, std::uint64_t state) {
  std::vector<std::uint32_t> words;
  for (const Fan& f : result.script.fans) {
    words.insert(words.end(), {f.centre, f.first_child, f.child_count, f.sphere.radius});
    for (std::int8_t o : {f.sphere.offset_x, f.sphere.offset_y, f.sphere.offset_z})
      words.push_back(static_cast<std::uint8_t>(o));
  }
  for (const Child& c : result.script.children)
    words.insert(words.end(), {c.vertex, c.target, c.error, c.joined ? 1u : 0u});
  words.push_back(result.script.strict_fans);
  hash(state, words);
  hash(state, result.survivors.triangles);
  hash(state, result.survivors.corners);
  hash(state, result.survivors.samples.begin);
  auto points = result.survivors.samples.points;
  for (std::size_t t = 0; t + 1 < result.survivors.samples.begin.size(); ++t)  // a set per triangle
    std::sort(points.begin() + result.survivors.samples.begin[t],
              points.begin() + result.survivors.samples.begin[t + 1]);
  hash(state, points);
  return state;
}

/// What one round's benchmark needs: its cells, at most `most_cells` of them, and their results' fingerprint.
struct Work {
  std::vector<CellMesh> cells;
  std::uint64_t triangles = 0, samples = 0, fingerprint = 0;
  bool base = false;
};

std::vector<Work> all_rounds(const GridMesh& mesh, std::size_t most_cells) {
  std::vector<Work> work;
  Round round;
  round.triangles = mesh.triangles;
  for (std::uint32_t number = 0;; ++number) {
    const Cells cells = cut_round(mesh, round, number);
    const auto shared = shared_groups(mesh, round, cells);
    work.emplace_back();
    Work& w = work.back();
    w.base = cells.size() == 1;
    Round next;
    for (const auto& triangles : cells) {
      CellInput input = cell_input(mesh, round, triangles, shared);
      const SimplifyOptions options = options_for(input.mesh, w.base);
      if (w.cells.size() < most_cells) {
        w.cells.push_back(input.mesh);
        w.triangles += triangles.size();
        w.samples += input.mesh.samples.points.size();
      }
      const SimplifyResult result = simplify_cell(std::move(input.mesh), options);
      w.fingerprint = fingerprint(result, w.fingerprint);
      append(next, input, result.survivors);
    }
    if (w.base) return work;
    round = std::move(next);
  }
}

void simplify_round(benchmark::State& state, const Work& work) {
  for (auto _ : state) {
    for (const CellMesh& cell : work.cells) {
      state.PauseTiming();
      CellMesh copy = cell;
      const SimplifyOptions options = options_for(cell, work.base);
      state.ResumeTiming();
      benchmark::DoNotOptimize(simplify_cell(std::move(copy), options));
    }
  }
  const auto triangles = static_cast<double>(work.triangles);
  state.counters["s/triangle"] = benchmark::Counter(
      triangles, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["samples/triangle"] = static_cast<double>(work.samples) / triangles;
  state.counters["cells"] = static_cast<double>(work.cells.size());
  state.SetLabel("script " + std::to_string(work.fingerprint & ((std::uint64_t{1} << 52) - 1)));
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
  const std::vector<Work> rounds = all_rounds(make_surface(file), cells.empty() ? 8 : std::stoul(cells));
  for (std::size_t r = 0; r < rounds.size(); ++r)
    benchmark::RegisterBenchmark(("round_" + std::to_string(r)).c_str(), [&work = rounds[r]](
                                                                             benchmark::State& s) {
      simplify_round(s, work);
    })->Unit(benchmark::kMillisecond);
  benchmark::RunSpecifiedBenchmarks();
}
