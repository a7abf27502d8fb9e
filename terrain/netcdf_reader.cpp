/// netCDF, classic (CDF-1, -2, -5) and version 4 (HDF5): one variable whose last two dimensions have
/// coordinate variables with even steps, up or down. Source: CF conventions 1.8, chapters 2, 4, 8; COARDS;
/// GMT. The library may be in one thread at a time, so all such rasters take turns.

#include <fmt/format.h>
#include <netcdf.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "ooc/file_handle.h"
#include "ooc/read_job.h"
#include "ooc/temp_file.h"
#include "terrain/block_raster.h"
#include "terrain/netcdf_header.h"
#include "terrain/raster_readers.h"

namespace cuesta {
namespace {

std::mutex turns;

/// Of the values of coordinates: how far from even they may be, in steps. Some files have them rounded.
constexpr double most_uneven_steps = 0.05;
constexpr std::uint64_t block_bytes = std::uint64_t{1} << 20;
constexpr std::size_t most_coordinates = std::size_t{1} << 24;

class NetcdfFile {
 public:
  /// @param path  that the library can open. @pre the caller has the turn.
  static Result<std::unique_ptr<NetcdfFile>> open(RasterFile file, const std::string& path) {
    int id = -1;
    if (const int code = nc_open(path.c_str(), NC_NOWRITE, &id); code != NC_NOERR)
      return file.error(ErrorCode::corrupt, "",
                        std::string("not a netCDF file that can be read: ") + nc_strerror(code));
    return std::unique_ptr<NetcdfFile>(new NetcdfFile(std::move(file), id));
  }
  ~NetcdfFile() { nc_close(id_); }
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  int id() const { return id_; }
  const RasterFile& file() const { return file_; }
  tl::unexpected<Error> error(std::string place, std::string message, int code = NC_NOERR) const {
    if (code != NC_NOERR) message += std::string(": ") + nc_strerror(code);
    return file_.error(ErrorCode::corrupt, std::move(place), std::move(message));
  }

  /// Text of an attribute, at most 64 KiB; empty if there is none.
  std::string text(int variable, const char* attribute) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_att(id_, variable, attribute, &type, &length) != NC_NOERR || type != NC_CHAR || length > 65536)
      return {};
    std::string out(length, '\0');
    if (length > 0 && nc_get_att_text(id_, variable, attribute, out.data()) != NC_NOERR) return {};
    return out.substr(0, out.find('\0'));
  }
  /// Numbers of an attribute, at most 16; empty if there is none.
  std::vector<double> numbers(int variable, const char* attribute) const {
    nc_type type = NC_NAT;
    std::size_t length = 0;
    if (nc_inq_att(id_, variable, attribute, &type, &length) != NC_NOERR || type == NC_CHAR ||
        type > NC_UINT64 || length > 16)
      return {};
    std::vector<double> out(length);
    if (length > 0 && nc_get_att_double(id_, variable, attribute, out.data()) != NC_NOERR) return {};
    return out;
  }
  std::string variable_name(int variable) const {
    std::array<char, NC_MAX_NAME + 1> name{};
    return nc_inq_varname(id_, variable, name.data()) == NC_NOERR ? name.data() : "";
  }

 private:
  NetcdfFile(RasterFile file, int id) : file_(std::move(file)), id_(id) {}
  RasterFile file_;
  int id_;
};

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// A variable that may be heights: numbers over two dimensions, all others of length 1.
struct Grid {
  int variable = -1;
  nc_type type = NC_NAT;
  std::vector<int> dimensions = {};
  std::vector<std::size_t> lengths = {};
  std::string name = {};
  /// Attribute _Unsigned (NUG, appendix B): negative samples mean themselves plus this, of unsigned types
  /// those in the upper half themselves minus this; 0: as they are stored.
  double wrap = 0;
  bool is_unsigned = false;  ///< what they mean

  double meant(double stored) const {
    if (wrap == 0) return stored;
    if (is_unsigned) return stored < 0 ? stored + wrap : stored;
    return stored >= 0.5 * wrap ? stored - wrap : stored;
  }
  std::size_t rows() const { return lengths[lengths.size() - 2]; }
  std::size_t columns() const { return lengths.back(); }
};

