/// glTF scenes: a part per mesh, an instance per node that shows one, or per element of its instancing.

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "ooc/gltf_chunks.h"
#include "ooc/gltf_clips.h"
#include "ooc/gltf_data.h"
#include "ooc/gltf_primitive.h"
#include "ooc/gltf_transform.h"
#include "ooc/scene_input.h"

namespace cuesta {
namespace gltf {
namespace {

constexpr std::array<float, 4> white{1, 1, 1, 1};

SceneMaterial scene_material(const Material& m) {
  std::array<double, 4> linear{};
  std::copy(m.base_colour.begin(), m.base_colour.end(), linear.begin());
  if (!m.blended) linear[3] = 1;
  return {m.name, stored_colour(linear), m.metallic, m.roughness, m.double_sided};
}

/// How a mesh is shown: what all of it has, or colours of its own.
struct Look {
  std::uint32_t part = no_index;  ///< no_index: the mesh has no triangles
  std::uint32_t material = no_index;
  bool has_colours = false;
};

class GltfScene : public SceneSource {
 public:
  GltfScene(SceneInput input, std::uint64_t memory_bytes)
      : input_(std::move(input)), budget_(memory_bytes), job_(job_for(no_sink_)) {}

  Result<void> open() {
    auto parsed = parse_file(job_);
    if (!parsed) return fail(std::move(parsed).error());
    document_ = std::move(parsed->document);
    data_.emplace(job_, document_, parsed->binary);
    make_materials();
    make_parts();
    CUESTA_TRY(make_nodes());
    CUESTA_TRY(make_clips());
    if (const auto fault = fault_of(scene_, parts_.size()); !fault.empty())
      return job_.error(ErrorCode::corrupt, "JSON", fault);
    note_what_is_left_out();
    return input_.check_unchanged();
  }

  std::vector<std::filesystem::path> files() const override {
    std::vector<std::filesystem::path> all{input_.path};
    const auto others = data_->paths_of_others();
    all.insert(all.end(), others.begin(), others.end());
    return all;
  }

  Result<ReadReport> read_part(std::uint32_t part, MeshSink& sink) override {
    const Id mesh = mesh_of_[part];
    const ReadJob job = job_for(sink);
    MeshEmitter out(job, {.normals = has_normals(mesh), .colours = looks_[mesh].has_colours});
    const std::array<Affine, 1> in_place{};
    std::uint64_t vertices = 0;
    for (const Primitive& p : document_.meshes[mesh].primitives) {
      if (!is_surface(p)) continue;
      const auto emitted = emit_primitive(job, document_, *data_, p, colour_of(p), in_place, vertices, out);
      if (!emitted) return fail(emitted.error());
      vertices = *emitted;
    }
    auto report = out.finish();
    CUESTA_TRY(data_->check_unchanged());
    CUESTA_TRY(input_.check_unchanged());
    return report;
  }

 private:
  ReadJob job_for(MeshSink& sink) {
    ReadJob job{input_.path, input_.file.bytes(), sink, budget_, no_progress_, {}};
    job.file = &input_.file;
    return job;
  }

  bool has_normals(Id mesh) const {
    const auto& primitives = document_.meshes[mesh].primitives;
    return std::any_of(primitives.begin(), primitives.end(),
                       [](const Primitive& p) { return is_surface(p) && p.normal != none; });
  }

  std::array<float, 4> colour_of(const Primitive& p) const {
    if (p.material == none) return white;
    auto colour = document_.materials[p.material].base_colour;
    if (!document_.materials[p.material].blended) colour[3] = 1;
    return colour;
  }

  void make_materials() {
    for (const Material& m : document_.materials) scene_.materials.push_back(scene_material(m));
  }

  /// The number of a material that is not in the file.
  std::uint32_t extra_material(const SceneMaterial& m) {
    const auto first = scene_.materials.begin() + static_cast<std::ptrdiff_t>(document_.materials.size());
    const auto at = std::find(first, scene_.materials.end(), m);
    const auto number = static_cast<std::uint32_t>(at - scene_.materials.begin());
    if (at == scene_.materials.end()) scene_.materials.push_back(m);
    return number;
  }

  /// glTF's own, of primitives without one.
  std::uint32_t default_material() { return extra_material({"", {255, 255, 255, 255}, 1, 1, false}); }

  /// Of a mesh with several: its colours go to the vertices, the first one decides about the rest.
  std::uint32_t mixed_material(const std::vector<std::uint32_t>& materials) {
    SceneMaterial mixed = scene_.materials[materials.front()];
    mixed.name = "vertex colours";
    mixed.base_colour = {255, 255, 255, 255};
    for (const std::uint32_t m : materials) mixed.double_sided |= scene_.materials[m].double_sided;
    return extra_material(mixed);
  }

