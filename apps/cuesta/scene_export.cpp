#include "apps/cuesta/scene_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "apps/cuesta/machine.h"
#include "apps/cuesta/progress.h"
#include "hierarchy/scene_file.h"
#include "hierarchy/scene_tom.h"
#include "ooc/mesh_writer.h"
#include "runtime/cut.h"
#include "runtime/extract.h"

namespace cuesta::app {
namespace {

/// How much the map stretches at most, and a little more: its columns' Frobenius norm.
double stretch(const Affine& a) {
  double sum = 0;
  for (const Vec3d& column : a.columns) sum += dot(column, column);
  return std::sqrt(sum);
}

/// One part, ready to be taken at any error.
class ExportedPart {
 public:
  static Result<ExportedPart> open(const SceneFile& file, std::uint32_t part, std::uint64_t cache_bytes) {
    ExportedPart out;
    const ScenePartEntry& entry = file.parts()[part];
    if (entry.is_tom()) {
      auto tom = read_tom(file, part, static_cast<std::uint32_t>(entry.segments.size()));
      if (!tom) return fail(tom.error());
      out.tom_ = std::move(*tom);
      return out;
    }
    auto surface = file.open_surface(part);
    if (!surface) return fail(surface.error());
    auto cut = Cut::open(std::move(*surface), cache_bytes, clock_ms);
    if (!cut) return fail(cut.error());
    out.cut_ = std::move(*cut);
    return out;
  }

  /// @param error  in units of the part; below zero: in full
  std::uint64_t triangles(double error) {
    if (cut_) return settle(error).triangles;
    return triangle_count(tom_, resolution(error));
  }
  Result<SurfaceMesh> mesh(double error) {
    if (!cut_) return surface_at(tom_, resolution(error));
    const AdaptReport report = settle(error);
    if (const auto errors = cut_->cache().errors(); !errors.empty()) return fail(errors.front());
    if (report.bound_by == Binding::resident_bytes)
      return fail(ErrorCode::out_of_budget, "", "",
                  "a part does not fit the page cache; give more with --cache");
    return extract_mesh(cut_->draw_list(), {cut_->directory().has_normals, cut_->directory().has_colours});
  }

 private:
  Resolution resolution(double error) const {
    const double left = error - double{tom_.snap_error};
    return error < 0 || left < 0 ? tom_.full() : resolution_of_error(tom_, static_cast<float>(left));
  }
  AdaptReport settle(double error) {
    const Grid& grid = cut_->directory().grid;
    return cut_->settle(ErrorScale::uniform(grid), error < 0 ? -1 : std::max(0.0, error - grid.snap_error()),
                        {});
  }

  Tom tom_;
  std::unique_ptr<Cut> cut_;
};

/// A part where the mesh shall have it.
struct Piece {
  std::uint32_t part = 0;
  Affine world;
  Rgba8 colour{255, 255, 255, 255};
};

Error nothing_named(const ExportSettings& s, const std::string& option, const std::string& name) {
  return {ErrorCode::invalid_input, s.file.string(), option,
          "nothing that can be seen is called \"" + name + "\"; cuesta info --parts tells the names"};
}

/// Nodes of the name, and all below them; all nodes without one.
Result<std::vector<Piece>> pieces_of_nodes(const SceneFile& file, const ExportSettings& s) {
  const std::vector<Affine> world = world_transforms(file.directory().scene);
  std::vector<bool> wanted;
  for (const SceneNode& node : file.nodes())
    wanted.push_back(s.node.empty() || node.name == s.node ||
                     (node.parent != no_index && wanted[node.parent]));
  std::vector<Piece> pieces;
  for (const SceneInstance& i : file.instances())
    if (wanted[i.node]) pieces.push_back({i.part, world[i.node], file.materials()[i.material].base_colour});
  if (pieces.empty() && !s.node.empty()) return fail(nothing_named(s, "--node", s.node));
  return pieces;
}

/// The part of the name, with the material of its first instance.
Result<std::vector<Piece>> piece_of_part(const SceneFile& file, const ExportSettings& s) {
  const auto parts = file.parts();
  for (const SceneInstance& i : file.instances())
    if (parts[i.part].name == s.part)
      return std::vector<Piece>{{i.part, {}, file.materials()[i.material].base_colour}};
  return fail(nothing_named(s, "--part", s.part));
}

class SceneExport {
 public:
  SceneExport(std::vector<Piece> pieces, std::map<std::uint32_t, ExportedPart> parts)
      : pieces_(std::move(pieces)), parts_(std::move(parts)) {}

  std::uint64_t triangles(double error) {
    std::uint64_t sum = 0;
    for (const Piece& p : pieces_) sum += parts_.at(p.part).triangles(local(p, error));
    return sum;
  }

