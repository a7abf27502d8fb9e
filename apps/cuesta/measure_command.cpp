#include "apps/cuesta/measure_command.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "apps/cuesta/stop_signal.h"
#include "apps/cuesta/text_forms.h"
#include "apps/measure/surface_distance.h"
#include "ooc/mesh_reader.h"

namespace cuesta::app {
namespace {

using nlohmann::ordered_json;

struct Measured {
  std::uint64_t triangles_a = 0, triangles_b = 0;
  double diagonal = 0;  // of A
  measure::SymmetricDistance distance;
  double vertices_max = 0;  // A's vertices to B
};

Result<SurfaceMesh> load(const std::filesystem::path& path, std::uint64_t memory_bytes, Progress& progress) {
  auto mesh = load_mesh(path, memory_bytes, nullptr, [&](std::uint64_t done, std::uint64_t total) {
    return progress.update("read " + path.filename().string(), Unit::bytes, done, total);
  });
  if (!mesh) return fail(mesh.error());
  if (mesh->triangles.empty())
    return fail(ErrorCode::invalid_input, path.string(), "", "the mesh has no triangles");
  return mesh;
}

Measured measure_meshes(const SurfaceMesh& a, const SurfaceMesh& b, std::uint64_t samples) {
  Measured m;
  m.triangles_a = a.triangles.size();
  m.triangles_b = b.triangles.size();
  m.diagonal = measure::bounding_diagonal(a);
  m.distance = measure::symmetric_distance(a, b, {samples, 1});
  m.vertices_max = measure::vertex_distance(a, measure::make_tree(b)).percentiles.max;
  return m;
}

ordered_json as_json(double mean, double rms, double max, double diagonal) {
  const double percent = diagonal > 0 ? 100 / diagonal : 0;
  return {{"mean", mean},
          {"rms", rms},
          {"max", max},
          {"mean_percent", mean * percent},
          {"rms_percent", rms * percent},
          {"max_percent", max * percent}};
}

std::string json_text(const MeasureSettings& s, const Measured& m) {
  const auto& [forward, backward, mean, rms, max] = m.distance;
  ordered_json json;
  json["a"] = {{"file", s.a.string()}, {"triangles", m.triangles_a}, {"diagonal", m.diagonal}};
  json["b"] = {{"file", s.b.string()}, {"triangles", m.triangles_b}};
  json["samples"] = s.samples;
  json["a_to_b"] = as_json(forward.mean, forward.rms, forward.max, m.diagonal);
  json["b_to_a"] = as_json(backward.mean, backward.rms, backward.max, m.diagonal);
  json["symmetric"] = as_json(mean, rms, max, m.diagonal);
  json["vertices_of_a_max"] = m.vertices_max;
  return json.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

std::string row(std::string_view name, double mean, double rms, double max, double diagonal) {
  const double percent = diagonal > 0 ? 100 / diagonal : 0;
  return fmt::format("  {:<10}{:>12.5g}{:>12.5g}{:>12.5g}   {:>10.5f}{:>10.5f}{:>10.5f}\n", name, mean, rms,
                     max, mean * percent, rms * percent, max * percent);
}

std::string table(const MeasureSettings& s, const Measured& m) {
  const auto& [forward, backward, mean, rms, max] = m.distance;
  std::string text =
      fmt::format("A {}: {} triangles, diagonal {:.6g}\nB {}: {} triangles\n{} samples each way\n\n",
                  s.a.string(), with_commas(m.triangles_a), m.diagonal, s.b.string(),
                  with_commas(m.triangles_b), with_commas(s.samples));
  text += fmt::format("  {:<10}{:>12}{:>12}{:>12}   {:>10}{:>10}{:>10}\n", "", "mean", "rms", "max", "mean %",
                      "rms %", "max %");
  text += row("A to B", forward.mean, forward.rms, forward.max, m.diagonal);
  text += row("B to A", backward.mean, backward.rms, backward.max, m.diagonal);
  text += row("symmetric", mean, rms, max, m.diagonal);
  return text + fmt::format("\nFarthest vertex of A from B: {:.6g}. Per cent are of A's diagonal.\n",
                            m.vertices_max);
}

}  // namespace

Result<void> run_measure(const MeasureSettings& s) {
  const std::uint64_t memory = s.memory_bytes > 0 ? s.memory_bytes : physical_memory_bytes() / 4 * 3;
  Progress progress(s.quiet);
  const auto a = load(s.a, memory, progress);
  if (!a) return fail(a.error());
  const auto b = load(s.b, memory, progress);
  if (!b) return fail(b.error());
  progress.update("measure", Unit::none, 0, 0);
  const Measured measured = measure_meshes(*a, *b, s.samples);
  progress.finish();
  if (auto r = check_stop(); !r) return r;
  fmt::print("{}", s.json ? json_text(s, measured) : table(s, measured));
  return {};
}

}  // namespace cuesta::app
