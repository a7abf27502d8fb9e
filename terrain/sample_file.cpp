#include "terrain/sample_file.h"

#include <algorithm>

#include "ooc/read_job.h"
#include "terrain/samples.h"

namespace cuesta {
namespace {

/// Read at once; larger windows take several reads.
constexpr std::uint64_t buffer_bytes = std::uint64_t{1} << 18;

class SampleRaster : public HeightRaster {
 public:
  SampleRaster(RasterInfo info, const SampleLayout& layout, std::optional<RasterFile> file, Unpack unpack)
      : HeightRaster(std::move(info)), layout_(layout), file_(std::move(file)), unpack_(std::move(unpack)) {}

  std::uint64_t memory_bytes() const override { return buffer_bytes; }

 protected:
  Result<void> read_window(const Window& window, std::span<double> heights) const override {
    CUESTA_TRY(make_file());
    if (window.width == info_.width) return read_run(window.row * info_.width, heights);
    for (std::uint64_t row = 0; row < window.height; ++row) {
      const auto part = heights.subspan(row * window.width, window.width);
      CUESTA_TRY(read_run((window.row + row) * info_.width + window.column, part));
    }
    return {};
  }

 private:
  Result<void> make_file() const {
    if (!unpack_) return {};
    const std::scoped_lock lock(mutex_);
    if (file_) return {};
    auto map = unpack_();
    if (!map) return fail(std::move(map).error());
    file_.emplace(RasterFile{info_.files.empty() ? "" : info_.files.front(), "", true, std::move(*map)});
    return {};
  }

  /// Postings from number `first` on, as they lie in the file.
  Result<void> read_run(std::uint64_t first, std::span<double> heights) const {
    const std::uint64_t each = bytes_of(layout_.type);
    std::vector<std::byte> buffer(std::min(buffer_bytes, heights.size() * each));
    for (std::uint64_t done = 0; done < heights.size();) {
      const std::uint64_t count = std::min(buffer.size() / each, heights.size() - done);
      const std::span<std::byte> bytes(buffer.data(), count * each);
      CUESTA_TRY(file_->read(layout_.header_bytes + (first + done) * each, bytes));
      to_heights(bytes, layout_.type, layout_.order, info_.meaning, heights.subspan(done, count));
      done += count;
    }
    return {};
  }

  SampleLayout layout_;
  mutable std::mutex mutex_;
  mutable std::optional<RasterFile> file_;  ///< written once, under the mutex
  Unpack unpack_;
};

}  // namespace

std::unique_ptr<HeightRaster> make_sample_raster(RasterInfo info, RasterFile file,
                                                 const SampleLayout& layout) {
  return std::make_unique<SampleRaster>(std::move(info), layout, std::move(file), nullptr);
}

std::unique_ptr<HeightRaster> make_unpacked_raster(RasterInfo info, Unpack unpack,
                                                   const SampleLayout& layout) {
  return std::make_unique<SampleRaster>(std::move(info), layout, std::nullopt, std::move(unpack));
}

}  // namespace cuesta
