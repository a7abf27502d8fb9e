#include "terrain/open_rasters.h"

#include <algorithm>

#include "ooc/read_job.h"

namespace cuesta {

Result<void> OpenRasters::add(const std::filesystem::path& path) {
  auto raster = open_height_raster(path, options_);
  if (!raster) return fail(std::move(raster).error());
  infos_.push_back((*raster)->info());
  largest_bytes_ = std::max(largest_bytes_, (*raster)->memory_bytes());
  slots_.emplace_back().path = path;
  keep(static_cast<std::uint32_t>(infos_.size() - 1), std::move(*raster));
  return {};
}

Result<void> OpenRasters::read(std::uint32_t file, const Window& window, std::span<double> heights) const {
  const auto raster = find(file);
  if (!raster) return fail(raster.error());
  return (*raster)->read(window, heights);
}

std::uint32_t OpenRasters::open_files() const {
  const std::scoped_lock lock(mutex_);
  return static_cast<std::uint32_t>(open_.size());
}

Result<OpenRasters::Raster> OpenRasters::find(std::uint32_t file) const {
  if (Raster raster = use(file)) return raster;
  const std::scoped_lock opening(slots_[file].opening);
  if (Raster raster = use(file)) return raster;
  auto opened = open_height_raster(slots_[file].path, options_);
  if (!opened) return fail(std::move(opened).error());
  const Raster raster = std::move(*opened);
  const RasterInfo &now = raster->info(), &then = infos_[file];
  if (now.width != then.width || now.height != then.height || now.map != then.map || now.type != then.type)
    return fail(ErrorCode::corrupt, slots_[file].path.string(), "", "the file was changed while it was used");
  keep(file, raster);
  return raster;
}

OpenRasters::Raster OpenRasters::use(std::uint32_t file) const {
  const std::scoped_lock lock(mutex_);
  slots_[file].last_use = ++clock_;
  return slots_[file].raster;
}

void OpenRasters::keep(std::uint32_t file, Raster raster) const {
  std::vector<Raster> closed;  // after the lock is given back, as closing may take a while
  const std::scoped_lock lock(mutex_);
  open_bytes_ += raster->memory_bytes();
  slots_[file].raster = std::move(raster);
  slots_[file].last_use = ++clock_;
  open_.push_back(file);
  while (open_.size() > 1 && (open_.size() > limits_.files || open_bytes_ > limits_.bytes)) {
    const auto oldest =
        std::ranges::min_element(open_, {}, [&](std::uint32_t i) { return slots_[i].last_use; });
    closed.push_back(std::move(slots_[*oldest].raster));
    slots_[*oldest].raster = nullptr;
    open_bytes_ -= closed.back()->memory_bytes();
    open_.erase(oldest);
  }
}

}  // namespace cuesta
