#include "runtime/resident_page.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint32_t no_entry = std::numeric_limits<std::uint32_t>::max();

/// A script changes each triangle a few times: 3 entries per triangle are usual. Beyond this it is an attack:
/// a chain of substitutions that carries a whole page along takes the square of the page.
constexpr std::size_t largest_entries(std::size_t triangles) {
  return std::max(std::size_t{1} << 24, triangles * 64);
}

tl::unexpected<Error> misfit(PageId id, std::string what) {
  return fail(ErrorCode::corrupt, "", "page " + std::to_string(id), std::move(what));
}

std::int16_t widen_normal(std::int16_t n) {
  constexpr int none = -(1 << (normal_bits - 1));
  return n == none ? std::int16_t{-32768}
                   : static_cast<std::int16_t>(n * 32767 / ((1 << (normal_bits - 1)) - 1));
}

std::uint32_t lowest_corner(const std::array<std::uint32_t, 3>& t) {
  return t[0] < t[1] && t[0] < t[2] ? 0u : t[1] < t[2] ? 1u : 2u;
}

}  // namespace

/// Builds a ResidentPage: replay on local numbers, then slots and handles.
class PageReplay {
 public:
  PageReplay(ResidentPage& out, const Page& page, const GeometryPool::PageRun& blocks)
      : out_(out), page_(page), blocks_(blocks) {}

  Result<void> run(std::span<const ResidentPage* const> coarser) {
    link_corners();
    if (!replay()) return misfit(out_.id_, "the script does not fit the page's triangles");
    if (!fits_run()) return misfit(out_.id_, "it owns more than the directory says");
    enter_vertices();
    if (!resolve_vertices(coarser))
      return misfit(out_.id_, "a surviving vertex is in none of the coarser pages");
    enter_triangles();
    if (!resolve_triangles(coarser))
      return misfit(out_.id_, "surviving triangles do not match the coarser pages");
    find_normals();
    finish_entries();
    finish_fans();
    return {};
  }

 private:
  /// Corner t·3 + c is in the list of its current vertex; lists are joined in O(1) when a vertex is
  /// substituted.
  void link_corners() {
    const std::size_t n = page_.triangles.size();
    corners_.reserve(n);
    head_.assign(page_.vertex_count, no_entry);
    tail_.assign(page_.vertex_count, no_entry);
    next_.assign(n * 3, no_entry);
    alive_.assign(n, 1);
    for (std::uint32_t t = 0; t < n; ++t) {
      corners_.push_back(page_.triangles[t]);
      for (std::uint32_t c = 0; c < 3; ++c) append(page_.triangles[t][c], t * 3 + c);
    }
  }

  void append(std::uint32_t v, std::uint32_t corner) {
    if (head_[v] == no_entry)
      head_[v] = corner;
    else
      next_[tail_[v]] = corner;
    tail_[v] = corner;
  }

  bool replay() {
    const Script& script = page_.script;
    out_.children_.reserve(script.children.size() + 1);
    out_.entries_.reserve(script.children.size() * 7);
    for (const Child& c : script.children)
      if (!substitute(c)) return false;
    out_.children_.push_back({0, 0, static_cast<std::uint32_t>(out_.entries_.size()), 0, 0, false});
    return true;
  }

  /// Entries hold local corner numbers until handles are known: removed ones the triangle, modified ones t·3
  /// + c.
  bool substitute(const Child& child) {
    ChildState state{child.vertex, child.target, static_cast<std::uint32_t>(out_.entries_.size()), 0,
                     child.error,  child.joined};
    modified_.clear();
    std::uint32_t removed = 0;
    for (std::uint32_t corner = head_[child.vertex]; corner != no_entry;) {
      const std::uint32_t t = corner / 3;
      const std::uint32_t following = next_[corner];
      if (alive_[t]) {
        auto& c = corners_[t];
        if (c[0] == child.target || c[1] == child.target || c[2] == child.target) {
          alive_[t] = 0;
          out_.entries_.push_back(t);
          ++removed;
        } else {
          modified_.push_back(corner);
          c[corner % 3] = child.target;
          append_joined(child.target, corner);
        }
      }
      corner = following;
    }
    head_[child.vertex] = no_entry;
    if (removed > std::numeric_limits<std::uint16_t>::max()) return false;
    if (out_.entries_.size() + modified_.size() > largest_entries(page_.triangles.size())) return false;
    state.removed = static_cast<std::uint16_t>(removed);
    out_.entries_.insert(out_.entries_.end(), modified_.begin(), modified_.end());
    out_.children_.push_back(state);
    return true;
  }

