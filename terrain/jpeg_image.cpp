#include "terrain/jpeg_image.h"

// jpeglib.h needs them before it.
#include <csetjmp>
#include <cstdio>
#include <vector>

#include <jpeglib.h>

#include "ooc/read_job.h"

namespace cuesta {
namespace {

constexpr int most_scans = 500;  // of a picture that is not made to take forever

/// libjpeg jumps out of its calls; each is made by a function that owns nothing (guarded() below).
class JpegReader {
 public:
  explicit JpegReader(const RasterFile& file) : file_(file) {
    jpeg_.err = jpeg_std_error(&errors_);
    errors_.error_exit = on_error;
    errors_.emit_message = on_message;
    progress_.progress_monitor = on_progress;
    jpeg_.client_data = this;
    is_made_ = guarded([](JpegReader& r) { jpeg_create_decompress(&r.jpeg_); });
  }
  ~JpegReader() {
    if (is_made_) jpeg_destroy_decompress(&jpeg_);
  }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  Result<JpegSize> begin() {
    if (!is_made_ || !guarded([](JpegReader& r) { r.read_head(); })) return damaged("head");
    const auto no = [&](const char* message) {
      return file_.error(ErrorCode::unsupported_version, "head", message);
    };
    if (jpeg_.num_components != 1 && jpeg_.num_components != 3)
      return no("expected gray or three colours; CMYK is not read");
    const std::uint64_t coefficients = std::uint64_t{jpeg_.image_width} * jpeg_.image_height *
                                       static_cast<unsigned>(jpeg_.num_components) * 2;
    if (jpeg_has_multiple_scans(&jpeg_) && coefficients > most_jpeg_coefficient_bytes)
      return no("progressive and too large to be read at once; write it as a baseline JPEG");
    return JpegSize{jpeg_.image_width, jpeg_.image_height};
  }

  /// @pre begin() was good.
  Result<void> rows(const JpegSize& size, const JpegRows& sink) {
    if (!guarded([](JpegReader& r) { r.begin_rows(); })) return damaged("head");
    bytes_.resize(std::size_t{size.width} * 3);
    std::vector<Rgba8> row(size.width);
    for (std::uint32_t y = 0; y < size.height; ++y) {
      if (!guarded([](JpegReader& r) { r.read_row(); }) || errors_.num_warnings > 0)
        return damaged("row " + std::to_string(y));
      for (std::size_t x = 0; x < row.size(); ++x)
        row[x] = {bytes_[3 * x], bytes_[3 * x + 1], bytes_[3 * x + 2], 255};
      CUESTA_TRY(sink(row));
    }
    return {};
  }

 private:
  static JpegReader& self(j_common_ptr jpeg) { return *static_cast<JpegReader*>(jpeg->client_data); }
  static void on_error(j_common_ptr jpeg) {
    jpeg->err->format_message(jpeg, self(jpeg).said_);
    std::longjmp(self(jpeg).back_, 1);
  }
  /// Warnings are of damaged data: libjpeg would go on with gray.
  static void on_message(j_common_ptr jpeg, int level) {
    if (level >= 0) return;
    if (jpeg->err->num_warnings++ == 0) jpeg->err->format_message(jpeg, self(jpeg).said_);
  }
  static void on_progress(j_common_ptr jpeg) {
    if (self(jpeg).jpeg_.input_scan_number <= most_scans) return;
    std::snprintf(self(jpeg).said_, JMSG_LENGTH_MAX, "more than %d scans", most_scans);
    std::longjmp(self(jpeg).back_, 1);
  }

  using Step = void (*)(JpegReader&);
  /// False if libjpeg gave up within `step`, which must own nothing.
  bool guarded(Step step) {
    if (setjmp(back_) != 0) return false;
    step(*this);
    return true;
  }

  void read_head() {
    const auto bytes = file_.map.bytes();
    jpeg_.progress = &progress_;
    jpeg_mem_src(&jpeg_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&jpeg_, TRUE);
  }
  void begin_rows() {
    jpeg_.out_color_space = JCS_RGB;
    jpeg_start_decompress(&jpeg_);
  }
  void read_row() {
    JSAMPROW row = bytes_.data();
    jpeg_read_scanlines(&jpeg_, &row, 1);
  }
  tl::unexpected<Error> damaged(std::string place) const {
    return file_.error(ErrorCode::corrupt, std::move(place), std::string("the JPEG is damaged: ") + said_);
  }

  const RasterFile& file_;
  jpeg_decompress_struct jpeg_{};
  jpeg_error_mgr errors_{};
  jpeg_progress_mgr progress_{};
  std::jmp_buf back_{};
  char said_[JMSG_LENGTH_MAX] = "";
  bool is_made_ = false;
  std::vector<unsigned char> bytes_;
};

}  // namespace

Result<JpegSize> read_jpeg_head(const RasterFile& file) {
  JpegReader reader(file);
  return reader.begin();
}

Result<void> decode_jpeg(const RasterFile& file, const JpegRows& rows) {
  JpegReader reader(file);
  const auto size = reader.begin();
  if (!size) return fail(size.error());
  CUESTA_TRY(reader.rows(*size, rows));
  return file.map.check_unchanged();
}

}  // namespace cuesta
