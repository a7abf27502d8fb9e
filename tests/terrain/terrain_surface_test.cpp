/// All chunks of a terrain put together are the surface that mosaic.h describes, whatever the squares.

#include "terrain/terrain_surface.h"

#include <map>
#include <set>

#include "tests/ooc/check_grid_mesh.h"
#include "tests/terrain/small_terrains.h"

namespace cuesta {
namespace {

using test::GridMesh;
using test::is_place;
using test::SmallTerrain;
using test::Surveyed;
using Corners = std::array<Vec3i, 3>;

/// The same triangle for any first corner.
Corners turned(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

/// The triangles of a mosaic, with corners numbered posting by posting; those at a pole are one.
class ExpectedSurface {
 public:
  explicit ExpectedSurface(const Surveyed& terrain) : mosaic_(terrain.mosaic()) {
    for (std::uint32_t l = 0; l < mosaic_.layers().size(); ++l) {
      first_.push_back(std::uint32_t(positions_m_.size()));
      const auto positions = terrain.positions_m(l);
      positions_m_.insert(positions_m_.end(), positions.begin(), positions.end());
    }
    for (std::uint32_t l = 0; l < mosaic_.layers().size(); ++l) add_cells(l);
    for (const auto& [a, b, c] : mosaic_.seams()) add(number(a), number(b), number(c));
  }

  const std::vector<std::array<std::uint32_t, 3>>& triangles() const { return triangles_; }
  std::vector<Corners> snapped(const Grid& grid) const {
    std::vector<Corners> out;
    for (const auto& [a, b, c] : triangles_)
      out.push_back(
          turned({grid.snap(positions_m_[a]), grid.snap(positions_m_[b]), grid.snap(positions_m_[c])}));
    std::sort(out.begin(), out.end());
    return out;
  }
  /// Triangles around a posting that edges do not join are fans of their own.
  std::size_t vertices() const {
    std::map<std::uint32_t, std::vector<std::set<std::uint32_t>>> fans;
    for (const auto& t : triangles_)
      for (std::size_t k = 0; k < 3; ++k) {
        std::set<std::uint32_t> others{t[(k + 1) % 3], t[(k + 2) % 3]};
        auto& around = fans[t[k]];
        std::erase_if(around, [&](const std::set<std::uint32_t>& fan) {
          const bool joined =
              std::any_of(fan.begin(), fan.end(), [&](std::uint32_t v) { return others.contains(v); });
          if (joined) others.insert(fan.begin(), fan.end());
          return joined;
        });
        around.push_back(others);
      }
    std::size_t count = 0;
    for (const auto& [posting, around] : fans) count += around.size();
    return count;
  }

 private:
  std::uint32_t number(const PostingRef& p) const {
    const MosaicLayer& layer = mosaic_.layers()[p.layer];
    const bool pole = (layer.north_pole && p.row == 0) || (layer.south_pole && p.row + 1 == layer.height);
    return first_[p.layer] + std::uint32_t(p.row * layer.width + (pole ? 0 : p.column));
  }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a != b && b != c && c != a) triangles_.push_back({a, b, c});
  }
  void add_cells(std::uint32_t l) {
    const MosaicLayer& layer = mosaic_.layers()[l];
    for (std::uint64_t row = 0; row + 1 < layer.height; ++row)
      for (std::uint64_t column = 0; column + (layer.closes() ? 0 : 1) < layer.width; ++column) {
        const std::uint64_t east = (column + 1) % layer.width;
        const PostingRef nw{l, column, row}, ne{l, east, row}, sw{l, column, row + 1}, se{l, east, row + 1};
        std::vector<std::uint32_t> round;
        for (const PostingRef& p : {nw, sw, se, ne})
          if (is_place(positions_m_[first_[l] + p.row * layer.width + p.column])) round.push_back(number(p));
        if (round.size() == 3) add(round[0], round[1], round[2]);
        if (round.size() < 4) continue;
        add(number(nw), number(sw), number(ne));
        add(number(ne), number(sw), number(se));
      }
  }

