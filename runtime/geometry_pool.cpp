#include "runtime/geometry_pool.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "ooc/check.h"

namespace cuesta {
namespace {

constexpr std::uint64_t vertex_block_bytes = GeometryPool::block * sizeof(DrawVertex);
constexpr std::uint64_t texcoord_block_bytes = GeometryPool::block * sizeof(TexCoord);
constexpr std::uint64_t triangle_block_bytes = std::uint64_t{GeometryPool::block} * 20;

/// The last number names nothing, so that handles · 4 + 3 and slots fit 32 bits.
constexpr std::uint64_t most_blocks = (std::uint64_t{1} << 30) / GeometryPool::block - 1;

/// The most blocks that any choice of pages has within the budget, but for parts of a page: those with the
/// most blocks for what they are charged come first. (Sums of 10^6 pages, once.)
std::uint32_t most_blocks_within(std::vector<std::pair<std::uint64_t, std::uint64_t>> blocks_and_charges,
                                 std::uint64_t budget_bytes) {
  std::sort(blocks_and_charges.begin(), blocks_and_charges.end(), [](const auto& a, const auto& b) {
    return static_cast<double>(a.first) * static_cast<double>(b.second) >
           static_cast<double>(b.first) * static_cast<double>(a.second);
  });
  std::uint64_t blocks = 0;
  for (const auto& [count, charge] : blocks_and_charges) {
    blocks += count;
    if (charge >= budget_bytes) break;
    budget_bytes -= charge;
  }
  return static_cast<std::uint32_t>(std::min(blocks, most_blocks));
}

void append(std::vector<Range>& ranges, Range r) {
  if (!ranges.empty() && ranges.back().first + ranges.back().count == r.first)
    ranges.back().count += r.count;
  else
    ranges.push_back(r);
}

}  // namespace

std::vector<std::uint32_t> BlockAllocator::allocate(std::uint32_t count) {
  CUESTA_CHECK(count <= free_, count, free_);
  std::vector<std::uint32_t> out;
  out.reserve(count);
  auto from = std::find_if(runs_.begin(), runs_.end(), [count](const auto& r) { return r.second >= count; });
  if (from == runs_.end()) from = runs_.begin();
  while (out.size() < count) {
    const auto [first, size] = *from;
    const std::uint32_t taken = std::min(size, count - static_cast<std::uint32_t>(out.size()));
    for (std::uint32_t i = 0; i < taken; ++i) out.push_back(first + i);
    from = runs_.erase(from);
    if (taken < size) runs_.emplace(first + taken, size - taken);
  }
  free_ -= count;
  if (count > 0) end_ = std::max(end_, out.back() + 1);
  return out;
}

void BlockAllocator::release(std::span<const std::uint32_t> numbers) {
  free_ += static_cast<std::uint32_t>(numbers.size());
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t next = i + 1;
    while (next < numbers.size() && numbers[next] == numbers[next - 1] + 1) ++next;
    release_run(numbers[i], static_cast<std::uint32_t>(next - i));
    i = next;
  }
}

void BlockAllocator::release_run(std::uint32_t first, std::uint32_t count) {
  auto next = runs_.lower_bound(first);
  if (next != runs_.end() && first + count == next->first) {
    count += next->second;
    next = runs_.erase(next);
  }
  if (next != runs_.begin()) {
    const auto before = std::prev(next);
    if (before->first + before->second == first) {
      before->second += count;
      return;
    }
  }
  runs_.emplace(first, count);
}

std::uint64_t GeometryPool::page_bytes(std::uint32_t vertices, std::uint32_t triangles, bool texcoords) {
  return blocks_of(vertices) * (vertex_block_bytes + (texcoords ? texcoord_block_bytes : 0)) +
         blocks_of(triangles) * triangle_block_bytes;
}

