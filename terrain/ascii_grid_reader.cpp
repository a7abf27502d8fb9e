/// ESRI ASCII grid: a head of keys and values in any order, then heights from the north-west, however broken
/// into lines. Opening runs over the text once and notes where each block of postings begins.
/// Source: Esri, "Esri ASCII raster format".

#include <fmt/format.h>

#include <cctype>
#include <cmath>
#include <map>

#include "ooc/read_job.h"
#include "ooc/text_cursor.h"
#include "terrain/block_raster.h"
#include "terrain/esri_sidecars.h"
#include "terrain/raster_readers.h"

namespace cuesta {
namespace {

constexpr std::uint64_t block_postings = std::uint64_t{1} << 17;
/// Pages of the map are given back after so much text.
constexpr std::ptrdiff_t release_bytes = std::ptrdiff_t{4} << 20;

struct Head {
  std::map<std::string, double> values;
  const char* end = nullptr;
  bool has(const char* key) const { return values.contains(key); }
  double get(const char* key, double otherwise = 0) const {
    const auto found = values.find(key);
    return found == values.end() ? otherwise : found->second;
  }
};

bool is_key(const std::string& word) {
  for (const char* key : {"ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize",
                          "dx", "dy", "nodata_value"}) {
    if (word == key) return true;
  }
  return false;
}

std::string place_of(const RasterFile& file, const char* at) {
  return fmt::format("byte {}", at - file.map.bytes().data());
}

/// Keys until a word that is a number.
Result<Head> read_head(const RasterFile& file) {
  Head head;
  TextCursor cursor{file.text().data(), file.text().data() + file.text().size()};
  for (;;) {
    cursor.skip_spaces();
    head.end = cursor.at;
    if (cursor.done() || !std::isalpha(static_cast<unsigned char>(*cursor.at))) return head;
    std::string word(cursor.word().substr(0, 64));
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (word == "nan" || word == "inf") return head;  // a height
    if (word == "xllcentre" || word == "yllcentre") word.replace(6, 3, "ter");
    if (!is_key(word))
      return file.error(ErrorCode::corrupt, place_of(file, head.end),
                        "expected a key of an ESRI ASCII grid, found " + quote_word(word));
    cursor.skip_blanks();
    const auto value = cursor.real();
    if (!value || !cursor.at_word_end())
      return file.error(ErrorCode::corrupt, place_of(file, cursor.at),
                        fmt::format("expected a number after {}", word));
    head.values[word] = *value;
  }
}

Result<std::uint64_t> count_of(const RasterFile& file, const Head& head, const char* key) {
  const double value = head.get(key);
  if (value >= 1 && value <= double(most_postings_per_side) && value == std::floor(value))
    return static_cast<std::uint64_t>(value);
  return file.error(ErrorCode::corrupt, "head",
                    fmt::format("expected {} from 1 to 2^31, found {}", key, value));
}

/// Coordinate of the first posting, given that of the lower left corner or posting.
Result<double> lower_left(const RasterFile& file, const Head& head, const char* corner, const char* centre,
                          double spacing) {
  if (head.has(corner)) return head.get(corner) + 0.5 * spacing;
  if (head.has(centre)) return head.get(centre);
  return file.error(ErrorCode::corrupt, "head", fmt::format("expected {} or {}", corner, centre));
}

Result<RasterInfo> info_of(const RasterFile& file, const Head& head) {
  RasterInfo info{.is_placed = true, .type = SampleType::f64, .format = "ESRI ASCII grid"};
  const auto width = count_of(file, head, "ncols"), height = count_of(file, head, "nrows");
  if (!width) return fail(width.error());
  if (!height) return fail(height.error());
  info.width = *width;
  info.height = *height;
  const double dx = head.get("dx", head.get("cellsize")), dy = head.get("dy", head.get("cellsize"));
  if (!(dx > 0 && dy > 0)) return file.error(ErrorCode::corrupt, "head", "expected a cellsize above 0");
  const auto x = lower_left(file, head, "xllcorner", "xllcenter", dx);
  const auto y = lower_left(file, head, "yllcorner", "yllcenter", dy);
  if (!x) return fail(x.error());
  if (!y) return fail(y.error());
  info.map = map_of({.x = *x, .y = *y + double(info.height - 1) * dy, .x_spacing = dx, .y_spacing = dy});
  info.meaning.no_data = {head.get("nodata_value", -9999)};
  info.files = {file.path.string()};
  return info;
}

class AsciiGrid final : public BlockRaster {
 public:
  AsciiGrid(RasterInfo info, const Blocks& blocks, std::uint64_t cache_bytes, RasterFile file,
            std::vector<std::uint64_t> starts, std::uint64_t width, std::uint64_t height)
      : BlockRaster(std::move(info), blocks, cache_bytes),
        file_(std::move(file)),
        starts_(std::move(starts)),
        block_width_(width),
        block_height_(height) {}

