#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ooc/byte_arrays.h"
#include "ooc/ordered_tasks.h"
#include "terrain/terrain_chunk.h"
#include "terrain/terrain_surface.h"

namespace cuesta {
namespace {

constexpr const char* store_name = "postings";
/// Widest surface in grid steps, a little less than a build takes (2^24).
constexpr double most_steps = 15'700'000;
/// The grid's origin is a multiple of so many steps, so that a surface that grows a little keeps its grid.
constexpr double steps_of_origin = 1 << 20;
constexpr double steps_per_spacing = 256;
/// With fewer, triangles between neighbouring postings are hardly wider than what snapping makes of a line,
/// and are not simplified (SubstitutionKernel); with two, none of a mountain was.
constexpr double least_steps_per_spacing = 8;
constexpr double largest_step_m = 0.5;

/// A square's heights, and what was found there. Written to the journal as it is.
struct SquareFacts {
  std::uint8_t has_heights = 0;
  MosaicCounts counts;
  float least_m = std::numeric_limits<float>::infinity(), most_m = -std::numeric_limits<float>::infinity();
};
struct SquareHeights {
  SquareFacts facts;
  std::vector<float> heights_m;
};

}  // namespace

class TerrainSurvey {
 public:
  TerrainSurvey(const Mosaic& mosaic, const Frame& frame, const TerrainOptions& options, WorkFolder& folder,
                MemoryBudget& memory, const BuildProgress& progress)
      : mosaic_(mosaic),
        frame_(frame),
        options_(options),
        folder_(folder),
        memory_(memory),
        progress_(progress),
        squares_(mosaic.layers(), options.square_side) {}

  Result<std::unique_ptr<TerrainSurface>> run() {
    if (squares_.count() >= 0xFFFFFF)
      return fail(ErrorCode::invalid_input, "", "",
                  "the mosaic is too wide for its spacing: more squares than a build can have");
    if (auto r = folder_.check_room(postings_in_files() * sizeof(float), "the heights"); !r)
      return fail(r.error());
    if (auto r = read_heights(); !r) return fail(r.error());
    if (auto r = add_corner_squares(); !r) return fail(r.error());
    auto surface =
        std::unique_ptr<TerrainSurface>(new TerrainSurface(mosaic_, frame_, options_, std::move(*store_)));
    if (auto r = surface->find_pole_fans(); !r) return fail(r.error());
    if (auto r = surface->find_seam_fans(); !r) return fail(r.error());
    surface->figures_ = figures_;
    surface->vertical = frame_.vertical_m();
    surface->attributes.normals = options_.make_normals;
    surface->attributes.colours = options_.drape != nullptr;
    if (auto r = look_at_chunks(*surface); !r) return fail(r.error());
    return surface;
  }

 private:
  /// At most so many have heights: between far files there are none.
  std::uint64_t postings_in_files() const {
    std::uint64_t sum = 0;
    for (const RasterInfo& info : mosaic_.infos()) sum += info.width * info.height;
    return std::min(sum, mosaic_.postings());
  }

  Result<SquareHeights> read_square(std::uint64_t number) const {
    const LatticeSquare s = squares_.square(number);
    SquareHeights out;
    if (!mosaic_.has_files(s.layer, {s.column, s.row, s.width, s.height})) return out;
    std::vector<double> heights(std::size_t{s.width} * s.height);
    if (auto r = mosaic_.read(s.layer, {s.column, s.row, s.width, s.height}, heights, &out.facts.counts); !r)
      return fail(r.error());
    out.heights_m.resize(heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const float h = out.heights_m[i] = static_cast<float>(heights[i]);
      if (!std::isfinite(h)) continue;
      out.facts.has_heights = 1;
      out.facts.least_m = std::min(out.facts.least_m, h);
      out.facts.most_m = std::max(out.facts.most_m, h);
    }
    return out;
  }

  /// Adds a square that is in the store, now or from an earlier run.
  void adopt(std::uint64_t number, const SquareFacts& facts) {
    figures_.postings += facts.counts;
    done_ += std::uint64_t{squares_.square(number).width} * squares_.square(number).height;
    if (!facts.has_heights) return;
    store_->add(number);
    figures_.least_m = std::min(figures_.least_m, static_cast<double>(facts.least_m));
    figures_.most_m = std::max(figures_.most_m, static_cast<double>(facts.most_m));
  }

