#include "terrain/png_image.h"

#include <fmt/format.h>
#include <png.h>

#include <array>
#include <csetjmp>
#include <cstring>
#include <string>

#include "ooc/read_job.h"

namespace cuesta {
namespace {

/// libpng jumps out of its calls; each is made by a function that owns nothing (guarded() below).
class PngReader {
 public:
  explicit PngReader(const RasterFile& file) : file_(file) {
    png_ = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, on_error, on_warning);
    if (png_) info_ = png_create_info_struct(png_);
  }
  ~PngReader() { png_destroy_read_struct(&png_, &info_, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  Result<PngImage> begin(PngHeights heights) {
    if (!png_ || !info_)
      return fail(ErrorCode::out_of_budget, file_.path.string(), "", "no memory for libpng");
    if (!guarded([](PngReader& r) { r.read_head(); })) return damaged("head");
    return judge(heights);
  }

  /// @pre begin() was good.
  Result<void> rows(const PngImage& image, PngHeights heights, const PngRows& sink) {
    if (!guarded([](PngReader& r) { r.begin_rows(); })) return damaged("head");
    const std::size_t bytes = png_get_rowbytes(png_, info_);
    const bool interlaced = passes_ > 1;
    pixels_.resize(interlaced ? bytes * image.height : bytes);
    if (interlaced) {
      for (std::uint32_t y = 0; y < image.height; ++y) pointers_.push_back(pixels_.data() + y * bytes);
      if (!guarded([](PngReader& r) { png_read_image(r.png_, r.pointers_.data()); }))
        return damaged("pixels");
    }
    std::vector<std::byte> samples(image.width * bytes_of(image.type));
    for (std::uint32_t y = 0; y < image.height; ++y) {
      if (!interlaced && !guarded([](PngReader& r) { png_read_row(r.png_, r.pixels_.data(), nullptr); }))
        return damaged(fmt::format("row {}", y));
      make_samples(heights, interlaced ? pointers_[y] : pixels_.data(), samples);
      CUESTA_TRY(sink(samples));
    }
    // Checks the sums to the end of the file.
    if (!guarded([](PngReader& r) { png_read_end(r.png_, nullptr); })) return damaged("end");
    return {};
  }

 private:
  static void on_error(png_structp png, png_const_charp message) {
    PngReader& reader = *static_cast<PngReader*>(png_get_error_ptr(png));
    std::strncpy(reader.said_.data(), message ? message : "", reader.said_.size() - 1);
    std::longjmp(reader.back_, 1);
  }
  static void on_warning(png_structp, png_const_charp) {}
  static void on_read(png_structp png, png_bytep into, std::size_t count) {
    PngReader& reader = *static_cast<PngReader*>(png_get_io_ptr(png));
    const auto bytes = reader.file_.map.bytes();
    if (count > bytes.size() - reader.position_) png_error(png, "the file ends too early");
    std::memcpy(into, bytes.data() + reader.position_, count);
    reader.position_ += count;
  }

  using Step = void (*)(PngReader&);
  /// False if libpng gave up within `step`, which must own nothing.
  bool guarded(Step step) {
    if (setjmp(back_) != 0) return false;
    step(*this);
    return true;
  }

  void read_head() {
    png_set_read_fn(png_, this, on_read);
    png_set_user_limits(png_, std::uint32_t{1} << 24, std::uint32_t{1} << 30);
    png_set_chunk_cache_max(png_, 64);
    png_set_chunk_malloc_max(png_, std::size_t{1} << 20);
    png_read_info(png_, info_);
    png_get_IHDR(png_, info_, &width_, &height_, &depth_, &colour_, &interlace_, nullptr, nullptr);
  }

  void begin_rows() {
    if (is_coloured_) {
      png_set_expand(png_);
      png_set_gray_to_rgb(png_);
      png_set_add_alpha(png_, 0xFF, PNG_FILLER_AFTER);
    } else if (depth_ == 16) {
      png_set_swap(png_);
    }
    passes_ = png_set_interlace_handling(png_);
    png_read_update_info(png_, info_);
  }

  Result<PngImage> judge(PngHeights heights) {
    const auto no = [&](std::string message) {
      return file_.error(ErrorCode::unsupported_version, "head", std::move(message));
    };
    is_coloured_ = heights != PngHeights::gray;
    if (!is_coloured_ && (colour_ != PNG_COLOR_TYPE_GRAY || depth_ < 8))
      return no(
          "expected one channel of 8 or 16 bits; if its colours are heights, say which (png_heights: "
          "terrain-rgb or terrarium)");
    if (is_coloured_ && depth_ == 16) return no("expected colours of 8 bits, found 16");
    if (interlace_ != PNG_INTERLACE_NONE && std::uint64_t{width_} * height_ * 8 > largest_block_bytes)
      return no("interlaced and too large to be read at once; write it without interlacing");
    const SampleType gray = depth_ == 8 ? SampleType::u8 : SampleType::u16;
    return PngImage{width_, height_, is_coloured_ ? SampleType::u32 : gray};
  }

  void make_samples(PngHeights heights, const png_byte* pixels, std::span<std::byte> samples) const {
    if (heights == PngHeights::gray) {
      std::memcpy(samples.data(), pixels, samples.size());
      return;
    }
    for (std::size_t i = 0; i < samples.size(); i += 4) {
      const png_byte* p = pixels + i;
      const std::uint32_t value =
          p[3] == 0 ? transparent_sample : (std::uint32_t{p[0]} << 16) | (std::uint32_t{p[1]} << 8) | p[2];
      std::memcpy(samples.data() + i, &value, 4);
    }
  }

  tl::unexpected<Error> damaged(std::string place) const {
    return file_.error(ErrorCode::corrupt, std::move(place),
                       std::string("the PNG is damaged: ") + said_.data());
  }

  const RasterFile& file_;
  std::size_t position_ = 0;
  png_structp png_ = nullptr;
  png_infop info_ = nullptr;
  std::jmp_buf back_{};
  std::array<char, 128> said_{};
  png_uint_32 width_ = 0, height_ = 0;
  int depth_ = 0, colour_ = 0, interlace_ = 0, passes_ = 1;
  bool is_coloured_ = false;
  std::vector<png_byte> pixels_;
  std::vector<png_bytep> pointers_;
};

}  // namespace

Result<PngImage> read_png_head(const RasterFile& file, PngHeights heights) {
  PngReader reader(file);
  return reader.begin(heights);
}

Result<void> decode_png(const RasterFile& file, PngHeights heights, const PngRows& rows) {
  PngReader reader(file);
  const auto image = reader.begin(heights);
  if (!image) return fail(image.error());
  CUESTA_TRY(reader.rows(*image, heights, rows));
  return file.map.check_unchanged();
}

SampleMeaning meaning_of(PngHeights heights) {
  const double none = transparent_sample;
  switch (heights) {
    case PngHeights::terrain_rgb:
      return {.no_data = {none}, .scale = 0.1, .offset = -10000};
    case PngHeights::terrarium:
      return {.no_data = {none}, .scale = 1.0 / 256, .offset = -32768};
    case PngHeights::gray:
      break;
  }
  return {};
}

}  // namespace cuesta
