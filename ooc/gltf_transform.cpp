#include "ooc/gltf_transform.h"

#include <fmt/format.h>

#include "ooc/gltf_data.h"

namespace cuesta::gltf {
namespace {

/// The numbers of an attribute of an instancing, or none.
Result<std::optional<Numbers>> attribute(const ReadJob& job, Data& data, Id accessor,
                                         std::uint32_t components) {
  if (accessor == none) return std::optional<Numbers>();
  auto numbers = data.numbers(accessor);
  if (!numbers) return fail(std::move(numbers).error());
  if (numbers->components < components)
    return job.error(ErrorCode::corrupt, fmt::format("accessor {}", accessor),
                     fmt::format("expected {} components, found {}", components, numbers->components));
  return std::optional<Numbers>(*numbers);
}

Vec3d vector_at(const Numbers& n, std::uint64_t i) {
  return {n.real(i, 0), n.real(i, 1), n.real(i, 2)};
}

}  // namespace

Result<std::vector<Trs>> placements_of(const ReadJob& job, const Document& document,
                                       const Instancing& instancing, Data& data) {
  const Id any = instancing.translation != none ? instancing.translation
                 : instancing.rotation != none  ? instancing.rotation
                                                : instancing.scale;
  if (any == none) return std::vector<Trs>(1);
  const std::uint64_t count = document.accessors[any].count;
  auto translation = attribute(job, data, instancing.translation, 3);
  if (!translation) return fail(std::move(translation).error());
  auto rotation = attribute(job, data, instancing.rotation, 4);
  if (!rotation) return fail(std::move(rotation).error());
  auto scale = attribute(job, data, instancing.scale, 3);
  if (!scale) return fail(std::move(scale).error());
  for (const auto* numbers : {&*translation, &*rotation, &*scale})
    if (*numbers && (*numbers)->count != count)
      return job.error(ErrorCode::corrupt, "JSON", "attributes of an instancing have different counts");
  CUESTA_TRY(job.budget.charge(count, sizeof(Trs) + 2 * sizeof(Affine), "instances"));
  std::vector<Trs> placements(count);
  for (std::uint64_t i = 0; i < count; ++i) {
    if (*translation) placements[i].translation = vector_at(**translation, i);
    if (*scale) placements[i].scale = vector_at(**scale, i);
    for (std::uint32_t k = 0; *rotation && k < 4; ++k) placements[i].rotation[k] = (*rotation)->real(i, k);
  }
  return placements;
}

Result<std::vector<Visit>> visits_of(const ReadJob& job, const Document& document) {
  // Each node is once on the stack and once in the list.
  CUESTA_TRY(job.budget.charge(document.nodes.size(), 2 * sizeof(Visit), "nodes"));
  std::vector<Visit> visits, stack;
  visits.reserve(document.nodes.size());
  std::vector<bool> reached(document.nodes.size(), false);
  for (const Id root : document.roots) {
    if (reached[root]) continue;
    reached[root] = true;
    stack.push_back({root, no_index});
    while (!stack.empty()) {
      const auto here = static_cast<std::uint32_t>(visits.size());
      visits.push_back(stack.back());
      stack.pop_back();
      const Node& node = document.nodes[visits.back().node];
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
        if (reached[*child]) {
          return job.error(ErrorCode::corrupt, fmt::format("node {}", *child),
                           "it has two parents or is its own ancestor");
        }
        reached[*child] = true;
        stack.push_back({*child, here});
      }
    }
  }
  return visits;
}

Result<std::vector<std::vector<Affine>>> instances_of(const ReadJob& job, const Document& document,
                                                      Data& data) {
  const auto visits = visits_of(job, document);
  if (!visits) return fail(visits.error());
  CUESTA_TRY(job.budget.charge(document.nodes.size(), 3 * sizeof(Affine), "nodes"));
  std::vector<std::vector<Affine>> instances(document.meshes.size());
  std::vector<Affine> world;
  world.reserve(visits->size());
  for (const Visit& visit : *visits) {
    const Node& node = document.nodes[visit.node];
    const Affine local = affine_of(node.local);
    world.push_back(visit.parent == no_index ? local : world[visit.parent] * local);
    if (node.mesh == none) continue;
    const auto placements = placements_of(job, document, node.instancing, data);
    if (!placements) return fail(placements.error());
    for (const Trs& trs : *placements) instances[node.mesh].push_back(world.back() * affine_of(trs));
  }
  return instances;
}

}  // namespace cuesta::gltf