  Result<void> read_heights() {
    const auto finished = folder_.journal().count("heights");
    if (!finished) return fail(finished.error());
    const auto path = folder_.path() / store_name;
    auto file = *finished > 0 ? FileHandle::open(path) : FileHandle::create(path);
    if (!file) return fail(file.error());
    store_.emplace(squares_, std::move(*file));
    for (std::uint64_t n = 0; n < *finished; ++n) {
      auto bytes = folder_.journal().find("heights", n);
      if (!bytes) return fail(bytes.error());
      if (!*bytes || (*bytes)->size() != sizeof(SquareFacts)) return damaged_journal();
      ByteReader r(**bytes);
      adopt(n, r.get<SquareFacts>());
    }
    const std::uint64_t postings = std::uint64_t{options_.square_side} * options_.square_side;
    auto reserved = memory_.reserve_some(postings * 24, arena_threads() + 1, "reading heights");
    if (!reserved) return fail(reserved.error());
    return run_in_order<SquareHeights>(
        *finished, squares_.count(), reserved->second, [&](std::uint64_t n) { return read_square(n); },
        [&](std::uint64_t n, SquareHeights square) -> Result<void> {
          adopt(n, square.facts);
          if (square.facts.has_heights)
            if (auto r = store_->write(store_->chunk_count() - 1, square.heights_m); !r) return r;
          ByteWriter w;
          w.put(square.facts);
          if (auto r = folder_.journal().record("heights", n, w.bytes()); !r) return r;
          return report("read");
        });
  }

  /// A square without heights makes a triangle if the three squares beyond its last corner meet there.
  Result<void> add_corner_squares() {
    const std::vector<float> none(std::size_t{options_.square_side} * options_.square_side,
                                  std::numeric_limits<float>::quiet_NaN());
    for (std::uint64_t n = 0; n < squares_.count(); ++n) {
      if (store_->chunk_of(n) != no_chunk) continue;
      const LatticeSquare s = squares_.square(n);
      std::array<float, 4> corner;
      if (auto r = store_->read(s.layer, static_cast<std::int64_t>(s.column + s.width - 1),
                                static_cast<std::int64_t>(s.row + s.height - 1), 2, 2, corner);
          !r)
        return r;
      if (!(std::isfinite(corner[1]) && std::isfinite(corner[2]) && std::isfinite(corner[3]))) continue;
      if (auto r = store_->write(store_->add(n), std::span(none).first(std::size_t{s.width} * s.height)); !r)
        return r;
    }
    return {};
  }

  Result<void> report(std::string_view stage) const {
    if (progress_ && !progress_(stage, done_, mosaic_.postings()))
      return fail(ErrorCode::cancelled, "", "", "stopped; the same command goes on from here");
    return {};
  }

  /// Counts triangles and vertices, and finds the box and with it the grid.
  Result<void> look_at_chunks(TerrainSurface& surface) const {
    Box3d box;
    const auto look = [&](std::uint64_t c) {
      return TerrainChunk(surface, static_cast<std::uint32_t>(c)).facts();
    };
    const auto keep = [&](std::uint64_t, TerrainChunk::Facts facts) -> Result<void> {
      surface.chunk_triangles_.push_back(facts.triangles);
      surface.triangles += facts.triangles;
      surface.vertices += facts.vertices;
      if (!facts.box_m.empty()) box.add(facts.box_m);
      return {};
    };
    const std::uint64_t postings = std::uint64_t{options_.square_side} * options_.square_side;
    auto reserved =
        memory_.reserve_some(postings * 80, arena_threads() + 1, "looking at a square of heights");
    if (!reserved) return fail(reserved.error());
    if (auto r = run_in_order<TerrainChunk::Facts>(0, surface.chunk_count(), reserved->second, look, keep);
        !r)
      return r;
    if (surface.triangles == 0)
      return fail(ErrorCode::invalid_input, "", "",
                  "no triangle can be made: no three neighbouring postings have heights");
    surface.figures_.spacing_m = spacing_m(surface);
    auto grid = grid_of(box, surface);
    if (!grid) return fail(grid.error());
    surface.grid = *grid;
    surface.box.add(grid->snap(box.lo));
    surface.box.add(grid->snap(box.hi));
    Vertical& v = *surface.vertical;
    if (!v.is_plane) v.centre = (v.centre - grid->origin) / grid->step;
    return {};
  }

