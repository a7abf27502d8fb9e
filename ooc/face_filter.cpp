#include "ooc/face_filter.h"

#include <algorithm>

namespace cuesta {
namespace {

/// Above this many faces that start at one group, sort to find copies instead of comparing all pairs.
constexpr std::size_t kManyFaces = 16;

/// A face by its groups: ascending, so that copies are equal whichever way round they are.
struct Face {
  std::uint64_t higher_groups;
  std::uint32_t triangle;

  friend auto operator<=>(const Face&, const Face&) = default;
};

/// Faces that have the same lowest group, in order of triangles.
void mark_copies(std::span<Face> faces, std::vector<FaceFault>& faults) {
  if (faces.size() <= kManyFaces) {
    for (std::size_t i = 1; i < faces.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (faces[j].higher_groups == faces[i].higher_groups)
          faults[faces[i].triangle] = FaceFault::duplicate;
    return;
  }
  std::ranges::sort(faces);
  for (std::size_t i = 1; i < faces.size(); ++i)
    if (faces[i].higher_groups == faces[i - 1].higher_groups)
      faults[faces[i].triangle] = FaceFault::duplicate;
}

}  // namespace

std::vector<FaceFault> face_faults(std::span<const Triangle> triangles,
                                   std::span<const std::uint32_t> group) {
  std::vector<FaceFault> faults(triangles.size(), FaceFault::none);
  std::vector<std::uint32_t> starts(group.size() + 1, 0);
  const auto sorted_groups = [&](const Triangle& t) {
    Triangle g{group[t[0]], group[t[1]], group[t[2]]};
    if (g[0] > g[1]) std::swap(g[0], g[1]);
    if (g[1] > g[2]) std::swap(g[1], g[2]);
    if (g[0] > g[1]) std::swap(g[0], g[1]);
    return g;
  };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Triangle g = sorted_groups(triangles[i]);
    if (g[0] == g[1] || g[1] == g[2])
      faults[i] = FaceFault::degenerate;
    else
      ++starts[g[0] + std::size_t{1}];
  }
  counts_to_starts(starts);
  std::vector<Face> faces(starts.back());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    if (faults[i] != FaceFault::none) continue;
    const Triangle g = sorted_groups(triangles[i]);
    faces[starts[g[0]]++] = {std::uint64_t{g[1]} << 32 | g[2], i};
  }
  std::size_t begin = 0;
  for (std::size_t g = 0; g < group.size(); ++g) {  // the scatter moved each start to its bucket's end
    mark_copies(std::span(faces).subspan(begin, starts[g] - begin), faults);
    begin = starts[g];
  }
  return faults;
}

}  // namespace cuesta
