#include "hierarchy/page_survivors.h"

#include <algorithm>
#include <numeric>

#include "hierarchy/substitution_kernel.h"
#include "ooc/byte_arrays.h"

namespace cuesta {

std::vector<std::byte> encode_survivors(const PageSurvivors& s) {
  ByteWriter w;
  put_array(w, s.ids);
  put_array(w, s.wedge);
  put_table(w, s.vertices);
  put_array(w, s.triangles);
  put_array(w, s.births);
  put_array(w, s.samples.begin);
  put_array(w, s.samples.points);
  return w.take();
}

Result<PageSurvivors> decode_survivors(std::span<const std::byte> bytes) {
  PageSurvivors s;
  ByteReader r(bytes);
  bool good = get_array(r, s.ids) && get_array(r, s.wedge) && get_table(r, s.vertices) &&
              get_array(r, s.triangles) && get_array(r, s.births) && get_array(r, s.samples.begin) &&
              get_array(r, s.samples.points) && r.at_end() && s.wedge.size() == s.ids.size() &&
              s.vertices.size() == s.ids.size() && s.births.size() == s.triangles.size() &&
              s.samples.begin.size() == s.triangles.size() + 1 &&
              s.samples.begin.back() == s.samples.points.size();
  for (const Triangle& t : s.triangles)
    good = good && t[0] < s.ids.size() && t[1] < s.ids.size() && t[2] < s.ids.size();
  if (!good || !std::is_sorted(s.samples.begin.begin(), s.samples.begin.end()))
    return fail(ErrorCode::corrupt, "", "", "survivors in the work folder are damaged");
  return s;
}

void ChunkCollector::add_vertex(const PageSurvivors& page, std::uint32_t v, bool inside) {
  if (number_[v] != none) return;
  number_[v] = static_cast<std::uint32_t>(out_.ids.size());
  out_.ids.push_back(page.ids[v]);
  out_.wedge.push_back(page.wedge[v]);
  out_.vertices.append(page.vertices, v);
  inside_.push_back(inside);
}

void ChunkCollector::add(PageId id, PageSurvivors page) {
  const Box3<float>& box = tree_.leaf_box(leaf_);
  const auto is_inside = [&](Vec3f p) { return holds(box, turn(tree_.axes(), p)); };
  std::vector<std::uint8_t> inside(page.ids.size());
  for (std::uint32_t v = 0; v < inside.size(); ++v)
    inside[v] = is_inside(vec_cast<float>(page.vertices.positions[v]));
  number_.assign(page.ids.size(), none);
  const auto centres = triangle_centres(page.triangles, page.vertices.positions);
  const std::size_t before = out_.triangles.size();
  if (out_.samples.begin.empty()) out_.samples.begin.push_back(0);
  for (std::uint32_t t = 0; t < page.triangles.size(); ++t) {
    const Triangle& corners = page.triangles[t];
    if (!is_inside(centres[t])) {
      for (std::uint32_t v : corners)
        if (inside[v]) met_outside_.push_back(page.ids[v] - page.wedge[v]);
      continue;
    }
    for (std::uint32_t v : corners) add_vertex(page, v, inside[v] != 0);
    out_.triangles.push_back({number_[corners[0]], number_[corners[1]], number_[corners[2]]});
    out_.births.push_back(page.births[t]);
    const auto first = page.samples.points.begin() + page.samples.begin[t];
    out_.samples.points.insert(out_.samples.points.end(), first,
                               page.samples.points.begin() + page.samples.begin[t + 1]);
    out_.samples.begin.push_back(static_cast<std::uint32_t>(out_.samples.points.size()));
    out_.origins.push_back({id, t});
  }
  if (out_.triangles.size() > before) out_.sources.push_back({id, std::move(page.ids)});
}

RoundChunk ChunkCollector::take() {
  std::vector<std::uint32_t> order(out_.ids.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return out_.ids[a] != out_.ids[b] ? out_.ids[a] < out_.ids[b] : a < b;
  });
  std::sort(met_outside_.begin(), met_outside_.end());
  std::vector<std::uint32_t> now(order.size());
  RoundChunk sorted;
  sorted.vertices.reserve(order.size(), out_.vertices.attributes());
  auto outside = met_outside_.begin();
  for (std::uint32_t old : order) {
    if (sorted.ids.empty() || sorted.ids.back() != out_.ids[old]) {
      sorted.ids.push_back(out_.ids[old]);
      sorted.wedge.push_back(out_.wedge[old]);
      sorted.vertices.append(out_.vertices, old);
      const VertexId group = out_.ids[old] - out_.wedge[old];
      while (outside != met_outside_.end() && *outside < group) ++outside;
      sorted.locked.push_back(!inside_[old] || (outside != met_outside_.end() && *outside == group));
    }
    now[old] = static_cast<std::uint32_t>(sorted.ids.size() - 1);
  }
  for (Triangle& t : out_.triangles) t = {now[t[0]], now[t[1]], now[t[2]]};
  sorted.triangles = std::move(out_.triangles);
  sorted.births = std::move(out_.births);
  sorted.samples = std::move(out_.samples);
  sorted.origins = std::move(out_.origins);
  sorted.sources = std::move(out_.sources);
  return sorted;
}

}  // namespace cuesta
