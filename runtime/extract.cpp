#include "runtime/extract.h"

#include <limits>

#include "ooc/oct_normal.h"

namespace cuesta {
namespace {

constexpr std::uint32_t not_used = std::numeric_limits<std::uint32_t>::max();

class Extraction {
 public:
  Extraction(const DrawList& list, const ExtractOptions& options)
      : list_(list), options_(options), number_(list.vertices.size(), not_used) {}

  SurfaceMesh run() {
    std::size_t indices = 0;
    for (const Range& draw : list_.draws) indices += draw.count;
    mesh_.triangles.reserve(indices / 3);
    for (const Range& draw : list_.draws) {
      const auto run = list_.indices.subspan(draw.first, draw.count);
      for (std::size_t i = 0; i + 2 < run.size(); i += 3)
        mesh_.triangles.push_back({vertex(run[i]), vertex(run[i + 1]), vertex(run[i + 2])});
    }
    return std::move(mesh_);
  }

 private:
  std::uint32_t vertex(std::uint32_t slot) {
    std::uint32_t& number = number_[slot];
    if (number == not_used) number = add(slot);
    return number;
  }

  std::uint32_t add(std::uint32_t slot) {
    const DrawVertex& v = list_.vertices[slot];
    mesh_.positions.push_back(list_.grid.world({v.x, v.y, v.z}));
    if (options_.normals) mesh_.normals.push_back(decode_oct({v.normal_u, v.normal_v}, 16));
    if (options_.colours) mesh_.colours.push_back(v.colour);
    if (!list_.texcoords.empty()) mesh_.texcoords.push_back(list_.texcoords[slot]);
    return static_cast<std::uint32_t>(mesh_.positions.size() - 1);
  }

  const DrawList& list_;
  const ExtractOptions& options_;
  std::vector<std::uint32_t> number_;  // per slot
  SurfaceMesh mesh_;
};

}  // namespace

Result<SurfaceMesh> extract_mesh(const DrawList& list, const ExtractOptions& options) {
  if (list.vertices.size() >= not_used)
    return fail(ErrorCode::out_of_budget, "", "", "the cut has more vertices than one mesh can number");
  return Extraction(list, options).run();
}

}  // namespace cuesta
