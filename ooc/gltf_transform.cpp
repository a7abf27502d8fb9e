#include "ooc/gltf_transform.h"

#include <fmt/format.h>

namespace cuesta::gltf {

/// The cofactors are the inverse transpose times the determinant; only the determinant's sign matters to a
/// direction.
Vec3f Transform::normal(Vec3d n) const {
  const Vec3d turned = cross(columns[1], columns[2]) * n.x + cross(columns[2], columns[0]) * n.y +
                       cross(columns[0], columns[1]) * n.z;
  return vec_cast<float>(normalized(mirrored ? -turned : turned));
}

Transform compose(const Transform& outer, const std::array<double, 16>& m) {
  Transform inner;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d column{m[4 * k], m[4 * k + 1], m[4 * k + 2]};
    inner.columns[k] =
        outer.columns[0] * column.x + outer.columns[1] * column.y + outer.columns[2] * column.z;
  }
  inner.translation = outer.point({m[12], m[13], m[14]});
  inner.mirrored = dot(inner.columns[0], cross(inner.columns[1], inner.columns[2])) < 0;
  return inner;
}

Result<std::vector<std::vector<Transform>>> instances_of(const ReadJob& job, const Document& document) {
  // Each node is placed once, on the stack and then in a list that doubles as it grows.
  CUESTA_TRY(job.budget.charge(document.nodes.size(), 5 * sizeof(Transform), "nodes"));
  std::vector<std::vector<Transform>> instances(document.meshes.size());
  std::vector<bool> reached(document.nodes.size(), false);
  struct Visit {
    Id node;
    Transform outer;
  };
  std::vector<Visit> stack;
  for (const Id root : document.roots) {
    if (reached[root]) continue;
    reached[root] = true;
    stack.push_back({root, {}});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const Node& node = document.nodes[visit.node];
      const Transform here = compose(visit.outer, node.matrix);
      if (node.mesh != none) instances[node.mesh].push_back(here);
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
  return instances;
}

}  // namespace cuesta::gltf