  void append_joined(std::uint32_t v, std::uint32_t corner) {
    next_[corner] = no_entry;
    append(v, corner);
  }

  bool fits_run() const {
    std::uint32_t owned_triangles = 0;
    for (std::uint8_t a : alive_) owned_triangles += page_.base || !a;
    return page_.owned.positions.size() == blocks_.vertices &&
           GeometryPool::blocks_of(owned_triangles) <= blocks_.triangle_blocks.size();
  }

  std::uint32_t slot(std::uint32_t owned_vertex) const {
    return GeometryPool::number(blocks_.vertex_blocks, owned_vertex);
  }

  void enter_vertices() {
    owned_ = owned_vertices(page_);
    for (std::uint32_t i = 0; i < blocks_.vertices; ++i) {
      const Vec3i p = page_.owned.positions[i];
      DrawVertex v{p.x, p.y, p.z, -32768, -32768, {255, 255, 255, 255}};
      if (!page_.owned.normals.empty()) {
        v.normal_u = widen_normal(page_.owned.normals[i][0]);
        v.normal_v = widen_normal(page_.owned.normals[i][1]);
      }
      if (!page_.owned.colours.empty()) v.colour = page_.owned.colours[i];
      out_.pool_.init_vertex(slot(i), v);
      if (out_.pool_.has_texcoords()) out_.pool_.init_texcoord(slot(i), texcoord(i));
    }
    out_.vertex_slot_.assign(page_.vertex_count, no_entry);
    for (std::uint32_t v = 0, i = 0; v < page_.vertex_count; ++v)
      if (owned_[v]) out_.vertex_slot_[v] = slot(i++);
  }

  TexCoord texcoord(std::uint32_t i) const {
    TexCoord out{};
    if (i < page_.owned.texcoords.size())
      for (std::size_t k = 0; k < 2; ++k) out[k] = static_cast<float>(page_.owned.texcoords[i][k]) / 65536.0f;
    return out;
  }

  bool resolve_vertices(std::span<const ResidentPage* const> coarser) {
    std::vector<std::uint32_t> survivors;
    for (std::uint32_t v = 0; v < page_.vertex_count; ++v)
      if (!owned_[v]) survivors.push_back(v);
    for (const ResidentPage* q : coarser) {
      const auto* table = q->source(out_.id_);
      if (!table) return false;
      for (std::size_t i = 0; i < table->vertices.size(); ++i) {
        if (table->vertices[i] >= survivors.size()) return false;
        out_.vertex_slot_[survivors[table->vertices[i]]] = q->vertex_slot_[table->local_vertices[i]];
      }
    }
    return std::find(out_.vertex_slot_.begin(), out_.vertex_slot_.end(), no_entry) == out_.vertex_slot_.end();
  }

  /// Owned triangles get handles in local order and the corners they had last.
  void enter_triangles() {
    out_.triangle_ref_.assign(corners_.size(), no_entry);
    std::uint32_t owned = 0;
    for (std::uint32_t t = 0; t < corners_.size(); ++t) {
      if (!page_.base && alive_[t]) continue;
      const TriangleHandle handle = GeometryPool::number(blocks_.triangle_blocks, owned++);
      out_.triangle_ref_[t] = handle * 4;
      for (std::uint32_t c = 0; c < 3; ++c)
        out_.pool_.init_corner(handle, c, out_.vertex_slot_[corners_[t][c]]);
      if (alive_[t]) out_.survivors_.push_back(handle);
    }
  }