GeometryPool::Capacity GeometryPool::capacity_for(const Directory& directory, std::uint64_t budget_bytes,
                                                  std::span<const std::uint64_t> charges) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> vertices, triangles;
  for (std::size_t id = 0; id < charges.size(); ++id) {
    vertices.emplace_back(blocks_of(directory.pages[id].owned_vertices), charges[id]);
    triangles.emplace_back(blocks_of(directory.pages[id].owned_triangles), charges[id]);
  }
  return {most_blocks_within(std::move(vertices), budget_bytes),
          most_blocks_within(std::move(triangles), budget_bytes)};
}

GeometryPool::GeometryPool(Capacity capacity, bool texcoords)
    : vertex_blocks_(capacity.vertex_blocks), triangle_blocks_(capacity.triangle_blocks) {
  const std::size_t vertices = std::size_t{capacity.vertex_blocks} * block;
  const std::size_t triangles = std::size_t{capacity.triangle_blocks} * block;
  // Without initialisation: pages of memory that no page of the surface has touched cost nothing.
  vertices_.reset(new DrawVertex[vertices]);
  if (texcoords) texcoords_.reset(new TexCoord[vertices]);
  indices_.reset(new std::uint32_t[triangles * 3]);
  place_.reset(new std::uint32_t[triangles]);
  at_place_.reset(new std::uint32_t[triangles]);
  owner_.assign(capacity.triangle_blocks, no_run);
  ordinal_.assign(capacity.triangle_blocks, 0);
  is_dirty_.assign(triangles / dirty_block, 0);
}

bool GeometryPool::fits(std::uint32_t vertices, std::uint32_t triangles) const {
  return blocks_of(vertices) <= vertex_blocks_.free() && blocks_of(triangles) <= triangle_blocks_.free();
}

GeometryPool::RunId GeometryPool::add(std::uint32_t vertices, std::uint32_t triangles) {
  CUESTA_CHECK(fits(vertices, triangles), vertices, triangles);
  RunId id = static_cast<RunId>(runs_.size());
  if (free_runs_.empty()) {
    runs_.emplace_back();
  } else {
    id = free_runs_.back();
    free_runs_.pop_back();
  }
  PageRun& r = runs_[id];
  r.vertices = vertices;
  r.vertex_blocks = vertex_blocks_.allocate(blocks_of(vertices));
  r.triangle_blocks = triangle_blocks_.allocate(blocks_of(triangles));
  for (std::uint32_t i = 0; i < r.triangle_blocks.size(); ++i) {
    const std::uint32_t b = r.triangle_blocks[i];
    owner_[b] = id;
    ordinal_[b] = i;
    std::iota(&place_[std::size_t{b} * block], &place_[std::size_t{b} * block] + block, b * block);
    std::iota(&at_place_[std::size_t{b} * block], &at_place_[std::size_t{b} * block] + block, b * block);
  }
  return id;
}

void GeometryPool::remove(RunId run) {
  PageRun& r = runs_[run];
  active_ -= r.active;
  vertex_blocks_.release(r.vertex_blocks);
  triangle_blocks_.release(r.triangle_blocks);
  for (const std::uint32_t b : r.triangle_blocks) owner_[b] = no_run;
  r = {};
  free_runs_.push_back(run);
}

void GeometryPool::swap_places(std::uint32_t a, std::uint32_t b) {
  if (a == b) return;
  std::swap_ranges(&indices_[std::size_t{a} * 3], &indices_[std::size_t{a} * 3] + 3,
                   &indices_[std::size_t{b} * 3]);
  std::swap(at_place_[a], at_place_[b]);
  place_[at_place_[a]] = a;
  place_[at_place_[b]] = b;
}

bool GeometryPool::active(TriangleHandle t) const {
  return ordinal(place_[t]) < runs_[owner_[t / block]].active;
}

void GeometryPool::activate(TriangleHandle t) {
  PageRun& r = runs_[owner_[t / block]];
  CUESTA_CHECK(ordinal(place_[t]) >= r.active, t);
  const std::uint32_t to = number(r.triangle_blocks, r.active);
  swap_places(place_[t], to);
  ++r.active;
  ++active_;
  touch(to);
}