std::optional<Grid> grid_of(const NetcdfFile& file, int variable) {
  Grid grid{.variable = variable, .name = file.variable_name(variable)};
  int count = 0;
  if (nc_inq_var(file.id(), variable, nullptr, &grid.type, &count, nullptr, nullptr) != NC_NOERR)
    return std::nullopt;
  if (grid.type == NC_CHAR || grid.type < NC_BYTE || grid.type > NC_UINT64 || count < 2 || count > 8)
    return std::nullopt;
  grid.dimensions.resize(std::size_t(count));
  if (nc_inq_vardimid(file.id(), variable, grid.dimensions.data()) != NC_NOERR) return std::nullopt;
  for (const int dimension : grid.dimensions) {
    std::size_t length = 0;
    if (nc_inq_dimlen(file.id(), dimension, &length) != NC_NOERR) return std::nullopt;
    grid.lengths.push_back(length);
  }
  for (std::size_t i = 0; i + 2 < grid.lengths.size(); ++i) {
    if (grid.lengths[i] != 1) return std::nullopt;
  }
  if (grid.rows() < 2 || grid.columns() < 2) return std::nullopt;
  return grid;
}

void read_signedness(const NetcdfFile& file, Grid& grid) {
  const bool is_stored_signed = grid.type == NC_BYTE || grid.type == NC_SHORT || grid.type == NC_INT;
  const bool is_stored_unsigned = grid.type == NC_UBYTE || grid.type == NC_USHORT || grid.type == NC_UINT;
  const std::string says = lower(file.text(grid.variable, "_Unsigned"));
  grid.is_unsigned = says == "true";
  if ((is_stored_signed && says == "true") || (is_stored_unsigned && says == "false"))
    grid.wrap = grid.type == NC_BYTE || grid.type == NC_UBYTE     ? 0x1p8
                : grid.type == NC_SHORT || grid.type == NC_USHORT ? 0x1p16
                                                                  : 0x1p32;
}

/// The variable that is asked for, or the only one that can be it.
Result<Grid> choose_grid(const NetcdfFile& file, const RasterOptions& options) {
  int count = 0;
  if (const int code = nc_inq_nvars(file.id(), &count); code != NC_NOERR)
    return file.error("", "cannot list the variables", code);
  std::vector<Grid> found;
  std::string names;
  for (int variable = 0; variable < count && found.size() < 100; ++variable) {
    auto grid = grid_of(file, variable);
    if (!grid || (options.variable && grid->name != *options.variable)) continue;
    read_signedness(file, *grid);
    names += (names.empty() ? "" : ", ") + quote_word(grid->name);
    found.push_back(std::move(*grid));
  }
  if (found.size() == 1) return std::move(found.front());
  if (found.empty())
    return file.file().error(ErrorCode::invalid_input, "variables",
                             options.variable
                                 ? "no grid of numbers is called " + quote_word(*options.variable)
                                 : "expected a variable with two dimensions; found none");
  return file.file().error(ErrorCode::invalid_input, "variables",
                           "several can be heights; name one as variable: " + names);
}

struct Axis {
  double first = 0, step = 0;
  bool is_longitude = false, is_latitude = false;
  bool is_rounded = false;  ///< the file's own values are not quite what `first` and `step` give
};