  /// The least error, to a thousandth, whose triangles are not more.
  double error_of(std::uint64_t most, double diagonal) {
    double high = std::max(diagonal, 1e-30), low = high * 1e-9;
    if (triangles(low) <= most) return low;
    while (high > low * 1.001) {
      const double middle = std::sqrt(low * high);
      (triangles(middle) <= most ? high : low) = middle;
    }
    return high;
  }

  Result<SurfaceMesh> mesh(double error) {
    SurfaceMesh all;
    for (const Piece& p : pieces_) {
      const auto part = parts_.at(p.part).mesh(local(p, error));
      if (!part) return fail(part.error());
      if (auto r = append(*part, p, all); !r) return fail(r.error());
    }
    return all;
  }

 private:
  static double local(const Piece& p, double error) {
    return error < 0 ? -1 : error / std::max(stretch(p.world), std::numeric_limits<double>::min());
  }

  static Result<void> append(const SurfaceMesh& part, const Piece& p, SurfaceMesh& all) {
    const std::uint64_t first = all.positions.size();
    if (first + part.positions.size() >= std::numeric_limits<std::uint32_t>::max())
      return fail(ErrorCode::out_of_budget, "", "",
                  "more than 2^32 vertices do not fit one mesh; allow an error");
    for (std::size_t v = 0; v < part.positions.size(); ++v) {
      all.positions.push_back(p.world.point(part.positions[v]));
      const Vec3d n = part.normals.empty() ? Vec3d{} : vec_cast<double>(part.normals[v]);
      all.normals.push_back(vec_cast<float>(normalized(map_normal(p.world, n))));
      all.colours.push_back(part.colours.empty() ? p.colour : part.colours[v]);
    }
    const bool is_mirrored = determinant(p.world) < 0;
    for (auto t : part.triangles) {
      if (is_mirrored) std::swap(t[1], t[2]);
      for (std::uint32_t& v : t) v += static_cast<std::uint32_t>(first);
      all.triangles.push_back(t);
    }
    return {};
  }

  std::vector<Piece> pieces_;
  std::map<std::uint32_t, ExportedPart> parts_;
};

/// Each part once that is among the pieces.
Result<std::map<std::uint32_t, ExportedPart>> open_parts(const SceneFile& file, std::span<const Piece> pieces,
                                                         const ExportSettings& s, Progress& progress) {
  const std::uint64_t cache = s.cache_bytes > 0 ? s.cache_bytes : physical_memory_bytes() / 2;
  std::map<std::uint32_t, ExportedPart> parts;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    if (!progress.update("read", Unit::none, i, pieces.size()))
      return fail(ErrorCode::cancelled, s.file.string(), "", "stopped");
    if (parts.contains(pieces[i].part)) continue;
    auto part = ExportedPart::open(file, pieces[i].part, cache);
    if (!part) return fail(part.error());
    parts.emplace(pieces[i].part, std::move(*part));
  }
  return parts;
}

void tell(const ExportSettings& s, const SurfaceMesh& mesh, double error) {
  if (s.json) {
    nlohmann::ordered_json json{{"file", s.output.string()},
                                {"triangles", mesh.triangles.size()},
                                {"vertices", mesh.positions.size()}};
    if (error >= 0) json["error_asked"] = error;
    fmt::print("{}\n", json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
    return;
  }
  fmt::print("{}: {} triangles, {} vertices\n", s.output.string(), with_commas(mesh.triangles.size()),
             with_commas(mesh.positions.size()));
  if (error >= 0) fmt::print("largest error asked of an instance: {:.6g} units\n", error);
}

}  // namespace

Result<void> run_scene_export(const ExportSettings& s) {
  if (s.camera)
    return fail(ErrorCode::invalid_input, s.file.string(), "",
                "a scene is exported with --error, --triangles or --full, not for a camera");
  const auto file = SceneFile::open(s.file);
  if (!file) return fail(file.error());
  auto pieces = s.part.empty() ? pieces_of_nodes(*file, s) : piece_of_part(*file, s);
  if (!pieces) return fail(pieces.error());
  Progress progress(s.quiet);
  auto parts = open_parts(*file, *pieces, s, progress);
  if (!parts) return fail(parts.error());
  Box3d box;
  for (const Piece& p : *pieces) box.add(map_box(p.world, file->parts()[p.part].box));
  SceneExport scene(std::move(*pieces), std::move(*parts));
  progress.update("write", Unit::none, 0, 0);
  double error = s.full ? -1 : s.error.value_or(0);
  if (s.triangles)
    error = std::max(error, scene.error_of(*s.triangles, box.empty() ? 0 : length(box.hi - box.lo)));
  const auto mesh = scene.mesh(error);
  if (!mesh) return fail(mesh.error());
  if (auto r = write_mesh(s.output, *mesh); !r) return r;
  progress.finish();
  tell(s, *mesh, error);
  return {};
}

}  // namespace cuesta::app
