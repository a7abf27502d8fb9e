#include "tests/ooc/openmesh_oracle.h"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#pragma GCC diagnostic pop

namespace cuesta::test {

std::string openmesh_complaint(const GridMesh& mesh) {
  OpenMesh::TriMesh_ArrayKernelT<> open;
  std::vector<OpenMesh::VertexHandle> handles;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const bool first = mesh.wedge_group[v] == v;
    handles.push_back(first ? open.add_vertex(OpenMesh::Vec3f(0.0f)) : handles[mesh.wedge_group[v]]);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    if (!open.add_face(handles[t[0]], handles[t[1]], handles[t[2]]).is_valid())
      return "OpenMesh refuses triangle " + std::to_string(i);
  }
  for (const auto v : open.vertices())
    if (!open.is_manifold(v)) return "OpenMesh finds vertex " + std::to_string(v.idx()) + " not manifold";
  return "";
}

}  // namespace cuesta::test