void GeometryPool::deactivate(TriangleHandle t) {
  PageRun& r = runs_[owner_[t / block]];
  CUESTA_CHECK(ordinal(place_[t]) < r.active, t);
  const std::uint32_t last = number(r.triangle_blocks, r.active - 1);
  touch(place_[t]);
  swap_places(place_[t], last);
  --r.active;
  --active_;
}

bool GeometryPool::upload_vertices(RunId run, std::uint64_t most_bytes) {
  PageRun& r = runs_[run];
  if (!vertex_uploads_) return true;
  const std::uint64_t bytes = sizeof(DrawVertex) + (has_texcoords() ? sizeof(TexCoord) : 0);
  std::uint64_t left = most_bytes / bytes;
  while (r.uploaded_vertices < r.vertices && left > 0) {
    const std::uint32_t in_block = block - r.uploaded_vertices % block;
    const auto count = static_cast<std::uint32_t>(
        std::min<std::uint64_t>({in_block, r.vertices - r.uploaded_vertices, left}));
    append(new_vertices_, {number(r.vertex_blocks, r.uploaded_vertices), count});
    r.uploaded_vertices += count;
    left -= count;
    vertex_upload_bytes_ += count * bytes;
  }
  return r.uploaded_vertices == r.vertices;
}

/// Places behind the active ones are not drawn, and are uploaded when they become so.
void GeometryPool::collect_dirty() {
  std::sort(dirty_.begin(), dirty_.end());
  changed_indices_.clear();
  for (const std::uint32_t d : dirty_) {
    is_dirty_[d] = 0;
    const std::uint32_t first = d * dirty_block;
    const RunId owner = owner_[first / block];
    if (owner == no_run) continue;
    const std::uint32_t at = ordinal(first);
    const std::uint32_t end = std::min(runs_[owner].active, at + dirty_block);
    if (at < end) append(changed_indices_, {first * 3, (end - at) * 3});
  }
  dirty_.clear();
}

void GeometryPool::mark_tags() {
  if (!tagging_) {
    tags_.clear();
    return;
  }
  tags_.assign(std::size_t{triangle_blocks_.end()} * block, 0);
  for (const Tag& t : tagged_)
    if (owner_[t.triangle / block] != no_run)
      tags_[place_[t.triangle]] = std::max(tags_[place_[t.triangle]], t.kind);
  tagged_.clear();
}

DrawList GeometryPool::draw_list(const Grid& grid, std::span<const RunId> runs,
                                 std::span<const PageId> pages) {
  draws_.clear();
  draw_pages_.clear();
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const PageRun& r = runs_[runs[k]];
    const std::size_t first_of_page = draws_.size();
    for (std::uint32_t done = 0; done < r.active; done += block) {
      const std::uint32_t count = std::min(block, r.active - done) * 3;
      const std::uint32_t first = r.triangle_blocks[done / block] * block * 3;
      if (draws_.size() > first_of_page && draws_.back().first + draws_.back().count == first) {
        draws_.back().count += count;
      } else {
        draws_.push_back({first, count});
        draw_pages_.push_back(pages[k]);
      }
    }
  }
  collect_dirty();
  mark_tags();
  changed_vertices_ = std::exchange(new_vertices_, {});
  vertex_upload_bytes_ = 0;
  const std::size_t vertices = std::size_t{vertex_blocks_.end()} * block;
  const std::size_t triangles = std::size_t{triangle_blocks_.end()} * block;
  DrawList list;
  list.grid = grid;
  list.vertices = {vertices_.get(), vertices};
  if (has_texcoords()) list.texcoords = {texcoords_.get(), vertices};
  list.indices = {indices_.get(), triangles * 3};
  list.draws = draws_;
  list.changed_vertices = changed_vertices_;
  list.changed_indices = changed_indices_;
  list.draw_pages = draw_pages_;
  list.triangle_tags = tags_;
  return list;
}

}  // namespace cuesta
