#include "terrain/mosaic_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "ooc/read_job.h"
#include "terrain/crs_geokeys.h"

namespace cuesta {
namespace {

constexpr double metres_per_degree = 111'320;
constexpr double most_steps = 0x1p50;      // between postings of one lattice
constexpr double most_degrees_east = 720;  // of a file's longitudes, also west

/// A turned raster; its posting (0, 0) in steps from the lattice's reference posting.
struct Piece {
  std::uint32_t file = 0;
  std::int64_t column = 0, row = 0;
  RasterTurn turn = {};
};

/// Being put together. Its reference posting is the first of the file that began it.
struct Lattice {
  Crs crs;
  PostingMap map = {};
  std::uint64_t columns_around = 0;
  std::vector<Piece> pieces = {};
};

bool is_whole(double steps) {
  return std::abs(steps) < most_steps && std::abs(steps - std::round(steps)) <= lattice_phase_tolerance;
}

/// Steps along a lattice's columns and rows that make (dx, dy).
PlanePoint steps_of(const PostingMap& m, double dx, double dy) {
  const double area = m.x_per_column * m.y_per_row - m.x_per_row * m.y_per_column;
  return {(dx * m.y_per_row - dy * m.x_per_row) / area, (dy * m.x_per_column - dx * m.y_per_column) / area};
}

bool near(double ax, double ay, double bx, double by) {
  return std::hypot(ax - bx, ay - by) <= lattice_spacing_tolerance * std::hypot(bx, by);
}

/// Where a turned raster lies in a lattice, if its postings are postings of the lattice.
std::optional<Piece> piece_of(const Lattice& lattice, const Crs& crs, const PostingMap& m,
                              const RasterTurn& turn) {
  const PostingMap& l = lattice.map;
  if (!same_coordinates(lattice.crs.definition(), crs.definition()) ||
      !near(m.x_per_column, m.y_per_column, l.x_per_column, l.y_per_column) ||
      !near(m.x_per_row, m.y_per_row, l.x_per_row, l.y_per_row))
    return std::nullopt;
  const double around = full_turn(crs);
  const double turns = crs.geographic() ? std::round((m.x0 - l.x0) / around) : 0;
  const auto steps = [&](double column, double row) {
    return steps_of(l, m.x(column, row) - turns * around - l.x0, m.y(column, row) - l.y0);
  };
  const PlanePoint first = steps(0, 0), last = steps(double(turn.width - 1), double(turn.height - 1));
  if (!is_whole(first.x) || !is_whole(first.y) || !is_whole(last.x) || !is_whole(last.y)) return std::nullopt;
  return Piece{.column = std::llround(first.x), .row = std::llround(first.y), .turn = turn};
}

/// A lattice that the raster is the first of. Steps of longitude that are a whole part of 360° but for
/// rounding become exactly that: no posting of the raster moves by more than the tolerance.
Lattice lattice_of(const Crs& crs, PostingMap m, const RasterTurn& turn) {
  Lattice lattice{.crs = crs};
  if (crs.geographic() && m.is_axis_aligned()) {
    const double around = full_turn(crs), count = std::round(around / m.x_per_column);
    const double exact = around / count, off = std::abs(exact / m.x_per_column - 1);
    if (count >= 3 && count < most_steps && off <= lattice_spacing_tolerance &&
        off * double(turn.width) <= 0.5 * lattice_phase_tolerance) {
      m.x_per_column = exact;
      lattice.columns_around = static_cast<std::uint64_t>(count);
    }
  }
  lattice.map = m;
  return lattice;
}

Result<void> check_degrees(const RasterInfo& info, const Crs& crs, const PostingMap& m,
                           const RasterTurn& turn) {
  if (!crs.geographic()) return {};
  const double unit = crs.definition().unit, last_column = double(turn.width - 1),
               last_row = double(turn.height - 1);
  const double slack_deg = 2 * lattice_phase_tolerance * std::abs(m.y_per_row) * unit;
  for (const auto& [column, row] :
       {std::pair{0., 0.}, {last_column, 0.}, {0., last_row}, {last_column, last_row}}) {
    const double longitude = m.x(column, row) * unit, latitude = m.y(column, row) * unit;
    if (std::abs(latitude) <= 90 + slack_deg && std::abs(longitude) <= most_degrees_east) continue;
    return fail(
        ErrorCode::invalid_input, info.files.front(), "georeference",
        fmt::format("expected degrees of latitude and longitude, found {} and {}; is it in another system? "
                    "Name that with --crs EPSG:n",
                    latitude, longitude));
  }
  return {};
}

struct Range {
  std::int64_t first = 0;
  std::uint64_t count = 0;
};

/// The columns of all pieces, of a lattice without a whole number of columns around the Earth.
Range straight_range(const Lattice& lattice) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(),
               end = std::numeric_limits<std::int64_t>::min();
  for (const Piece& piece : lattice.pieces) {
    first = std::min(first, piece.column);
    end = std::max(end, piece.column + static_cast<std::int64_t>(piece.turn.width));
  }
  return {first, static_cast<std::uint64_t>(end - first)};
}

std::uint64_t modulo(std::int64_t value, std::uint64_t n) {
  const auto count = static_cast<std::int64_t>(n);
  return static_cast<std::uint64_t>((value % count + count) % count);
}

/// The shortest arc that holds all pieces: it begins after the widest gap. Without a gap, at the westernmost
/// beginning of a piece, counted from -180°.
Range shortest_arc(const Lattice& lattice) {
  const double steps_to_west =
      (-180 / lattice.crs.definition().unit - lattice.map.x0) / lattice.map.x_per_column;
  const auto west = static_cast<std::int64_t>(std::ceil(steps_to_west - lattice_phase_tolerance));
  std::vector<std::pair<std::int64_t, std::int64_t>> arcs;  // begin, end; begin < around
  for (const Piece& piece : lattice.pieces) {
    const auto begin = static_cast<std::int64_t>(modulo(piece.column - west, lattice.columns_around));
    arcs.emplace_back(begin, begin + static_cast<std::int64_t>(piece.turn.width));
  }
  std::ranges::sort(arcs);
  const auto around = static_cast<std::int64_t>(lattice.columns_around);
  std::int64_t reached =
      std::ranges::max(arcs, {}, [](const auto& arc) { return arc.second; }).second - around;
  std::int64_t first = arcs.front().first, widest = 0;
  for (const auto& [begin, end] : arcs) {
    if (begin - reached > widest) {
      widest = begin - reached;
      first = begin;
    }
    reached = std::max(reached, end);
  }
  return {west + first, static_cast<std::uint64_t>(around - widest)};
}

Range rows_of(const Lattice& lattice) {
  std::int64_t first = std::numeric_limits<std::int64_t>::max(),
               end = std::numeric_limits<std::int64_t>::min();
  for (const Piece& piece : lattice.pieces) {
    first = std::min(first, piece.row);
    end = std::max(end, piece.row + static_cast<std::int64_t>(piece.turn.height));
  }
  return {first, static_cast<std::uint64_t>(end - first)};
}

/// Sets whether the ends are poles; if so, exactly.
void find_poles(MosaicLayer& layer) {
  if (!layer.crs.geographic() || !layer.map.is_axis_aligned()) return;
  PostingMap& m = layer.map;
  const double pole = 90 / layer.crs.definition().unit, last_row = double(layer.height - 1);
  const double slack = 2 * lattice_phase_tolerance * std::abs(m.y_per_row);
  layer.north_pole = std::abs(m.y0 - pole) <= slack;
  layer.south_pole = std::abs(m.y(0, last_row) + pole) <= slack;
  if (layer.north_pole) m.y0 = pole;
  if (layer.south_pole && layer.height > 1) m.y_per_row = (-pole - m.y0) / last_row;
}

Result<MosaicLayer> finished(const Lattice& lattice, std::span<const RasterInfo> infos,
                             std::vector<FilePlace>& places) {
  const Range columns = lattice.columns_around != 0 ? shortest_arc(lattice) : straight_range(lattice);
  const Range rows = rows_of(lattice);
  MosaicLayer layer{.crs = lattice.crs,
                    .map = lattice.map,
                    .width = columns.count,
                    .height = rows.count,
                    .columns_around = lattice.columns_around};
  if (double(layer.width) * double(layer.height) > 0x1p62)
    return fail(ErrorCode::invalid_input, infos[lattice.pieces.front().file].files.front(), "",
                fmt::format("the files of its lattice are too far apart: {} × {} postings", layer.width,
                            layer.height));
  layer.map.x0 = lattice.map.x(double(columns.first), double(rows.first));
  layer.map.y0 = lattice.map.y(double(columns.first), double(rows.first));
  for (const Piece& piece : lattice.pieces) {
    FilePlace& place = places[piece.file];
    const std::int64_t column = piece.column - columns.first;
    place.column =
        layer.columns_around != 0 ? modulo(column, layer.columns_around) : static_cast<std::uint64_t>(column);
    place.row = static_cast<std::uint64_t>(piece.row - rows.first);
    place.turn = piece.turn;
    layer.files.push_back(piece.file);
    // A file's own numbers where there are some: steps from a far one would round them.
    const PostingMap own = piece.turn.map(infos[piece.file].map);
    if (place.column == 0) layer.map.x0 = own.is_axis_aligned() ? own.x0 : layer.map.x0;
    if (place.row == 0) layer.map.y0 = own.is_axis_aligned() ? own.y0 : layer.map.y0;
  }
  if (layer.crs.geographic()) {
    const double around = full_turn(layer.crs), slack = lattice_phase_tolerance * layer.map.x_per_column;
    layer.map.x0 -= around * std::floor((layer.map.x0 + slack) / around + 0.5);
  }
  find_poles(layer);
  return layer;
}

}  // namespace

