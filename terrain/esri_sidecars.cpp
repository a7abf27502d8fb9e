#include "terrain/esri_sidecars.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "ooc/read_job.h"
#include "ooc/text_cursor.h"

namespace cuesta {
namespace {

constexpr std::size_t most_bytes = std::size_t{1} << 16;

/// The raster's name without what only says how it is packed.
std::filesystem::path unpacked_path(const RasterFile& file) {
  std::filesystem::path path = file.path;
  for (const char* packed : {".gz", ".zst", ".zip"}) {
    if (path.extension() == packed) return path.replace_extension();
  }
  return path;
}

std::filesystem::path world_file_of(const RasterFile& file) {
  const std::filesystem::path raster = unpacked_path(file);
  const std::string extension = raster.extension().string();
  std::vector<std::string> names{extension + "w", ".wld"};
  if (extension.size() == 4) names.insert(names.begin(), {'.', extension[1], extension[3], 'w'});
  for (const std::string& name : names) {
    std::filesystem::path path = raster;
    path.replace_extension(name);
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) return path;
  }
  return {};
}

}  // namespace

Result<void> read_world_file(const RasterFile& file, RasterInfo& info) {
  const std::filesystem::path path = info.is_placed ? std::filesystem::path() : world_file_of(file);
  if (path.empty()) return {};
  const auto text = MappedFile::open(path);
  if (!text) return fail(text.error());
  const auto bytes = text->bytes().first(std::min(text->bytes().size(), most_bytes));
  TextCursor cursor{bytes.data(), bytes.data() + bytes.size()};
  std::array<double, 6> v{};  // x and y per column, x and y per row, x and y of the upper left pixel's middle
  for (std::size_t i = 0; i < v.size(); ++i) {
    cursor.skip_spaces();
    const auto value = cursor.real();
    if (!value || !cursor.at_word_end() || !std::isfinite(*value))
      return fail(ErrorCode::corrupt, path.string(), fmt::format("line {}", i + 1),
                  "expected one of the six numbers of a world file");
    v[i] = *value;
  }
  CUESTA_TRY(text->check_unchanged());
  info.map = {.x0 = v[4],
              .y0 = v[5],
              .x_per_column = v[0],
              .y_per_column = v[1],
              .x_per_row = v[2],
              .y_per_row = v[3]};
  info.is_placed = true;
  info.files.push_back(path.string());
  return {};
}

void read_prj(const RasterFile& file, RasterInfo& info) {
  if (info.crs.kind != CrsDescription::Kind::unknown) return;
  const std::filesystem::path path = unpacked_path(file).replace_extension(".prj");
  const auto prj = MappedFile::open(path);
  if (!prj || prj->bytes().empty() || prj->bytes().size() > most_bytes) return;
  info.crs.kind = CrsDescription::Kind::wkt;
  info.crs.text.assign(prj->bytes().begin(), prj->bytes().end());
  info.files.push_back(path.string());
}

}  // namespace cuesta