/// The coordinate variable of a dimension: it has the dimension's name.
Result<Axis> read_axis(const NetcdfFile& file, int dimension, std::size_t length) {
  std::array<char, NC_MAX_NAME + 1> name{};
  int variable = -1, count = 0, its_dimension = -1;
  nc_type type = NC_NAT;
  if (nc_inq_dimname(file.id(), dimension, name.data()) != NC_NOERR ||
      nc_inq_varid(file.id(), name.data(), &variable) != NC_NOERR ||
      nc_inq_var(file.id(), variable, nullptr, &type, &count, nullptr, nullptr) != NC_NOERR || count != 1 ||
      nc_inq_vardimid(file.id(), variable, &its_dimension) != NC_NOERR || its_dimension != dimension ||
      type == NC_CHAR || type > NC_UINT64)
    return file.file().error(ErrorCode::unsupported_version, quote_word(name.data()),
                             "expected coordinates of this dimension in a variable of its name");
  if (length > most_coordinates)
    return file.error(quote_word(name.data()),
                      fmt::format("expected at most 2^24 coordinates, found {}", length));
  std::vector<double> values(length);
  if (const int code = nc_get_var_double(file.id(), variable, values.data()); code != NC_NOERR)
    return file.error(quote_word(name.data()), "coordinates cannot be read", code);
  Axis axis{.first = values.front(), .step = (values.back() - values.front()) / double(length - 1)};
  if (!(std::isfinite(axis.first) && std::isfinite(axis.step) && axis.step != 0))
    return file.error(quote_word(name.data()), "expected coordinates that rise or fall");
  for (std::size_t i = 0; i < length; ++i) {
    if (std::abs(values[i] - (axis.first + double(i) * axis.step)) <= most_uneven_steps * std::abs(axis.step))
      continue;
    return file.file().error(
        ErrorCode::unsupported_version, quote_word(name.data()),
        fmt::format("steps are not even at coordinate {} of {}; resample the grid first", i, length));
  }
  const std::string units = lower(file.text(variable, "units")), called = lower(name.data());
  const std::string standard = lower(file.text(variable, "standard_name"));
  const bool degrees = units.starts_with("degree");
  axis.is_longitude = units.starts_with("degrees_e") || units.starts_with("degree_e") ||
                      standard == "longitude" || (called.starts_with("lon") && (degrees || units.empty()));
  axis.is_latitude = units.starts_with("degrees_n") || units.starts_with("degree_n") ||
                     standard == "latitude" || (called.starts_with("lat") && (degrees || units.empty()));
  // Around the whole Earth, rounded coordinates must not leave a gap or an overlap where the ends meet.
  const double around = std::copysign(360.0 / double(length), axis.step);
  if (axis.is_longitude && axis.step != around &&
      std::abs(axis.step - around) * double(length) < most_uneven_steps * std::abs(around)) {
    axis.step = around;
    axis.is_rounded = true;
  }
  return axis;
}

PostingMap map_of_axes(const Axis& columns, const Axis& rows) {
  if (columns.is_latitude || rows.is_longitude)  // the variable is (longitude, latitude)
    return {.x0 = rows.first,
            .y0 = columns.first,
            .x_per_column = 0,
            .y_per_column = columns.step,
            .x_per_row = rows.step,
            .y_per_row = 0};
  return {.x0 = columns.first, .y0 = rows.first, .x_per_column = columns.step, .y_per_row = rows.step};
}

/// Metres per unit that the text names; none: it is not known.
std::optional<double> metres_of(const std::string& units) {
  const std::string u = lower(units);
  for (const char* metre : {"", "m", "meter", "meters", "metre", "metres", "user_z_unit", "1"}) {
    if (u == metre) return 1.0;
  }
  for (const char* kilometre : {"km", "kilometer", "kilometers", "kilometre", "kilometres"}) {
    if (u == kilometre) return 1000.0;
  }
  for (const char* centimetre : {"cm", "centimeter", "centimeters", "centimetre", "centimetres"}) {
    if (u == centimetre) return 0.01;
  }
  for (const char* foot : {"ft", "foot", "feet"}) {
    if (u == foot) return 0.3048;
  }
  return std::nullopt;
}

/// What the library fills with where nobody has written; of types whose fill cannot be a height.
std::optional<double> default_fill(nc_type type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_FLOAT:
      return double(NC_FILL_FLOAT);
    case NC_DOUBLE:
      return NC_FILL_DOUBLE;
    default:
      return std::nullopt;
  }
}

Result<void> read_meaning(const NetcdfFile& file, const Grid& grid, const RasterOptions& options,
                          SampleMeaning& meaning) {
  const auto fill = file.numbers(grid.variable, "_FillValue");
  meaning.no_data = fill;
  for (const double value : file.numbers(grid.variable, "missing_value")) meaning.no_data.push_back(value);
  if (const auto usual = default_fill(grid.type); fill.empty() && usual) meaning.no_data.push_back(*usual);
  std::erase_if(meaning.no_data, [](double value) { return std::isnan(value); });
  for (double& value : meaning.no_data) value = grid.meant(value);
  if (grid.type == NC_FLOAT) {  // a value written in more digits than the samples have
    for (double& value : meaning.no_data) {
      if (std::abs(value) <= double(std::numeric_limits<float>::max())) value = double(float(value));
    }
  }
  if (const auto v = file.numbers(grid.variable, "valid_min"); v.size() == 1)
    meaning.least = grid.meant(v[0]);
  if (const auto v = file.numbers(grid.variable, "valid_max"); v.size() == 1) meaning.most = grid.meant(v[0]);
  if (const auto v = file.numbers(grid.variable, "valid_range"); v.size() == 2) {
    meaning.least = grid.meant(v[0]);
    meaning.most = grid.meant(v[1]);
  }
  if (const auto v = file.numbers(grid.variable, "scale_factor"); v.size() == 1) meaning.scale = v[0];
  if (const auto v = file.numbers(grid.variable, "add_offset"); v.size() == 1) meaning.offset = v[0];
  const std::string units = file.text(grid.variable, "units");
  const auto metres = metres_of(units);
  if (!metres && !options.unit_m)
    return file.file().error(
        ErrorCode::invalid_input, quote_word(grid.name),
        fmt::format("unit {} is not known to be a height; give its metres as unit_m", quote_word(units)));
  meaning.unit_m = metres.value_or(1);
  return {};
}