 protected:
  Result<void> load_block(std::uint64_t bx, std::uint64_t by, std::span<std::byte> samples) const override {
    const std::uint64_t per_row = (info_.width + block_width_ - 1) / block_width_;
    const std::uint64_t width = std::min(block_width_, info_.width - bx * block_width_);
    const std::uint64_t height = std::min(block_height_, info_.height - by * block_height_);
    const std::string_view text = file_.text();
    TextCursor cursor{text.data() + starts_[by * per_row + bx], text.data() + text.size()};
    const char* const first = cursor.at;
    // A block is narrower than the raster only where it is one row high: its postings follow each other.
    auto read = read_numbers(cursor, width * height, samples);
    file_.map.release(first, cursor.at);
    if (file_.map.has_faulted())
      return file_.error(ErrorCode::io, place_of(file_, first), "the file was changed or cannot be read");
    return read;
  }

 private:
  Result<void> read_numbers(TextCursor& cursor, std::uint64_t count, std::span<std::byte> samples) const {
    for (std::uint64_t i = 0; i < count; ++i) {
      cursor.skip_spaces();
      const char* const first = cursor.at;
      const auto value = cursor.real();
      if (!value || !cursor.at_word_end()) return not_a_height(first);
      std::memcpy(samples.data() + i * sizeof(double), &*value, sizeof(double));
    }
    return {};
  }

  tl::unexpected<Error> not_a_height(const char* at) const {
    const std::string_view text = file_.text();
    const std::string_view word = TextCursor{at, text.data() + text.size()}.word();
    return file_.error(ErrorCode::corrupt, place_of(file_, at),
                       "expected a height, found " + quote_word(word));
  }

  RasterFile file_;
  std::vector<std::uint64_t> starts_;  ///< bytes where the blocks begin
  std::uint64_t block_width_, block_height_;
};

/// Where every block of postings begins. The head's counts are compared with the file before anything is
/// allocated for them.
Result<std::vector<std::uint64_t>> index_blocks(const RasterFile& file, const char* at,
                                                const RasterInfo& info, std::uint64_t block_width,
                                                std::uint64_t block_height) {
  const std::uint64_t postings = info.width * info.height;
  const char* const end = file.text().data() + file.text().size();
  if (postings > static_cast<std::uint64_t>(end - at) / 2 + 1)
    return file.error(
        ErrorCode::corrupt, place_of(file, end),
        fmt::format("expected {} × {} heights, the file ends too early", info.height, info.width));
  std::vector<std::uint64_t> starts;
  const char* released = at;
  std::uint64_t posting = 0, next_start = 0;
  for (;; ++posting) {
    while (at != end && TextCursor::is_space(*at)) ++at;
    if (at == end || posting == postings) break;
    if (posting == next_start) {
      starts.push_back(static_cast<std::uint64_t>(at - file.text().data()));
      const std::uint64_t column = posting % info.width;
      next_start +=
          block_height > 1 ? block_width * block_height : std::min(block_width, info.width - column);
    }
    while (at != end && !TextCursor::is_space(*at)) ++at;
    if (at - released > release_bytes) {
      file.map.release(released, at);
      released = at;
    }
  }
  file.map.release(released, at);
  if (posting < postings || at != end)
    return file.error(ErrorCode::corrupt, place_of(file, at),
                      fmt::format("expected {} × {} heights, found {}", info.height, info.width,
                                  posting < postings ? fmt::format("{}", posting) : "more"));
  CUESTA_TRY(file.map.check_unchanged());
  return starts;
}

}  // namespace

RasterResult open_ascii_grid(RasterFile file, const RasterOptions& options) {
  const auto head = read_head(file);
  if (!head) return fail(head.error());
  auto info = info_of(file, *head);
  if (!info) return fail(info.error());
  read_prj(file, *info);
  apply_options(*info, options);
  CUESTA_TRY(check_info(*info, file));
  const std::uint64_t block_width = std::min(info->width, block_postings);
  const std::uint64_t block_height =
      block_width < info->width
          ? 1
          : std::min(info->height, std::max<std::uint64_t>(1, block_postings / block_width));
  auto starts = index_blocks(file, head->end, *info, block_width, block_height);
  if (!starts) return fail(starts.error());
  const std::uint64_t index_bytes = starts->size() * sizeof(std::uint64_t);
  return std::make_unique<AsciiGrid>(
      std::move(*info), BlockRaster::Blocks{SampleType::f64, block_width, block_height, index_bytes},
      options.cache_bytes, std::move(file), std::move(*starts), block_width, block_height);
}

}  // namespace cuesta
