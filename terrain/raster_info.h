#pragma once
/// What a file of heights says about itself: how many postings, where they are, what their numbers mean.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace cuesta {

/// From a posting's (column, row) to its coordinates in the file's reference system, in that system's units
/// (degrees of longitude x and latitude y, or projected units). Always of the posting itself: readers move
/// files whose pixels are areas by half a pixel, so nothing later knows the difference.
struct PostingMap {
  double x0 = 0, y0 = 0;  ///< of posting (0, 0)
  double x_per_column = 1, y_per_column = 0;
  double x_per_row = 0, y_per_row = -1;  ///< not rotated, rows from the north: 0 and negative

  double x(double column, double row) const { return x0 + column * x_per_column + row * x_per_row; }
  double y(double column, double row) const { return y0 + column * y_per_column + row * y_per_row; }
  bool is_axis_aligned() const { return y_per_column == 0 && x_per_row == 0; }
  bool operator==(const PostingMap&) const = default;
};

/// One entry of a GeoTIFF's GeoKeyDirectory, as it was in the file (OGC 19-008, clause 7).
struct GeoKey {
  std::uint16_t id = 0;
  std::variant<std::uint16_t, std::vector<double>, std::string> value;  ///< texts without the final '|'
};

/// The horizontal reference system in the file's own words; terrain/crs makes a projection of it.
struct CrsDescription {
  enum class Kind : std::uint8_t {
    unknown,           ///< the file does not say
    geographic_wgs84,  ///< implied by the format: .hgt, netCDF with degrees
    epsg,              ///< `epsg`, from an option, a sidecar, or implied (3857 of web tiles)
    geo_keys,          ///< `geo_keys`
    wkt,               ///< `text` is well-known text, of a .prj file or a netCDF attribute
  };
  Kind kind = Kind::unknown;
  std::uint32_t epsg = 0;
  std::vector<GeoKey> geo_keys = {};  ///< by rising id
  std::string text = {};
};

enum class VerticalDatum : std::uint8_t { unknown, orthometric, ellipsoidal };

/// How a sample is stored.
enum class SampleType : std::uint8_t { u8, i8, u16, i16, u32, i32, f32, f64 };
/// 1, 2, 4 or 8.
std::size_t bytes_of(SampleType type);
/// "int16", "float32"
const char* name(SampleType type);

/// Which samples are heights, and of how many metres.
struct SampleMeaning {
  std::vector<double> no_data =
      {};  ///< samples equal to one of these are none; never NaN, which always is none
  double least = -std::numeric_limits<double>::infinity();  ///< samples outside [least, most] are none
  double most = std::numeric_limits<double>::infinity();
  double scale = 1, offset = 0;  ///< height in the file's vertical unit = sample · scale + offset
  double unit_m = 1;             ///< metres per vertical unit: 1, 0.3048, 1200/3937, …
};

struct RasterInfo {
  std::uint64_t width = 0, height = 0;  ///< postings, each 1 to 2^31, 2^48 in all
  PostingMap map = {};
  bool is_placed = false;  ///< false: `map` is (column, -row), as the file does not say where it is
  CrsDescription crs = {};
  VerticalDatum vertical_datum = VerticalDatum::unknown;
  std::string vertical_name = {};  ///< "EGM96", "EPSG 5703"; may be empty
  SampleType type = SampleType::i16;
  SampleMeaning meaning = {};           ///< already applied by HeightRaster::read()
  std::string format = {};              ///< "SRTM", "GeoTIFF", "ESRI ASCII grid", …
  std::vector<std::string> files = {};  ///< as the user named them: the raster, then sidecars that were used
  std::vector<std::string> warnings = {};  ///< at most 8, for the user: "12 unknown tags were skipped"
};

}  // namespace cuesta