/// From a variable of CF's grid mapping, where the heights name one.
void read_crs(const NetcdfFile& file, const Grid& grid, bool is_geographic, CrsDescription& crs) {
  int mapping = -1;
  const std::string name = file.text(grid.variable, "grid_mapping");
  if (!name.empty() && nc_inq_varid(file.id(), name.c_str(), &mapping) == NC_NOERR) {
    crs.text = file.text(mapping, "crs_wkt");
    if (crs.text.empty()) crs.text = file.text(mapping, "spatial_ref");
  }
  if (!crs.text.empty())
    crs.kind = CrsDescription::Kind::wkt;
  else if (is_geographic)
    crs.kind = CrsDescription::Kind::geographic_wgs84;
}

struct BlockSize {
  std::uint64_t width = 0, height = 0;
};

/// A chunk, or rows of contiguous samples: about 1 MiB as f64.
Result<BlockSize> block_size(const NetcdfFile& file, const Grid& grid) {
  std::array<std::size_t, 8> chunk{};
  int storage = NC_CONTIGUOUS;
  const std::uint64_t most = block_bytes / sizeof(double);
  if (nc_inq_var_chunking(file.id(), grid.variable, &storage, chunk.data()) == NC_NOERR &&
      storage == NC_CHUNKED) {
    const std::uint64_t width = chunk[grid.lengths.size() - 1], height = chunk[grid.lengths.size() - 2];
    if (width == 0 || height == 0 || width > largest_block_bytes || height > largest_block_bytes ||
        width * height * sizeof(double) > largest_block_bytes)
      return file.file().error(
          ErrorCode::out_of_budget, quote_word(grid.name),
          fmt::format("a chunk of {} × {} samples is more than is decoded at once", width, height));
    // The library's own cache holds one chunk: ours keeps what was decoded.
    nc_set_var_chunk_cache(file.id(), grid.variable, width * height * sizeof(double), 1, 0.75F);
    return BlockSize{std::min<std::uint64_t>(width, grid.columns()),
                     std::min<std::uint64_t>(height, grid.rows())};
  }
  const std::uint64_t width = std::min<std::uint64_t>(grid.columns(), most);
  return BlockSize{width, std::min<std::uint64_t>(grid.rows(), std::max<std::uint64_t>(1, most / width))};
}

class Netcdf final : public BlockRaster {
 public:
  Netcdf(RasterInfo info, Grid grid, BlockSize size, std::uint64_t cache_bytes,
         std::unique_ptr<NetcdfFile> file)
      // Besides our block the library holds a chunk, packed and unpacked.
      : BlockRaster(std::move(info),
                    {SampleType::f64, size.width, size.height, size.width * size.height * 16}, cache_bytes,
                    &turns),
        grid_(std::move(grid)),
        size_(size),
        file_(std::move(file)) {}
  ~Netcdf() override {
    const std::scoped_lock lock(turns);
    file_.reset();
  }

 protected:
  Result<void> load_block(std::uint64_t bx, std::uint64_t by, std::span<std::byte> samples) const override {
    const std::uint64_t column = bx * size_.width, row = by * size_.height;
    const std::uint64_t width = std::min(size_.width, grid_.columns() - column);
    const std::uint64_t height = std::min(size_.height, grid_.rows() - row);
    std::vector<std::size_t> start(grid_.lengths.size(), 0), count(grid_.lengths.size(), 1);
    start[start.size() - 2] = row;
    start.back() = column;
    count[count.size() - 2] = height;
    count.back() = width;
    auto* values = reinterpret_cast<double*>(samples.data());  // from a vector of bytes: aligned as by new
    if (const int code = nc_get_vara_double(file_->id(), grid_.variable, start.data(), count.data(), values);
        code != NC_NOERR)
      return file_->error(fmt::format("{} rows {} to {}", quote_word(grid_.name), row, row + height - 1),
                          "cannot be read; the file is damaged or cut off", code);
    for (double& value : std::span(values, width * height)) value = grid_.meant(value);
    for (std::uint64_t r = height; width < size_.width && r-- > 1;)
      std::memmove(values + r * size_.width, values + r * width, width * sizeof(double));
    return {};
  }