  Result<Grid> grid_of(const Box3d& box, const TerrainSurface& surface) const {
    const Vec3d size = box.hi - box.lo;
    const double extent = std::max({size.x, size.y, size.z});
    const auto step =
        options_.step_m > 0 ? given_step(extent, surface.figures_.spacing_m) : natural_step(extent, surface);
    if (!step) return fail(step.error());
    const double unit = *step * steps_of_origin;
    const auto down = [unit](double x) { return std::floor(x / unit) * unit; };
    return Grid{{down(box.lo.x), down(box.lo.y), down(box.lo.z)}, *step};
  }

  Result<double> given_step(double extent, double spacing) const {
    const double step = options_.step_m;
    if (extent / step > most_steps)
      return fail(ErrorCode::invalid_input, "", "",
                  fmt::format("a grid step of {} m is too small for {} km; give at least {:.3g} m", step,
                              extent / 1000, extent / most_steps));
    if (step * least_steps_per_spacing > spacing)
      return fail(
          ErrorCode::invalid_input, "", "",
          fmt::format("a grid step of {} m is too coarse for postings {:.3g} m apart; give at most {:.3g} m",
                      step, spacing, spacing / least_steps_per_spacing));
    return step;
  }

  /// What suits the heights and the postings, as coarse as the extent needs it.
  Result<double> natural_step(double extent, const TerrainSurface& surface) const {
    double step = finest_step(surface);
    while (extent / step > most_steps) step *= 2;
    const double spacing = surface.figures_.spacing_m;
    if (step * least_steps_per_spacing / 2 > spacing)
      return fail(
          ErrorCode::invalid_input, "", "",
          fmt::format("postings {:.3g} m apart are too near to each other for an extent of {:.3g} m, heights "
                      "included; if they are in degrees, give --crs",
                      spacing, extent));
    return step;
  }

  /// Metres between neighbouring postings along a column, the least of all layers, in their middles.
  double spacing_m(const TerrainSurface& surface) const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t l = 0; l < mosaic_.layers().size(); ++l) {
      const MosaicLayer& layer = mosaic_.layers()[l];
      const auto column = static_cast<std::int64_t>(layer.width / 2),
                 row = static_cast<std::int64_t>(layer.height / 2);
      const std::array<float, 2> heights{};
      std::array<Vec3d, 2> at;
      surface.positions_[l].of(column, row, 1, 2, heights, at);
      const double apart = length(at[1] - at[0]);
      if (apart > 0) least = std::min(least, apart);
    }
    return std::isfinite(least) ? least : 1;
  }

  /// Whether all postings of a plane lie on whole steps, give or take what heights may be off.
  bool is_on_steps(double step, const TerrainSurface& surface) const {
    const auto whole = [step](double metres) {
      return std::abs(metres / step - std::round(metres / step)) < 1e-6;
    };
    return std::all_of(surface.positions_.begin(), surface.positions_.end(),
                       [](const PostingPositions& p) { return p.is_straight(); }) &&
           std::all_of(mosaic_.layers().begin(), mosaic_.layers().end(), [&](const MosaicLayer& l) {
             const double unit = l.crs.definition().unit;
             return whole(l.map.x_per_column * unit) && whole(l.map.y_per_row * unit) &&
                    whole(l.map.x_per_row * unit) && whole(l.map.y_per_column * unit);
           });
  }

  double finest_step(const TerrainSurface& surface) const {
    const double quantum = mosaic_.vertical_quantum_m(), spacing = surface.figures().spacing_m;
    if (quantum > 0 && quantum <= spacing) {
      double step = is_on_steps(quantum, surface) ? quantum : quantum / 2;
      while (step * least_steps_per_spacing > spacing) step /= 2;
      return step;
    }
    return std::exp2(std::floor(std::log2(std::min(spacing / steps_per_spacing, largest_step_m))));
  }

  const Mosaic& mosaic_;
  Frame frame_;
  TerrainOptions options_;
  WorkFolder& folder_;
  MemoryBudget& memory_;
  const BuildProgress& progress_;
  LatticeSquares squares_;
  std::optional<PostingStore> store_;
  TerrainFigures figures_{.postings = {},
                          .least_m = std::numeric_limits<double>::infinity(),
                          .most_m = -std::numeric_limits<double>::infinity()};
  std::uint64_t done_ = 0;
};

Result<std::unique_ptr<TerrainSurface>> TerrainSurface::survey(const Mosaic& mosaic, const Frame& frame,
                                                               const TerrainOptions& options,
                                                               WorkFolder& folder, MemoryBudget& memory,
                                                               const BuildProgress& progress) {
  return TerrainSurvey(mosaic, frame, options, folder, memory, progress).run();
}

}  // namespace cuesta
