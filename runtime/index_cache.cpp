#include "runtime/index_cache.h"

#include <algorithm>
#include <cmath>

namespace cuesta {
namespace {

std::uint64_t bytes_of(const IndexBlock& block) {
  return block.triangles.size() * sizeof(Triangle);
}

}  // namespace

double rung_triangles(double triangles, double all) {
  const double rung = std::ceil(rungs_per_octave * std::log2(all / triangles) - 1e-9);
  return all * std::exp2(-std::max(rung, 0.0) / rungs_per_octave);
}

IndexCache::Entry& IndexCache::extract(std::vector<Entry>& entries, const Tom& tom, Resolution n,
                                       std::uint64_t triangles) {
  auto block = std::make_shared<IndexBlock>();
  block->id = next_id_++;
  block->resolution = n;
  block->triangles.resize(triangles);
  extract_triangles(tom, n, block->triangles);
  extracted_ += triangles;
  bytes_ += bytes_of(*block);
  entries.push_back({std::move(block), frame_});
  return entries.back();
}

std::shared_ptr<const IndexBlock> IndexCache::get(std::uint32_t part, const Tom& tom, Resolution n,
                                                  std::uint64_t most_extracted) {
  std::vector<Entry>& entries = parts_[part];
  Entry* best = nullptr;
  for (Entry& e : entries)
    if (e.block->resolution <= n && (!best || e.block->resolution > best->block->resolution)) best = &e;
  if (!best || best->block->resolution < n) {
    const std::uint64_t wanted = triangle_count(tom, n);
    const bool fits = extracted_ + wanted <= most_extracted;
    if (!fits) denied_ += wanted;
    if (fits)
      best = &extract(entries, tom, n, wanted);
    else if (!best)
      best = &extract(entries, tom, tom.base_vertices, triangle_count(tom, tom.base_vertices));
  }
  best->used = frame_;
  return best->block;
}

void IndexCache::end_frame() {
  if (bytes_ <= limit_) return;
  stale_.clear();
  for (const auto& [part, entries] : parts_)
    for (const Entry& e : entries)
      if (e.used != frame_) stale_.push_back(e.used);
  if (stale_.empty()) return;
  // Half of what is stale goes at once, so that this is seldom done.
  const auto middle = stale_.begin() + std::ssize(stale_) / 2;
  std::nth_element(stale_.begin(), middle, stale_.end());
  for (auto& [part, entries] : parts_)
    std::erase_if(entries, [&](const Entry& e) {
      const bool goes = e.used != frame_ && e.used <= *middle;
      if (goes) bytes_ -= bytes_of(*e.block);
      return goes;
    });
}

}  // namespace cuesta