double row_spacing_m(const MosaicLayer& layer) {
  const double unit_m = layer.crs.definition().unit * (layer.crs.geographic() ? metres_per_degree : 1);
  return std::hypot(layer.map.x_per_row, layer.map.y_per_row) * unit_m;
}

Result<std::vector<Crs>> systems_of(std::span<const RasterInfo> infos) {
  const auto says = [](const RasterInfo& info) { return info.crs.kind != CrsDescription::Kind::unknown; };
  const auto silent = std::ranges::find_if_not(infos, says), known = std::ranges::find_if(infos, says);
  if (silent != infos.end() && known != infos.end())
    return fail(
        ErrorCode::invalid_input, silent->files.front(), "reference system",
        fmt::format("the file does not say its reference system, while {} does; name it with --crs EPSG:n",
                    known->files.front()));
  std::vector<Crs> systems;
  for (const RasterInfo& info : infos) {
    if (!says(info)) {
      systems.push_back(Crs::plane());
      continue;
    }
    auto crs = crs_of(info.crs);
    if (!crs) {
      Error error = std::move(crs).error();
      error.file = info.files.front();
      return fail(std::move(error));
    }
    if (!info.is_placed)
      return fail(
          ErrorCode::invalid_input, info.files.front(), "georeference",
          "the file does not say where it lies; give its placement in " + info.files.front() + ".json");
    systems.push_back(std::move(*crs));
  }
  return systems;
}