 private:
  Grid grid_;
  BlockSize size_;
  std::unique_ptr<NetcdfFile> file_;
};

/// A name for the library to open. Of an unpacked file that is a copy, whose name is removed once it is open.
class NameForLibrary {
 public:
  static Result<NameForLibrary> of(const RasterFile& file, const std::filesystem::path& temp) {
    NameForLibrary name;
    if (!file.is_unpacked) {
      // Absolute, so that it is never taken for an address on the network.
      std::error_code ignored;
      name.path_ = std::filesystem::absolute(file.path, ignored).string();
      return name;
    }
    name.path_ = (temp_folder(temp) / "cuesta-XXXXXX").string();
    const int descriptor = ::mkostemp(name.path_.data(), 0);
    if (descriptor < 0)
      return fail(ErrorCode::io, temp_folder(temp).string(), "",
                  std::string("cannot make a temporary file: ") + std::strerror(errno));
    name.is_temporary_ = true;
    const bool written = write_all(descriptor, file.map.bytes());
    const int number = errno;
    ::close(descriptor);
    if (!written)
      return fail(code_of_errno(number), temp_folder(temp).string(), "",
                  std::string("cannot write a temporary file: ") + std::strerror(number));
    return name;
  }
  NameForLibrary(NameForLibrary&& other) noexcept
      : path_(std::move(other.path_)), is_temporary_(std::exchange(other.is_temporary_, false)) {}
  NameForLibrary& operator=(NameForLibrary&&) = delete;
  ~NameForLibrary() {
    if (is_temporary_) ::unlink(path_.c_str());
  }
  const std::string& path() const { return path_; }

 private:
  NameForLibrary() = default;
  static bool write_all(int descriptor, std::span<const char> bytes) {
    while (!bytes.empty()) {
      const ssize_t done = ::write(descriptor, bytes.data(), std::min<std::size_t>(bytes.size(), 1 << 20));
      if (done < 0) return false;
      bytes = bytes.subspan(std::size_t(done));
    }
    return true;
  }
  std::string path_;
  bool is_temporary_ = false;
};

}  // namespace

RasterResult open_netcdf(RasterFile file, const RasterOptions& options) {
  CUESTA_TRY(check_netcdf_header(file));
  const std::scoped_lock lock(turns);
  const auto name = NameForLibrary::of(file, options.temp);
  if (!name) return fail(name.error());
  file.map = {};  // the library opens it itself
  auto opened = NetcdfFile::open(std::move(file), name->path());
  if (!opened) return fail(std::move(opened).error());
  const NetcdfFile& netcdf = **opened;
  auto grid = choose_grid(netcdf, options);
  if (!grid) return fail(std::move(grid).error());
  const auto rows = read_axis(netcdf, grid->dimensions[grid->dimensions.size() - 2], grid->rows());
  if (!rows) return fail(rows.error());
  const auto columns = read_axis(netcdf, grid->dimensions.back(), grid->columns());
  if (!columns) return fail(columns.error());
  RasterInfo info{.width = grid->columns(),
                  .height = grid->rows(),
                  .map = map_of_axes(*columns, *rows),
                  .is_placed = true,
                  .type = SampleType::f64,
                  .format = "netCDF"};
  info.files = {netcdf.file().path.string()};
  if (columns->is_rounded || rows->is_rounded)
    info.warnings.push_back("longitudes are rounded; taken as evenly spaced around the Earth");
  const bool is_geographic =
      (columns->is_longitude && rows->is_latitude) || (columns->is_latitude && rows->is_longitude);
  read_crs(netcdf, *grid, is_geographic, info.crs);
  CUESTA_TRY(read_meaning(netcdf, *grid, options, info.meaning));
  apply_options(info, options);
  CUESTA_TRY(check_info(info, netcdf.file()));
  const auto size = block_size(netcdf, *grid);
  if (!size) return fail(size.error());
  return std::make_unique<Netcdf>(std::move(info), std::move(*grid), *size, options.cache_bytes,
                                  std::move(*opened));
}

}  // namespace cuesta
