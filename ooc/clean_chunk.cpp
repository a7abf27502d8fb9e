#include "ooc/clean_chunk.h"

#include <algorithm>
#include <utility>

#include "ooc/byte_arrays.h"
#include "ooc/edge_twins.h"
#include "ooc/face_filter.h"
#include "ooc/manifold_split.h"
#include "ooc/oct_normal.h"
#include "ooc/weld.h"

namespace cuesta {
namespace {

constexpr OctNormal no_normal{-(1 << (normal_bits - 1)), -(1 << (normal_bits - 1))};

class ChunkCleaner {
 public:
  ChunkCleaner(const TriangleSoup& soup, std::uint32_t self, const Box3<float>& box, bool make_normals)
      : soup_(soup), self_(self), box_(box), make_normals_(make_normals) {}

  CleanedChunk run() {
    weld_corners();
    drop_faces();
    split_sheets();
    find_shared();
    make_normals();
    number_vertices();
    give_triangles();
    give_replies();
    return std::move(out_);
  }

 private:
  bool is_home(std::uint32_t corner) const {
    return holds(box_, vec_cast<float>(soup_.corners.positions[corner]));
  }

  void weld_corners() {
    Welded welded = weld(soup_.corners);
    triangles_.resize(soup_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      triangles_[i] = {welded.of[3 * i], welded.of[3 * i + 1], welded.of[3 * i + 2]};
    corner_of_ = std::move(welded.source);
    group_ = std::move(welded.group);
    home_.resize(corner_of_.size());
    for (std::size_t v = 0; v < home_.size(); ++v) {
      home_[v] = is_home(corner_of_[v]);
      out_.vertices_used += home_[v];
    }
  }

  void drop_faces() {
    const auto faults = face_faults(triangles_, group_);
    std::size_t kept = 0;
    for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
      if (faults[i] == FaceFault::none) {
        triangles_[kept++] = triangles_[i];
        soup_triangle_.push_back(i);
      } else if (soup_.owners[i] == self_) {
        ++(faults[i] == FaceFault::degenerate ? out_.report.faces_degenerate : out_.report.faces_duplicate);
      }
    }
    triangles_.resize(kept);
  }

  /// After this, vertices are those of the manifold.
  void split_sheets() {
    const auto twins = edge_twins(triangles_, group_, home_, out_.report.edges_nonmanifold);
    SplitVertices split = split_fans(triangles_, group_, home_, twins);
    out_.report.vertices_unused = out_.vertices_used - split.used_before;
    out_.report.vertices_split = split.copies;
    group_ = std::move(split.group);
    std::vector<std::uint8_t> home;
    home.reserve(split.source.size());
    for (std::uint32_t& s : split.source) {
      home.push_back(home_[s]);
      s = corner_of_[s];
    }
    corner_of_ = std::move(split.source);
    home_ = std::move(home);
    for (std::size_t v = 1; v < group_.size(); ++v)
      out_.report.wedge_groups += home_[v] && group_[v] == v - 1;
  }

  bool is_own(std::size_t triangle) const { return soup_.owners[soup_triangle_[triangle]] == self_; }

  void find_shared() {
    shared_.assign(group_.size(), 0);
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      if (!is_own(i))
        for (const std::uint32_t v : triangles_[i]) shared_[group_[v]] = 1;
  }

  void make_normals() {
    const auto& given = soup_.corners.normals;
    for (const std::uint32_t c : corner_of_)
      if (!given.empty()) normals_.push_back(given[c]);
    if (!make_normals_) return;
    std::vector<Vec3d> sums(group_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i)
      for (const std::uint32_t v : triangles_[i])
        sums[group_[v]] = sums[group_[v]] + vec_cast<double>(soup_.area_normals[soup_triangle_[i]]);
    normals_.resize(group_.size(), no_normal);
    for (std::size_t v = 0; v < group_.size(); ++v)
      if (normals_[v] == no_normal)
        normals_[v] = encode_oct(vec_cast<float>(normalized(sums[group_[v]])), normal_bits);
  }

  void append(VertexTable& table, std::uint32_t v) const {
    const VertexTable& corners = soup_.corners;
    const std::uint32_t c = corner_of_[v];
    table.positions.push_back(corners.positions[c]);
    if (!normals_.empty()) table.normals.push_back(normals_[v]);
    if (!corners.colours.empty()) table.colours.push_back(corners.colours[c]);
    if (!corners.texcoords.empty()) table.texcoords.push_back(corners.texcoords[c]);
  }

