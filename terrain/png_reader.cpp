/// One PNG of heights: gray, or in colours (terrain-RGB, terrarium). The file says only its size; the rest is
/// in the options or a sidecar. Unpacked to a temporary file by the first read, as PNG is read from front to
/// back.

#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "terrain/esri_sidecars.h"
#include "terrain/png_image.h"
#include "terrain/raster_readers.h"
#include "terrain/sample_file.h"

namespace cuesta {
namespace {

Result<MappedFile> unpack_png(const RasterFile& file, PngHeights heights, std::uint64_t bytes,
                              const std::filesystem::path& temp) {
  auto unpacked = TempFile::create(temp);
  if (!unpacked) return fail(std::move(unpacked).error());
  CUESTA_TRY(unpacked->expect(bytes));
  CUESTA_TRY(decode_png(file, heights, [&](std::span<const std::byte> row) {
    return unpacked->write({reinterpret_cast<const char*>(row.data()), row.size()});
  }));
  return unpacked->map();
}

}  // namespace

RasterResult open_png(RasterFile file, const RasterOptions& options) {
  const PngHeights heights = options.png_heights.value_or(PngHeights::gray);
  const auto image = read_png_head(file, heights);
  if (!image) return fail(image.error());
  RasterInfo info{.width = image->width, .height = image->height, .type = image->type, .format = "PNG"};
  if (options.type && heights == PngHeights::gray) {
    if (bytes_of(*options.type) != bytes_of(image->type))
      return file.error(ErrorCode::invalid_input, "type",
                        std::string("expected a type of the file's size, ") + name(image->type) + "; found " +
                            name(*options.type));
    info.type = *options.type;
  }
  info.meaning = meaning_of(heights);
  info.files = {file.path.string()};
  if (!options.placement) CUESTA_TRY(read_world_file(file, info));
  read_prj(file, info);
  apply_options(info, options);
  CUESTA_TRY(check_info(info, file));
  const SampleLayout layout{.type = info.type};
  const std::uint64_t bytes = sample_bytes(info, info.type);
  // std::function wants to be copied; the reading itself is under the raster's mutex.
  const auto shared = std::make_shared<const RasterFile>(std::move(file));
  return make_unpacked_raster(
      std::move(info),
      [shared, heights, bytes, temp = options.temp] { return unpack_png(*shared, heights, bytes, temp); },
      layout);
}

}  // namespace cuesta
