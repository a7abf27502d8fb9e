#include "apps/cuesta/terrain_input.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>

#include "ooc/unpacked_file.h"

namespace cuesta::app {
namespace {

/// Wider than this, in degrees, a terrain is a part of the globe rather than a place.
constexpr double widest_local_frame_deg = 10;

constexpr std::array<std::string_view, 17> raster_names{".hgt", ".tif", ".tiff", ".asc", ".grd", ".png",
                                                        ".nc",  ".nc4", ".cdf",  ".dem", ".raw", ".bin",
                                                        ".i16", ".u16", ".i32",  ".f32", ".f64"};

std::string lower_extension(const std::filesystem::path& path) {
  std::string text = path.extension().string();
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

/// Names beside a raster or an image that may say where it lies, or what it is: of JSON, projections and
/// world files, of it as it is and as it is unpacked.
std::vector<std::filesystem::path> sidecars_of(const std::filesystem::path& path) {
  std::vector<std::filesystem::path> out;
  const auto unpacked = path.parent_path() / name_inside(path.filename());
  for (const auto& raster : {path, unpacked}) {
    const std::string extension = raster.extension().string();
    std::vector<std::string> names{".json", ".prj", ".wld", extension + "w"};
    if (extension.size() == 4) names.push_back({'.', extension[1], extension[3], 'w'});
    for (const std::string& name : names) {
      out.push_back(raster.string() + name);
      out.push_back(std::filesystem::path(raster).replace_extension(name));
    }
  }
  return out;
}

/// Of all postings' rims.
std::optional<GeoBox> bounds_of(const Mosaic& mosaic) {
  constexpr int steps = 64;
  std::optional<GeoBox> box;
  for (const MosaicLayer& layer : mosaic.layers()) {
    double near_lon = 0;
    bool known = false;
    const auto add = [&](double column, double row) {
      const LatLon at = layer.crs.lat_lon({layer.map.x(column, row), layer.map.y(column, row)});
      if (!std::isfinite(at.lat_deg) || !std::isfinite(at.lon_deg)) return;
      double lon = at.lon_deg;
      if (known) lon -= 360 * std::round((lon - near_lon) / 360);
      near_lon = lon;
      known = true;
      if (!box) box = GeoBox{lon, at.lat_deg, lon, at.lat_deg};
      box->west_deg = std::min(box->west_deg, lon);
      box->east_deg = std::max(box->east_deg, lon);
      box->south_deg = std::min(box->south_deg, at.lat_deg);
      box->north_deg = std::max(box->north_deg, at.lat_deg);
    };
    const double w = static_cast<double>(layer.width - 1), h = static_cast<double>(layer.height - 1);
    for (int i = 0; i <= steps; ++i) add(w * i / steps, 0);
    for (int i = 0; i <= steps; ++i) add(w, h * i / steps);
    for (int i = steps; i >= 0; --i) add(w * i / steps, h);
    for (int i = steps; i >= 0; --i) add(0, h * i / steps);
  }
  return box;
}

LatLon middle_of(const GeoBox& b) {
  return {(b.south_deg + b.north_deg) / 2, std::remainder((b.west_deg + b.east_deg) / 2, 360.0)};
}

/// Whether all layers are on one plane, and which.
const Crs* common_plane(const Mosaic& mosaic) {
  const Crs& first = mosaic.layers().front().crs;
  if (first.geographic()) return nullptr;
  const auto same = [&](const MosaicLayer& l) {
    return !l.crs.geographic() && same_coordinates(l.crs.definition(), first.definition());
  };
  return std::all_of(mosaic.layers().begin(), mosaic.layers().end(), same) ? &first : nullptr;
}

/// Whether a plane that is nowhere on the Earth has coordinates as degrees have them.
bool looks_like_degrees(const MosaicLayer& layer) {
  if (layer.crs.definition().method != CrsMethod::plane) return false;
  const PostingMap& map = layer.map;
  const double columns = static_cast<double>(layer.width - 1), rows = static_cast<double>(layer.height - 1);
  const auto within = [&](double column, double row) {
    return std::abs(map.x(column, row)) <= 360 && std::abs(map.y(column, row)) <= 90;
  };
  return std::abs(map.x_per_column) < 1 && std::abs(map.y_per_row) < 1 && within(0, 0) &&
         within(columns, rows);
}

Result<Frame> frame_of(const Mosaic& mosaic, const std::optional<GeoBox>& bounds, const TerrainSettings& s) {
  const Crs* plane = common_plane(mosaic);
  FrameChoice choice = s.frame;
  const bool is_wide = !bounds || bounds->east_deg - bounds->west_deg > widest_local_frame_deg ||
                       bounds->north_deg - bounds->south_deg > widest_local_frame_deg;
  if (choice == FrameChoice::automatic && s.origin) choice = FrameChoice::enu;
  if (choice == FrameChoice::automatic)
    choice = plane ? FrameChoice::projected : is_wide ? FrameChoice::ecef : FrameChoice::enu;
  if (choice == FrameChoice::projected) {
    if (!plane)
      return fail(ErrorCode::invalid_input, "", "--frame projected",
                  "these files are not in one projected system; choose ecef or enu");
    return Frame::projected(*plane);
  }
  if (!bounds)
    return fail(ErrorCode::invalid_input, "", choice == FrameChoice::ecef ? "--frame ecef" : "--frame enu",
                "these files do not say where on the Earth they lie; name their system with --crs EPSG:n");
  if (choice == FrameChoice::ecef) return Frame::ecef();
  const LatLon at = s.origin.value_or(middle_of(*bounds));
  return Frame::enu({at.lat_deg, at.lon_deg, 0});
}

Result<MosaicOptions> options_of(const TerrainSettings& s, const Geoid* geoid,
                                 const std::filesystem::path& temp) {
  MosaicOptions o;
  o.priority = s.priority;
  o.sea_level_m = s.sea_level_m;
  o.fill_postings = s.fill_postings;
  o.geoid = geoid;
  if (geoid) o.heights = VerticalDatum::ellipsoidal;
  o.raster.temp = temp;
  o.raster.no_data = s.no_data;
  o.raster.zoom = s.zoom;
  if (!s.variable.empty()) o.raster.variable = s.variable;
  if (s.heights != VerticalDatum::unknown) o.raster.vertical_datum = s.heights;
  if (!s.crs.empty()) {
    // Refused by name before any file is opened.
    const auto code = Crs::code_of_name(s.crs);
    if (!code) return fail(code.error());
    if (auto crs = Crs::from_epsg(*code); !crs) return fail(crs.error());
    o.raster.epsg = static_cast<std::uint32_t>(*code);
  }
  return o;
}

}  // namespace

bool is_raster(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return true;
  const std::string extension = lower_extension(name_inside(path.filename()));
  return std::find(raster_names.begin(), raster_names.end(), extension) != raster_names.end();
}

std::vector<std::filesystem::path> files_of_raster(const std::filesystem::path& path) {
  std::error_code failed;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(path, failed)) {
    for (std::filesystem::recursive_directory_iterator at(path, failed), end; !failed && at != end;
         at.increment(failed))
      if (at->is_regular_file(failed)) files.push_back(at->path());
  } else {
    files.push_back(path);
    for (const auto& sidecar : sidecars_of(path))
      if (sidecar != path && std::filesystem::is_regular_file(sidecar, failed)) files.push_back(sidecar);
  }
  std::sort(files.begin(), files.end());
  files.erase(std::unique(files.begin(), files.end()), files.end());
  return files;
}

Result<TerrainInput> open_terrain(std::span<const std::filesystem::path> paths, const TerrainSettings& s,
                                  const std::filesystem::path& temp) {
  TerrainInput in;
  if (!s.geoid.empty()) {
    auto geoid = Geoid::open(s.geoid);
    if (!geoid) return fail(geoid.error());
    in.geoid = std::make_unique<Geoid>(std::move(*geoid));
    in.facts.geoid = in.geoid->name();
  }
  const auto options = options_of(s, in.geoid.get(), temp);
  if (!options) return fail(options.error());
  auto mosaic = Mosaic::open(paths, *options);
  if (!mosaic) return fail(mosaic.error());
  in.mosaic = std::make_unique<Mosaic>(std::move(*mosaic));
  in.warnings = in.mosaic->warnings();
  for (const MosaicLayer& layer : in.mosaic->layers())
    if (looks_like_degrees(layer))
      in.warnings.push_back(paths[layer.files.front()].filename().string() +
                            ": names no system and is taken as a plane in metres, but its coordinates look "
                            "like degrees; if so, give --crs EPSG:4326");
  in.facts.heights = in.mosaic->heights();
  in.facts.bounds = bounds_of(*in.mosaic);
  auto frame = frame_of(*in.mosaic, in.facts.bounds, s);
  if (!frame) return fail(frame.error());
  in.facts.frame = std::move(*frame);
  if (in.geoid && in.facts.bounds) in.facts.sea_level_m = in.geoid->undulation_m(middle_of(*in.facts.bounds));
  if (!s.drape.empty()) {
    auto drape = ImageDrape::open(s.drape, {.bounds = s.drape_bounds, .temp = temp});
    if (!drape) return fail(drape.error());
    in.drape = std::make_unique<ImageDrape>(std::move(*drape));
  }
  for (const MosaicLayer& layer : in.mosaic->layers())
    for (const std::uint32_t f : layer.files) {
      const RasterInfo& info = in.mosaic->infos()[f];
      in.facts.files.push_back({paths[f].filename().string(), info.format, layer.crs.description(),
                                info.vertical_datum, info.vertical_name, info.width * info.height});
    }
  return in;
}

void note_survey(const TerrainSurface& surface, const Mosaic& mosaic, TerrainFacts& facts) {
  const TerrainFigures& figures = surface.figures();
  facts.least_m = figures.least_m;
  facts.most_m = figures.most_m;
  facts.spacing_m = figures.spacing_m;
  facts.postings = figures.postings.heights;
  facts.filled = figures.postings.filled;
  facts.raised = figures.postings.raised + figures.postings.flooded;
  facts.no_data = mosaic.postings() - figures.postings.heights - figures.postings.covered;
}

}  // namespace cuesta::app