  /// A survivor is a triangle of a coarser page; both name it lowest vertex first, so the turn between their
  /// corner numbers is where the lowest vertex is now.
  bool resolve_triangles(std::span<const ResidentPage* const> coarser) {
    std::vector<std::uint32_t> survivors;
    for (std::uint32_t t = 0; t < corners_.size(); ++t)
      if (!page_.base && alive_[t]) survivors.push_back(t);
    std::size_t resolved = 0;
    for (const ResidentPage* q : coarser) {
      const auto* table = q->source(out_.id_);
      for (std::size_t i = 0; i < table->triangles.size(); ++i, ++resolved) {
        const std::size_t local = table->first_triangle + i;
        if (table->triangles[i] >= survivors.size() || local >= q->triangle_ref_.size()) return false;
        const std::uint32_t t = survivors[table->triangles[i]];
        const std::uint32_t ref = q->triangle_ref_[local];
        const std::uint32_t turn = (ref % 4 + 3 - lowest_corner(corners_[t])) % 3;
        out_.triangle_ref_[t] = ref / 4 * 4 + turn;
      }
    }
    return resolved == survivors.size() && std::find(out_.triangle_ref_.begin(), out_.triangle_ref_.end(),
                                                     no_entry) == out_.triangle_ref_.end();
  }

  void find_normals() {
    const auto place = [&](std::uint32_t v) {
      const DrawVertex& p = out_.pool_.vertex(out_.vertex_slot_[v]);
      return Vec3d{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)};
    };
    std::vector<Vec3f> normals;
    normals.reserve(page_.triangles.size());
    for (const auto& t : page_.triangles) {
      const Vec3d a = place(t[0]), n = cross(place(t[1]) - a, place(t[2]) - a);
      if (length(n) > 0) normals.push_back(vec_cast<float>(normalized(n)));
    }
    out_.normals_ = NormalCone::around(normals);
  }

  void finish_entries() {
    for (std::size_t k = 0; k + 1 < out_.children_.size(); ++k) {
      ChildState& c = out_.children_[k];
      c.from_slot = out_.vertex_slot_[c.from_slot];
      c.to_slot = out_.vertex_slot_[c.to_slot];
      const std::uint32_t first_modified = c.first_entry + c.removed;
      for (std::uint32_t e = c.first_entry; e < out_.children_[k + 1].first_entry; ++e) {
        std::uint32_t& entry = out_.entries_[e];
        if (e < first_modified) {
          entry = out_.triangle_ref_[entry] / 4;
        } else {
          const std::uint32_t ref = out_.triangle_ref_[entry / 3];
          entry = ref / 4 * 4 + (entry % 3 + ref % 4) % 3;
        }
      }
    }
  }

  void finish_fans() {
    for (const Fan& fan : page_.script.fans) {
      const auto n = static_cast<std::uint16_t>(fan.child_count);
      out_.fans_.push_back({fan.first_child, n, n});
      const DrawVertex& v = out_.pool_.vertex(out_.vertex_slot_[fan.centre]);
      out_.spheres_.push_back(decode_sphere(fan.sphere, {v.x, v.y, v.z}));
    }
    out_.applied_ = out_.child_count();
    std::vector<ErrorCode8> errors;
    for (const FanState& f : out_.fans_)
      errors.push_back(out_.children_[f.first_child + f.child_count - 1u].error);
    out_.nodes_.assign(out_.spheres_, errors);
    for (std::size_t f = 0; f < out_.fans_.size(); ++f) out_.update_band(f);
    out_.entries_.shrink_to_fit();
    for (const PageSource& s : page_.sources)
      out_.sources_.push_back({s.page, s.first_triangle, s.triangles, s.vertices, s.local_vertices});
  }

  ResidentPage& out_;
  const Page& page_;
  const GeometryPool::PageRun& blocks_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<std::uint32_t> head_, tail_, next_, modified_;
  std::vector<std::uint8_t> alive_, owned_;
};

Result<std::unique_ptr<ResidentPage>> ResidentPage::create(PageId id, const Page& page,
                                                           std::span<const ResidentPage* const> coarser,
                                                           GeometryPool& pool, GeometryPool::RunId run,
                                                           const GeometryPool::PageRun& blocks) {
  for (const Fan& fan : page.script.fans)
    if (fan.child_count == 0 || fan.child_count > std::numeric_limits<std::uint16_t>::max())
      return misfit(id, "a fan has no substitution, or too many");
  std::unique_ptr<ResidentPage> out(new ResidentPage(id, pool, run));
  if (auto r = PageReplay(*out, page, blocks).run(coarser); !r) return fail(r.error());
  return out;
}

}  // namespace cuesta
