#pragma once
/// Small mosaics of random heights in all frames, surveyed; and where their postings are by another way.

#include "ooc/work_folder.h"
#include "terrain/terrain_surface.h"
#include "tests/terrain/mosaic_files.h"

namespace cuesta::test {

/// Files by name, and the frame that their surface is in.
struct SmallTerrain {
  std::string name;
  std::vector<std::pair<std::string, std::string>> files;
  Frame frame = Frame::ecef();
  MosaicOptions options = {};
};

inline std::vector<double> random_heights(std::mt19937& random, std::uint64_t count, double voids,
                                          double most_m = 900) {
  std::vector<double> out(count);
  std::uniform_real_distribution<double> share(0, 1);
  for (double& h : out) {
    h = std::round(share(random) * most_m * 8) / 8;
    if (share(random) < voids) h = none;
  }
  return out;
}

inline Frame frame_at(double lat_deg, double lon_deg) {
  return Frame::enu({lat_deg, lon_deg, 300}).value();
}

/// One or several layers with voids, on planes and on the globe, across the antimeridian, around the poles.
inline std::vector<SmallTerrain> small_terrains(unsigned seed, double voids) {
  std::mt19937 random(seed);
  const auto field = [&](double x, double y, double spacing, std::uint64_t width, std::uint64_t height) {
    return grid(x, y, spacing, width, random_heights(random, width * height, voids));
  };
  const Frame globe = Frame::ecef();
  const Frame plane = Frame::projected(Crs::plane()).value();
  const Frame utm = Frame::projected(Crs::from_epsg(32633).value()).value();
  std::vector<SmallTerrain> all;
  all.push_back({"plane", {{"a.asc", field(1000, 5000, 30, 23, 19)}}, plane, {}});
  all.push_back({"tiles on a plane",
                 {{"a.asc", field(0, 100, 5, 11, 11)},
                  {"b.asc", field(50, 100, 5, 11, 11)},
                  {"c.asc", field(20, 45, 5, 9, 5)}},
                 plane,
                 {}});
  all.push_back({"layers on a plane",
                 {{"a.asc", field(0, 60, 3, 21, 21)},
                  {"b.asc", field(20.2, 40.3, 1, 16, 16)},
                  {"c.asc", field(30.1, 33.2, 0.4, 20, 16)}},
                 plane,
                 {}});
  for (const Frame& frame : {globe, frame_at(46, 8), utm})
    all.push_back({"a tile " + frame.description(),
                   {{"a.asc", field(7.9, 46.1, 0.01, 21, 19)}, {"b.asc", field(8.1, 46.05, 0.01, 9, 14)}},
                   frame,
                   degrees()});
  for (const Frame& frame : {globe, frame_at(20, 180)})
    all.push_back({"layers across the antimeridian " + frame.description(),
                   {{"a.asc", field(176, 24, 0.5, 17, 17)}, {"b.asc", field(179.11, 21.13, 0.15, 15, 15)}},
                   frame,
                   degrees()});
  all.push_back({"the Earth", {{"a.asc", field(-180, 90, 7.5, 48, 25)}}, globe, degrees()});
  all.push_back({"the Earth from 0 with a fine tile",
                 {{"a.asc", field(0, 90, 10, 36, 19)}, {"b.asc", field(171.3, 20.4, 2, 14, 12)}},
                 globe,
                 degrees()});
  all.push_back({"most of a belt", {{"a.asc", field(-180, 25, 5, 67, 11)}}, globe, degrees()});
  all.push_back({"north", {{"a.asc", field(-180, 90, 5, 72, 6)}}, globe, degrees()});
  all.push_back({"south", {{"a.asc", field(-175, -75, 5, 72, 4)}}, frame_at(-90, 0), degrees()});
  SmallTerrain projected{"UTM on the globe", {{"a.asc", field(500000, 4983000, 30, 31, 25)}}, globe, {}};
  projected.options.raster.epsg = 32633;
  all.push_back(projected);
  SmallTerrain polar{"a plane around the pole", {{"a.asc", field(-90000, 95000, 9000, 21, 23)}}, globe, {}};
  polar.options.raster.epsg = 3413;
  all.push_back(polar);
  SmallTerrain mercator{"Web Mercator", {{"a.asc", field(-2e7, 1.5e7, 1e6, 40, 31)}}, globe, {}};
  mercator.options.raster.epsg = 3857;
  all.push_back(mercator);
  return all;
}

inline bool is_place(Vec3d p) {
  return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

/// A new folder, in memory where there is such a file system: journals wait for disks.
inline std::filesystem::path memory_path() {
  static int count = 0;
  const std::filesystem::path memory = "/dev/shm";
  const auto parent = std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  const auto path = parent / fmt::format("cuesta-test-{}-{}", ::getpid(), count++);
  std::filesystem::create_directories(path);
  return path;
}

/// A terrain that lies in files of its own, surveyed with any options.
class Surveyed {
 public:
  explicit Surveyed(const SmallTerrain& terrain) : work_(memory_path()), frame_(terrain.frame) {
    Paths paths;
    for (const auto& [name, text] : terrain.files) paths.push_back(files_.write(name, text));
    mosaic_ = open_mosaic(paths, terrain.options);
  }

  ~Surveyed() { std::filesystem::remove_all(work_); }
  Surveyed(const Surveyed&) = delete;
  Surveyed& operator=(const Surveyed&) = delete;

  const Mosaic& mosaic() const { return *mosaic_; }
  const Frame& frame() const { return frame_; }

  /// Lives as long as this. The work folder is a new one each time. Null, and a failure, where it cannot be
  /// surveyed.
  std::unique_ptr<TerrainSurface> survey(const TerrainOptions& options = {}) {
    if (!mosaic_) return nullptr;
    auto& folder = folders_.emplace_back(WorkFolder::open(work_ / std::to_string(folders_.size()), "test"));
    if (!folder) {
      ADD_FAILURE() << folder.error().text();
      return nullptr;
    }
    MemoryBudget memory(std::uint64_t{1} << 30);
    auto surface = TerrainSurface::survey(*mosaic_, frame_, options, *folder, memory);
    if (surface) return std::move(*surface);
    ADD_FAILURE() << surface.error().text();
    return nullptr;
  }

  /// Of a layer, row by row, in metres; NaN where there is no height.
  std::vector<Vec3d> positions_m(std::uint32_t l) const {
    const MosaicLayer& layer = mosaic_->layers()[l];
    const std::vector<double> heights = whole_mosaic(*mosaic_, l);
    std::vector<Vec3d> out;
    for (std::uint64_t i = 0; i < heights.size(); ++i) {
      const auto column = double(i % layer.width), row = double(i / layer.width);
      const PlanePoint p{layer.map.x(column, row), layer.map.y(column, row)};
      out.push_back(frame_.position_m(layer.crs, p, double(static_cast<float>(heights[i]))));
    }
    return out;
  }

 private:
  ScratchFolder files_;
  std::filesystem::path work_;
  Frame frame_;
  std::optional<Mosaic> mosaic_;
  std::vector<Result<WorkFolder>> folders_;
};

}  // namespace cuesta::test
