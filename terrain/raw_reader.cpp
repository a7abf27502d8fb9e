/// Samples row by row and nothing else, perhaps after a header that is skipped. Options or a sidecar say what
/// they are; names like .i16 and .f32 give the type, and a square needs no width and height.

#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "ooc/read_job.h"
#include "terrain/raster_readers.h"
#include "terrain/sample_file.h"

namespace cuesta {
namespace {

std::optional<SampleType> type_by_name(const std::string& name) {
  const std::string extension = std::filesystem::path(name).extension().string();
  if (extension == ".i16") return SampleType::i16;
  if (extension == ".u16") return SampleType::u16;
  if (extension == ".i32") return SampleType::i32;
  if (extension == ".f32") return SampleType::f32;
  if (extension == ".f64") return SampleType::f64;
  return std::nullopt;
}

struct Size {
  std::uint64_t width = 0, height = 0;
};

/// As given; a missing side from the number of samples; of none, the square's.
Result<Size> size_of(const RasterFile& file, const RasterOptions& options, std::uint64_t samples) {
  if (options.width && options.height) return Size{*options.width, *options.height};
  if (options.width) return Size{*options.width, samples / *options.width};
  if (options.height) return Size{samples / *options.height, *options.height};
  const auto n = static_cast<std::uint64_t>(std::llround(std::sqrt(static_cast<double>(samples))));
  if (n * n == samples) return Size{n, n};
  return file.error(
      ErrorCode::invalid_input, "size",
      fmt::format("{} samples are not a square; give width and height in the options or in {}.json", samples,
                  file.path.filename().string()));
}

}  // namespace

RasterResult open_raw(RasterFile file, const RasterOptions& options) {
  const std::optional<SampleType> type = options.type ? options.type : type_by_name(file.inner_name);
  if (!type)
    return file.error(
        ErrorCode::invalid_input, "type",
        fmt::format("of raw samples the type must be known; give it in the options or in {}.json",
                    file.path.filename().string()));
  const std::uint64_t header = options.header_bytes.value_or(0);
  const std::uint64_t rest = file.size() > header ? file.size() - header : 0;
  const auto size = size_of(file, options, rest / bytes_of(*type));
  if (!size) return fail(size.error());
  RasterInfo info{.width = size->width, .height = size->height, .type = *type, .format = "raw"};
  info.files = {file.path.string()};
  apply_options(info, options);
  CUESTA_TRY(check_info(info, file));
  if (sample_bytes(info, *type) != rest)
    return file.error(
        ErrorCode::corrupt, fmt::format("byte {}", file.size()),
        fmt::format("expected {} × {} samples of {} after {} bytes of header, {} bytes; found {}", info.width,
                    info.height, name(*type), header, header + sample_bytes(info, *type), file.size()));
  const SampleLayout layout{header, *type, options.byte_order.value_or(ByteOrder::little)};
  return make_sample_raster(std::move(info), std::move(file), layout);
}

}  // namespace cuesta