  void make_parts() {
    looks_.resize(document_.meshes.size());
    for (Id mesh = 0; mesh < document_.meshes.size(); ++mesh) {
      std::vector<std::uint32_t> materials;
      for (const Primitive& p : document_.meshes[mesh].primitives) {
        if (!is_surface(p)) continue;
        materials.push_back(p.material == none ? default_material() : p.material);
        looks_[mesh].has_colours |= p.colour != none;
      }
      if (materials.empty()) continue;
      const bool is_mixed = std::any_of(materials.begin(), materials.end(),
                                        [&](std::uint32_t m) { return m != materials.front(); });
      looks_[mesh].part = static_cast<std::uint32_t>(parts_.size());
      looks_[mesh].has_colours |= is_mixed;
      looks_[mesh].material = is_mixed ? mixed_material(materials) : materials.front();
      parts_.push_back(document_.meshes[mesh].name);
      mesh_of_.push_back(mesh);
    }
  }

  Result<void> make_nodes() {
    const auto visits = visits_of(job_, document_);
    if (!visits) return fail(visits.error());
    node_of_.assign(document_.nodes.size(), no_index);
    CUESTA_TRY(job_.budget.charge(visits->size(), sizeof(SceneNode), "nodes"));
    scene_.nodes.reserve(visits->size());
    for (const Visit& visit : *visits) {
      const Node& node = document_.nodes[visit.node];
      node_of_[visit.node] = static_cast<std::uint32_t>(scene_.nodes.size());
      const std::uint32_t parent =
          visit.parent == no_index ? no_index : node_of_[(*visits)[visit.parent].node];
      scene_.nodes.push_back({node.name, parent, no_index, no_index, node.local});
      if (node.mesh != none) CUESTA_TRY(show(node));
    }
    return {};
  }

  /// Makes the last node an instance of its mesh, or gives it a child for each element of its instancing.
  Result<void> show(const Node& node) {
    const Look& look = looks_[node.mesh];
    if (!node.instancing.is_there()) {
      scene_.nodes.back().part = look.part;
      scene_.nodes.back().material = look.material;
      return {};
    }
    const auto placements = placements_of(job_, document_, node.instancing, *data_);
    if (!placements) return fail(placements.error());
    const auto parent = static_cast<std::uint32_t>(scene_.nodes.size() - 1);
    CUESTA_TRY(job_.budget.charge(placements->size(), 2 * sizeof(SceneNode), "instances"));
    for (const Trs& trs : *placements) scene_.nodes.push_back({"", parent, look.part, look.material, trs});
    return {};
  }

  Result<void> make_clips() {
    for (const Animation& animation : document_.animations) {
      auto clip = read_clip(job_, animation, *data_, node_of_, scene_, clip_report_);
      if (!clip) return fail(std::move(clip).error());
      if (!clip->channels.empty()) scene_.clips.push_back(std::move(*clip));
    }
    return {};
  }

  void warn(std::uint64_t count, const char* words) {
    if (count > 0) warnings_.push_back(fmt::format("{} {}", count, words));
  }

  void note_what_is_left_out() {
    const auto count = [](const auto& all, auto&& has) {
      return static_cast<std::uint64_t>(std::count_if(all.begin(), all.end(), has));
    };
    warn(count(document_.materials, [](const Material& m) { return m.textured; }),
         "materials have textures, which are not kept");
    warn(count(document_.meshes, [](const Mesh& m) { return m.has_morph_targets; }),
         "meshes have morph targets, which are not kept");
    warn(count(document_.nodes, [](const Node& n) { return n.skinned; }),
         "nodes have skins: shown as modelled, without");
    warn(count(looks_, [](const Look& l) { return l.part == no_index; }),
         "meshes are left out: points and lines only");
    warn(clip_report_.channels_dropped,
         "animation channels are not kept: not of a node's transform, or damaged");
    warn(clip_report_.keys_dropped, "animation keys dropped: not after the key before");
  }

  SceneInput input_;
  ReadBudget budget_;
  NoSink no_sink_;
  ReadProgress no_progress_;
  ReadJob job_;
  Document document_;
  std::optional<Data> data_;
  std::vector<Look> looks_;             ///< per mesh
  std::vector<Id> mesh_of_;             ///< per part
  std::vector<std::uint32_t> node_of_;  ///< per node of the document: of the scene
  ClipReport clip_report_;
};

}  // namespace
}  // namespace gltf

Result<std::unique_ptr<SceneSource>> open_gltf_scene(SceneInput input, std::uint64_t memory_bytes) {
  auto scene = std::make_unique<gltf::GltfScene>(std::move(input), memory_bytes);
  CUESTA_TRY(scene->open());
  return scene;
}

}  // namespace cuesta