Result<MosaicLayers> group_into_layers(std::span<const RasterInfo> infos, std::span<const Crs> systems,
                                       MosaicPriority priority) {
  std::vector<Lattice> lattices;
  for (std::uint32_t file = 0; file < infos.size(); ++file) {
    const RasterTurn turn = RasterTurn::of(infos[file]);
    const PostingMap map = turn.map(infos[file].map);
    CUESTA_TRY(check_degrees(infos[file], systems[file], map, turn));
    std::optional<Piece> piece;
    std::size_t i = 0;
    for (; i < lattices.size() && !piece; ++i) piece = piece_of(lattices[i], systems[file], map, turn);
    if (!piece) {
      lattices.push_back(lattice_of(systems[file], map, turn));
      piece = Piece{.turn = turn};
      i = lattices.size();
    }
    piece->file = file;
    lattices[i - 1].pieces.push_back(*piece);
  }
  MosaicLayers out{.layers = {}, .places = std::vector<FilePlace>(infos.size())};
  for (const Lattice& lattice : lattices) {
    auto layer = finished(lattice, infos, out.places);
    if (!layer) return fail(std::move(layer).error());
    out.layers.push_back(std::move(*layer));
  }
  if (priority == MosaicPriority::finest_first) {
    // In steps of 0.02 %, so that rounding does not decide what the order given should.
    std::ranges::stable_sort(out.layers, {}, [](const MosaicLayer& layer) {
      return std::llround(std::log2(row_spacing_m(layer)) * 4096);
    });
  }
  for (std::uint32_t layer = 0; layer < out.layers.size(); ++layer) {
    for (const std::uint32_t file : out.layers[layer].files) out.places[file].layer = layer;
  }
  return out;
}

}  // namespace cuesta