  const Mosaic& mosaic_;
  std::vector<std::uint32_t> first_;
  std::vector<Vec3d> positions_m_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

/// "" or the first triangle in which two sorted lists differ.
std::string difference(const std::vector<Corners>& found, const std::vector<Corners>& expected) {
  const auto [f, e] = std::mismatch(found.begin(), found.end(), expected.begin(), expected.end());
  const auto text = [](auto at, auto end) {
    if (at == end) return std::string("none");
    std::string out;
    for (const Vec3i& p : *at) out += fmt::format("({}, {}, {}) ", p.x, p.y, p.z);
    return out;
  };
  if (f == found.end() && e == expected.end()) return "";
  return fmt::format("triangle {}: {}, expected {}", f - found.begin(), text(f, found.end()),
                     text(e, expected.end()));
}

std::vector<Corners> corners_of(const GridMesh& mesh) {
  std::vector<Corners> out;
  for (const auto& [a, b, c] : mesh.triangles)
    out.push_back(turned({mesh.positions[a], mesh.positions[b], mesh.positions[c]}));
  std::sort(out.begin(), out.end());
  return out;
}

TEST(TerrainSurface, chunks_together_are_the_surface_of_the_mosaic) {
  for (const double voids : {0.0, 0.04, 0.3})
    for (unsigned seed = 1; seed <= 4; ++seed)
      for (const SmallTerrain& terrain : test::small_terrains(seed, voids)) {
        SCOPED_TRACE(fmt::format("{}, seed {}, voids {}", terrain.name, seed, voids));
        Surveyed surveyed(terrain);
        const ExpectedSurface expected(surveyed);
        const auto surface = surveyed.survey({.square_side = 7 + seed});
        ASSERT_TRUE(surface);
        EXPECT_GT(surface->chunk_count(), 1u);
        const GridMesh mesh = test::put_together(*surface);
        EXPECT_EQ(test::find_violation(mesh), "");
        EXPECT_EQ(surface->triangles, expected.triangles().size());
        EXPECT_EQ(difference(corners_of(mesh), expected.snapped(surface->grid)), "");
        EXPECT_EQ(mesh.positions.size(), expected.vertices());
        EXPECT_EQ(surface->vertices, expected.vertices());
        if (HasFailure()) return;
      }
}

TEST(TerrainSurface, counts_and_box_are_those_of_the_chunks) {
  for (const SmallTerrain& terrain : test::small_terrains(5, 0.1)) {
    SCOPED_TRACE(terrain.name);
    Surveyed surveyed(terrain);
    const auto surface = surveyed.survey({.square_side = 9});
    ASSERT_TRUE(surface);
    std::uint64_t triangles = 0;
    Box3<std::int32_t> box;
    for (std::uint32_t c = 0; c < surface->chunk_count(); ++c) {
      const auto chunk = surface->chunk(c);
      ASSERT_TRUE(chunk);
      EXPECT_EQ(chunk->triangles.size(), surface->triangles_of(c));
      triangles += chunk->triangles.size();
      EXPECT_TRUE(std::is_sorted(chunk->ids.begin(), chunk->ids.end()));
      for (const Vec3i& p : chunk->vertices.positions) box.add(p);
      for (const VertexId id : chunk->ids) EXPECT_TRUE(id >> 32 != c || id < chunk->first_free) << id;
    }
    EXPECT_EQ(triangles, surface->triangles);
    EXPECT_EQ(box.lo, surface->box.lo);
    EXPECT_EQ(box.hi, surface->box.hi);
  }
}

/// A vertex that two chunks use is locked in both, and the same in both.
TEST(TerrainSurface, vertices_of_several_chunks_are_locked_and_agree) {
  for (const SmallTerrain& terrain : test::small_terrains(6, 0.1)) {
    SCOPED_TRACE(terrain.name);
    Surveyed surveyed(terrain);
    const auto surface = surveyed.survey({.square_side = 6});
    ASSERT_TRUE(surface);
    struct Use {
      std::uint32_t chunk = 0;
      Vec3i position;
      OctNormal normal{};
      bool locked = false;
    };
    std::map<VertexId, Use> known;
    std::size_t shared = 0;
    for (std::uint32_t c = 0; c < surface->chunk_count(); ++c) {
      const auto chunk = surface->chunk(c).value();
      for (std::size_t v = 0; v < chunk.ids.size(); ++v) {
        const Use use{c, chunk.vertices.positions[v], chunk.vertices.normals[v], chunk.locked[v] != 0};
        const auto [at, is_new] = known.try_emplace(chunk.ids[v], use);
        if (is_new) continue;
        ++shared;
        EXPECT_TRUE(use.locked && at->second.locked) << "chunks " << c << " and " << at->second.chunk;
        EXPECT_EQ(use.position, at->second.position);
        EXPECT_EQ(use.normal, at->second.normal) << "chunks " << c << " and " << at->second.chunk;
      }
    }
    EXPECT_GT(shared, 0u);
    if (HasFailure()) return;
  }
}

TEST(TerrainSurface, the_same_surface_for_any_squares) {
  for (const SmallTerrain& terrain : test::small_terrains(7, 0.1)) {
    SCOPED_TRACE(terrain.name);
    Surveyed surveyed(terrain);
    const auto whole = surveyed.survey();
    ASSERT_TRUE(whole);
    const auto expected = corners_of(test::put_together(*whole));
    for (const std::uint32_t side : {1u, 2u, 5u, 24u}) {
      const auto surface = surveyed.survey({.square_side = side});
      ASSERT_TRUE(surface);
      EXPECT_EQ(surface->grid.origin, whole->grid.origin);
      EXPECT_EQ(surface->grid.step, whole->grid.step);
      EXPECT_EQ(surface->vertices, whole->vertices);
      const GridMesh mesh = test::put_together(*surface);
      EXPECT_EQ(test::find_violation(mesh), "") << side;
      EXPECT_EQ(mesh.positions.size(), whole->vertices) << side;
      EXPECT_EQ(difference(corners_of(mesh), expected), "") << side;
    }
    if (HasFailure()) return;
  }
}

TEST(TerrainSurface, normals_point_up_and_are_those_of_a_slope) {
  std::vector<double> slope;
  for (int i = 0; i < 12 * 9; ++i) slope.push_back(10 * (i % 12) - 5 * (i / 12));
  const SmallTerrain terrain{
      "slope", {{"a.asc", test::grid(0, 80, 10, 12, slope)}}, Frame::projected(Crs::plane()).value(), {}};
  Surveyed surveyed(terrain);
  const auto surface = surveyed.survey();
  ASSERT_TRUE(surface);
  const GridMesh mesh = test::put_together(*surface);
  const Vec3f expected = vec_cast<float>(normalized(Vec3d{-1, -0.5, 1}));
  for (const Vec3f& n : mesh.normals) EXPECT_GT(dot(n, expected), 0.999f);
}

TEST(TerrainSurface, heights_in_figures) {
  std::vector<double> heights(40, 100);
  heights[7] = -3.5, heights[22] = 812.25, heights[30] = test::none;
  const SmallTerrain terrain{
      "heights", {{"a.asc", test::grid(0, 80, 10, 8, heights)}}, Frame::projected(Crs::plane()).value(), {}};
  Surveyed surveyed(terrain);
  const auto surface = surveyed.survey();
  ASSERT_TRUE(surface);
  EXPECT_EQ(surface->figures().least_m, -3.5);
  EXPECT_EQ(surface->figures().most_m, 812.25);
  EXPECT_EQ(surface->figures().spacing_m, 10);
  EXPECT_EQ(surface->figures().postings.heights, 39u);
}

Error survey_error(const SmallTerrain& terrain, const TerrainOptions& options) {
  test::ScratchFolder folder;
  test::Paths paths;
  for (const auto& [name, text] : terrain.files) paths.push_back(folder.write(name, text));
  const auto mosaic = test::open_mosaic(paths, terrain.options);
  auto work = WorkFolder::open(folder / "work", "test").value();
  MemoryBudget memory(std::uint64_t{1} << 30);
  const auto surface = TerrainSurface::survey(*mosaic, terrain.frame, options, work, memory);
  if (!surface) return surface.error();
  ADD_FAILURE() << "was surveyed, expected an error";
  return {};
}

TEST(TerrainSurface, what_makes_no_triangle_or_too_many_steps_is_refused) {
  const Frame plane = Frame::projected(Crs::plane()).value();
  const SmallTerrain line{"line", {{"a.asc", test::grid(0, 0, 1, 5, {1, 2, 3, 4, 5})}}, plane, {}};
  EXPECT_EQ(survey_error(line, {}).code, ErrorCode::invalid_input);
  const SmallTerrain wide{
      "wide", {{"a.asc", test::grid(0, 0, 100'000, 3, std::vector<double>(9, 1))}}, plane, {}};
  const Error error = survey_error(wide, {.step_m = 0.001});
  EXPECT_EQ(error.code, ErrorCode::invalid_input);
  EXPECT_NE(error.message.find("at least 0.0127 m"), std::string::npos) << error.message;
  const Error coarse = survey_error(wide, {.step_m = 20'000});
  EXPECT_EQ(coarse.code, ErrorCode::invalid_input);
  EXPECT_NE(coarse.message.find("at most 1.25e+04 m"), std::string::npos) << coarse.message;
  const SmallTerrain degrees{
      "degrees", {{"a.asc", test::grid(7, 46, 0.0008, 3, {0, 1, 2, 3, 4, 5, 6, 7, 8848})}}, plane, {}};
  const Error near = survey_error(degrees, {});
  EXPECT_EQ(near.code, ErrorCode::invalid_input);
  EXPECT_NE(near.message.find("if they are in degrees, give --crs"), std::string::npos) << near.message;
}

/// What a survey wrote is taken, not read again: a second one with the files gone finds the same.
TEST(TerrainSurface, an_interrupted_survey_goes_on) {
  for (const SmallTerrain& terrain : test::small_terrains(8, 0.2)) {
    SCOPED_TRACE(terrain.name);
    test::ScratchFolder folder;
    test::Paths paths;
    for (const auto& [name, text] : terrain.files) paths.push_back(folder.write(name, text));
    const auto mosaic = test::open_mosaic(paths, terrain.options);
    ASSERT_TRUE(mosaic);
    MemoryBudget memory(std::uint64_t{1} << 30);
    const TerrainOptions options{.square_side = 8};
    auto once = WorkFolder::open(folder / "once", "test").value();
    const auto expected = TerrainSurface::survey(*mosaic, terrain.frame, options, once, memory);
    ASSERT_TRUE(expected);
    int runs = 0;
    for (bool done = false; !done; ++runs) {
      ASSERT_LT(runs, 200);
      auto work = WorkFolder::open(folder / "work", "test").value();
      int calls = 0;
      const auto surface = TerrainSurface::survey(
          *mosaic, terrain.frame, options, work, memory,
          [&](std::string_view, std::uint64_t, std::uint64_t) { return ++calls <= 2; });
      done = surface.has_value();
      if (!done) {
        ASSERT_EQ(surface.error().code, ErrorCode::cancelled);
        continue;
      }
      EXPECT_EQ((*surface)->vertices, (*expected)->vertices);
      EXPECT_EQ((*surface)->figures().least_m, (*expected)->figures().least_m);
      EXPECT_EQ((*surface)->figures().postings.heights, (*expected)->figures().postings.heights);
      EXPECT_EQ(
          difference(corners_of(test::put_together(**surface)), corners_of(test::put_together(**expected))),
          "");
    }
    EXPECT_GT(runs, 1);
  }
}

}  // namespace
}  // namespace cuesta