  void number_vertices() {
    CleanChunk& chunk = out_.chunk;
    number_.assign(group_.size(), kNone);
    for (const bool shared : {true, false}) {
      for (std::uint32_t v = 0; v < group_.size(); ++v) {
        if (!home_[v] || (shared_[group_[v]] != 0) != shared) continue;
        number_[v] = static_cast<std::uint32_t>(chunk.wedge.size());
        chunk.wedge.push_back(group_[v] == v ? 0 : chunk.wedge.back() + 1);
        append(chunk.vertices, v);
      }
      if (shared) chunk.shared = static_cast<std::uint32_t>(chunk.wedge.size());
    }
  }

  void give_triangles() {
    CleanChunk& chunk = out_.chunk;
    const auto vertices = static_cast<std::uint32_t>(chunk.vertices.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (!is_own(i)) continue;
      Triangle t;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = triangles_[i][k];
        t[k] = number_[v];
        if (home_[v]) continue;
        t[k] = vertices + static_cast<std::uint32_t>(chunk.foreign_slots.size());
        chunk.foreign_slots.push_back(slot(i, k));
        append(chunk.foreign, v);
      }
      chunk.triangles.push_back(t);
    }
    sort_by_lowest_vertex(chunk.triangles, vertices + chunk.foreign_slots.size());
  }

  std::uint64_t slot(std::size_t triangle, std::uint32_t k) const {
    return soup_.ordinals[soup_triangle_[triangle]] * 4 + k;
  }

  void give_replies() {
    std::vector<std::pair<std::uint32_t, CornerReply>> all;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (is_own(i)) continue;
      for (std::uint32_t k = 0; k < 3; ++k) {
        const std::uint32_t v = triangles_[i][k];
        if (!home_[v]) continue;
        CornerReply reply{slot(i, k), number_[v], out_.chunk.wedge[number_[v]], {}};
        if (!normals_.empty()) reply.normal = normals_[v];
        all.emplace_back(soup_.owners[soup_triangle_[i]], reply);
      }
    }
    std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [chunk, reply] : all) {
      if (out_.replies.empty() || out_.replies.back().chunk != chunk) out_.replies.push_back({chunk, {}});
      out_.replies.back().corners.push_back(reply);
    }
  }

  const TriangleSoup& soup_;
  std::uint32_t self_;
  const Box3<float>& box_;
  bool make_normals_;
  CleanedChunk out_;

  std::vector<Triangle> triangles_;           // corners are vertices
  std::vector<std::uint32_t> soup_triangle_;  // of each triangle
  // Per vertex:
  std::vector<std::uint32_t> corner_of_;  // the first corner of the soup that it stands for
  std::vector<std::uint32_t> group_;
  std::vector<std::uint8_t> home_;    // lies in the chunk's box
  std::vector<std::uint8_t> shared_;  // of its group's first: another chunk uses it
  std::vector<OctNormal> normals_;
  std::vector<std::uint32_t> number_;  // in the chunk
};

}  // namespace

CleanedChunk clean_chunk(const TriangleSoup& soup, std::uint32_t self, const Box3<float>& box,
                         bool make_normals) {
  return ChunkCleaner(soup, self, box, make_normals).run();
}

std::vector<std::byte> encode_chunk(const CleanChunk& chunk) {
  ByteWriter w;
  put_table(w, chunk.vertices);
  put_array(w, chunk.wedge);
  w.put_varint(chunk.shared);
  put_array(w, chunk.triangles);
  put_table(w, chunk.foreign);
  put_array(w, chunk.foreign_slots);
  return w.take();
}

Result<CleanChunk> decode_chunk(std::span<const std::byte> bytes) {
  CleanChunk chunk;
  ByteReader r(bytes);
  bool good = get_table(r, chunk.vertices) && get_array(r, chunk.wedge);
  chunk.shared = static_cast<std::uint32_t>(r.get_varint());
  good = good && get_array(r, chunk.triangles) && get_table(r, chunk.foreign) &&
         get_array(r, chunk.foreign_slots) && r.at_end() && chunk.wedge.size() == chunk.vertices.size() &&
         chunk.shared <= chunk.vertices.size() && chunk.foreign_slots.size() == chunk.foreign.size();
  const std::size_t corners = chunk.vertices.size() + chunk.foreign.size();
  for (const Triangle& t : chunk.triangles) good = good && t[0] < corners && t[1] < corners && t[2] < corners;
  if (!good) return fail(ErrorCode::corrupt, "", "", "a chunk in the work folder is damaged");
  return chunk;
}

}  // namespace cuesta
