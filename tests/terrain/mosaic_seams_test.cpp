/// Layers of different lattices: the cells of all and the seams between them are one surface.

#include <map>
#include <set>

#include "terrain/constrained_delaunay.h"
#include "tests/shared_data.h"
#include "tests/terrain/mosaic_files.h"

namespace cuesta {
namespace {

using test::degrees;
using test::grid;
using test::none;
using test::open_mosaic;
using test::Paths;

struct RefLess {
  bool operator()(const PostingRef& a, const PostingRef& b) const {
    return std::tuple(a.layer, a.row, a.column) < std::tuple(b.layer, b.row, b.column);
  }
};
using Edge = std::pair<PostingRef, PostingRef>;
struct EdgeLess {
  bool operator()(const Edge& a, const Edge& b) const {
    if (RefLess{}(a.first, b.first) || RefLess{}(b.first, a.first)) return RefLess{}(a.first, b.first);
    return RefLess{}(a.second, b.second);
  }
};

/// All triangles of a mosaic, built as mosaic.h says.
class Surface {
 public:
  explicit Surface(const Mosaic& mosaic) : mosaic_(mosaic) {
    for (std::uint32_t l = 0; l < mosaic.layers().size(); ++l) add_cells(l);
    for (const SeamTriangle& t : mosaic.seams()) add(t);
  }

  /// Edges with one triangle. A failure where one has two on the same side, or more.
  std::set<Edge, EdgeLess> borders() const {
    std::set<Edge, EdgeLess> edges, out;
    for (const SeamTriangle& t : triangles_) {
      for (std::size_t i = 0; i < 3; ++i) {
        const bool is_new = edges.insert({t[i], t[(i + 1) % 3]}).second;
        if (!is_new) ADD_FAILURE() << "two triangles on one side of an edge at " << text(t[i]);
      }
    }
    for (const auto& [a, b] : edges) {
      if (!edges.contains({b, a})) out.insert({a, b});
    }
    return out;
  }
  /// Closed lines of border edges; where two meet in a point either way is taken.
  std::size_t border_loops() const {
    std::multimap<PostingRef, PostingRef, RefLess> next;
    for (const auto& [a, b] : borders()) next.emplace(a, b);
    std::size_t loops = 0;
    for (; !next.empty(); ++loops) {
      const PostingRef first = next.begin()->first;
      PostingRef at = first;
      do {
        const auto edge = next.find(at);
        if (edge == next.end()) {
          ADD_FAILURE() << "a border ends at " << text(at);
          return 0;
        }
        at = edge->second;
        next.erase(edge);
      } while (at != first);
    }
    return loops;
  }
  /// In the first layer's units. A failure where a triangle does not lie upwards.
  double area() const {
    double sum = 0;
    for (const SeamTriangle& t : triangles_) {
      const PlanePoint a = at(t[0]), b = near(at(t[1]), a), c = near(at(t[2]), a);
      const double area = 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
      if (area < -1e-9 * std::abs(a.x))
        ADD_FAILURE() << "face down: " << text(t[0]) << text(t[1]) << text(t[2]) << area;
      sum += area;
    }
    return sum;
  }
  /// Coordinates in the first layer's system.
  PlanePoint at(const PostingRef& p) const {
    const MosaicLayer &layer = mosaic_.layers()[p.layer], &first = mosaic_.layers()[0];
    const PlanePoint place{layer.map.x(double(p.column), double(p.row)),
                           layer.map.y(double(p.column), double(p.row))};
    if (same_coordinates(layer.crs.definition(), first.crs.definition())) return place;
    return first.crs.coordinates(layer.crs.lat_lon(place));
  }

 private:
  PlanePoint near(PlanePoint p, PlanePoint to) const {
    if (mosaic_.layers()[0].crs.geographic()) p.x -= 360 * std::round((p.x - to.x) / 360);
    return p;
  }
  static std::string text(const PostingRef& p) {
    return fmt::format("({}: {}, {})", p.layer, p.column, p.row);
  }
  void add(const SeamTriangle& t) { triangles_.push_back(t); }
  void add_cells(std::uint32_t l) {
    const MosaicLayer& layer = mosaic_.layers()[l];
    const auto heights = test::whole_mosaic(mosaic_, l);
    const std::uint64_t cells = layer.closes() ? layer.width : layer.width - 1;
    for (std::uint64_t r = 0; r + 1 < layer.height; ++r) {
      for (std::uint64_t c = 0; c < cells; ++c) {
        const std::uint64_t east = (c + 1) % layer.width;
        const PostingRef nw{l, c, r}, ne{l, east, r}, sw{l, c, r + 1}, se{l, east, r + 1};
        std::vector<PostingRef> round;  // counter-clockwise
        for (const PostingRef& p : {nw, sw, se, ne}) {
          if (!std::isnan(heights[p.row * layer.width + p.column])) round.push_back(p);
        }
        if (round.size() == 3) add({round[0], round[1], round[2]});
        if (round.size() < 4) continue;
        add({nw, sw, ne});
        add({ne, sw, se});
      }
    }
  }

  const Mosaic& mosaic_;
  std::vector<SeamTriangle> triangles_;
};

struct Box {
  double west, east, south, north;
  double area() const { return (east - west) * (north - south); }
};

/// The surface is the box, all of it, once.
void expect_covers(const Mosaic& mosaic, const Box& box) {
  const Surface surface(mosaic);
  EXPECT_EQ(surface.border_loops(), 1u);
  for (const auto& [a, b] : surface.borders()) {
    const PlanePoint p = surface.at(a), q = surface.at(b);
    const bool is_rim = (p.x == q.x && (p.x == box.west || p.x == box.east)) ||
                        (p.y == q.y && (p.y == box.south || p.y == box.north));
    EXPECT_TRUE(is_rim) << "border from " << p.x << ", " << p.y << " to " << q.x << ", " << q.y;
  }
  EXPECT_NEAR(surface.area(), box.area(), 1e-9 * box.area());
}

std::string level_grid(double x, double y, double spacing, std::uint64_t width, std::uint64_t height) {
  return grid(x, y, spacing, width, test::ramp(width, height));
}

TEST(MosaicSeams, AFineTileInACoarseOne) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("coarse.asc", level_grid(0, 60, 3, 21, 21)),
                                   folder.write("fine.asc", level_grid(20, 40, 1, 16, 16))});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 2u);
  EXPECT_EQ(mosaic->layers()[0].files, std::vector<std::uint32_t>{1});
  EXPECT_FALSE(mosaic->seams().empty());
  expect_covers(*mosaic, {0, 60, 0, 60});
  const auto heights = test::whole_mosaic(*mosaic, 1);
  EXPECT_TRUE(std::isnan(heights[9 * 21 + 9]));  // at (27, 33), under the fine one
  EXPECT_TRUE(test::same(heights[3 * 21 + 3], test::ramp(21, 21)[3 * 21 + 3]));
}

TEST(MosaicSeams, AnyPhaseAndRatioAndPriority) {
  const test::ScratchFolder folder;
  std::mt19937 random(3);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution(low, high)(random);
  };
  for (int i = 0; i < 30; ++i) {
    const double spacing = std::exp2(between(-2.5, 2.5));
    const auto side = std::uint64_t(std::max(2.0, 30 / spacing));
    const auto inner =
        folder.write("a.asc", level_grid(between(15, 25), between(75, 85), spacing, side, side));
    const auto outer = folder.write("b.asc", level_grid(0, 100, 1, 101, 101));
    MosaicOptions options;
    options.priority = MosaicPriority::given_order;
    const auto mosaic = open_mosaic({inner, outer}, options);
    ASSERT_TRUE(mosaic);
    ASSERT_EQ(mosaic->layers().size(), 2u);
    SCOPED_TRACE(fmt::format("case {}, spacing {}", i, spacing));
    expect_covers(*mosaic, {0, 100, 0, 100});
    if (testing::Test::HasFailure()) return;
  }
}

TEST(MosaicSeams, TilesThatShareAnEdge) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("west.asc", level_grid(0, 30, 3, 11, 11)),
                                   folder.write("east.asc", level_grid(30, 30, 1, 31, 31))});
  ASSERT_TRUE(mosaic);
  expect_covers(*mosaic, {0, 60, 0, 30});
}

/// Pixels that are areas: between the last posting of one and the first of the other lie half of both
/// spacings.
TEST(MosaicSeams, TilesThatOnlyTouch) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("west.asc", level_grid(1.5, 28.5, 3, 10, 10)),
                                   folder.write("east.asc", level_grid(30.5, 28.5, 1, 30, 28))});
  ASSERT_TRUE(mosaic);
  expect_covers(*mosaic, {1.5, 59.5, 1.5, 28.5});
}

TEST(MosaicSeams, TilesThatOverlapInPart) {
  const test::ScratchFolder folder;
  std::mt19937 random(5);
  for (int i = 0; i < 20; ++i) {
    const double x = 20 + double(random() % 1000) / 100, y = 25 + double(random() % 1000) / 100;
    const auto mosaic = open_mosaic({folder.write("a.asc", level_grid(0, 30, 1, 31, 31)),
                                     folder.write("b.asc", level_grid(x, y, 0.4, 51, 41))});
    ASSERT_TRUE(mosaic);
    const Surface surface(*mosaic);
    EXPECT_EQ(surface.border_loops(), 1u) << x << ", " << y;
    const double both = 30 * 30 + 20 * 16 - (30 - x) * (std::min(30.0, y) - (y - 16));
    EXPECT_GT(surface.area(), both - 1);  // where the rims meet, the seam rounds the corner off
    EXPECT_LT(surface.area(), both + 6);
  }
}

/// Of the layer of small tiles one is near another layer, and the room between them is huge.
TEST(MosaicSeams, RoomBetweenFarTilesCostsNothing) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("a.asc", level_grid(20, 40, 1, 16, 16)),
                                   folder.write("far.asc", level_grid(3'000'020, 3'000'040, 1, 16, 16)),
                                   folder.write("coarse.asc", level_grid(0, 60, 3, 21, 21)),
                                   folder.write("b.asc", level_grid(39, 25, 1, 10, 10))});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 2u);
  EXPECT_GT(mosaic->postings(), 9'000'000'000'000u);
  EXPECT_FALSE(mosaic->has_files(0, {1000, 1000, 256, 256}));
  MosaicCounts counts;
  test::whole_mosaic(*mosaic, 1, &counts);
  EXPECT_GT(counts.covered, 30u);
  EXPECT_FALSE(mosaic->seams().empty());
}

TEST(MosaicSeams, FarTilesAreNotJoined) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("west.asc", level_grid(0, 30, 3, 11, 11)),
                                   folder.write("east.asc", level_grid(40, 30, 1, 31, 31))});
  ASSERT_TRUE(mosaic);
  EXPECT_TRUE(mosaic->seams().empty());
  EXPECT_EQ(Surface(*mosaic).border_loops(), 2u);
}

TEST(MosaicSeams, VoidsOfTheFineShowTheCoarse) {
  const test::ScratchFolder folder;
  auto fine = test::ramp(61, 61);
  for (std::uint64_t r = 20; r < 45; ++r) std::fill_n(fine.begin() + std::ptrdiff_t(r * 61 + 20), 25, none);
  const auto mosaic = open_mosaic({folder.write("coarse.asc", level_grid(0, 90, 3, 31, 31)),
                                   folder.write("fine.asc", grid(20.2, 80.7, 1, 61, fine))});
  ASSERT_TRUE(mosaic);
  expect_covers(*mosaic, {0, 90, 0, 90});
  const auto heights = test::whole_mosaic(*mosaic, 1);
  EXPECT_FALSE(std::isnan(heights[14 * 31 + 17]));  // at (51, 48), in the middle of the void
}

TEST(MosaicSeams, RandomVoidsInAllLayersLeaveAManifoldWithoutCracks) {
  const test::ScratchFolder folder;
  std::mt19937 random(11);
  for (int i = 0; i < 12; ++i) {
    const auto holes = [&](std::uint64_t n) {
      auto heights = test::ramp(n, n);
      for (double& h : heights) h = random() % 5 == 0 ? none : h;
      return heights;
    };
    const auto mosaic = open_mosaic({folder.write("a.asc", test::grid(0, 60, 1, 61, test::ramp(61, 61))),
                                     folder.write("b.asc", grid(10.3, 50.4, 0.45, 70, holes(70))),
                                     folder.write("c.asc", grid(25.1, 40.2, 0.31, 70, holes(70)))});
    ASSERT_TRUE(mosaic);
    ASSERT_EQ(mosaic->layers().size(), 3u);
    EXPECT_TRUE(mosaic->warnings().empty());
    expect_covers(*mosaic, {0, 60, 0, 60});
    if (testing::Test::HasFailure()) return;
  }
}

TEST(MosaicSeams, WaterOfTheFineDoesNotHideTheCoarse) {
  const test::ScratchFolder folder;
  auto fine = test::ramp(61, 61), coarse = test::ramp(31, 31);
  for (std::uint64_t r = 20; r < 45; ++r) std::fill_n(fine.begin() + std::ptrdiff_t(r * 61 + 20), 25, none);
  coarse[14 * 31 + 17] = none;
  MosaicOptions options;
  options.sea_level_m = -5;
  const auto mosaic = open_mosaic({folder.write("coarse.asc", grid(0, 90, 3, 31, coarse)),
                                   folder.write("fine.asc", grid(20.2, 80.7, 1, 61, fine))},
                                  options);
  ASSERT_TRUE(mosaic);
  expect_covers(*mosaic, {0, 90, 0, 90});
  EXPECT_TRUE(std::isnan(test::whole_mosaic(*mosaic, 0)[32 * 61 + 32]));
  const auto heights = test::whole_mosaic(*mosaic, 1);
  EXPECT_EQ(heights[14 * 31 + 17], -5);
  EXPECT_EQ(heights[15 * 31 + 17], coarse[15 * 31 + 17]);
}

TEST(MosaicSeams, AVoidOfAllStaysOne) {
  const test::ScratchFolder folder;
  auto fine = test::ramp(61, 61), coarse = test::ramp(31, 31);
  for (std::uint64_t r = 20; r < 45; ++r) std::fill_n(fine.begin() + std::ptrdiff_t(r * 61 + 20), 25, none);
  for (std::uint64_t r = 6; r < 24; ++r) std::fill_n(coarse.begin() + std::ptrdiff_t(r * 31 + 8), 18, none);
  const auto mosaic = open_mosaic({folder.write("coarse.asc", grid(0, 90, 3, 31, coarse)),
                                   folder.write("fine.asc", grid(20.2, 80.7, 1, 61, fine))});
  ASSERT_TRUE(mosaic);
  const Surface surface(*mosaic);
  EXPECT_EQ(surface.border_loops(), 2u);
  EXPECT_NEAR(surface.area(), 90 * 90 - 26 * 26, 15);
}

TEST(MosaicSeams, AnUtmTileInDegrees) {
  const test::ScratchFolder folder;
  folder.write("utm.asc", level_grid(500000, 4983000, 30, 81, 61));
  folder.write("utm.asc.json", R"({"epsg": 32633})");
  folder.write("degrees.asc", level_grid(14.98, 45.02, 1.0 / 1200, 73, 49));
  folder.write("degrees.asc.json", R"({"epsg": 4326})");
  for (const auto priority : {MosaicPriority::finest_first, MosaicPriority::given_order}) {
    MosaicOptions options;
    options.priority = priority;
    const auto mosaic = open_mosaic({folder / "degrees.asc", folder / "utm.asc"}, options);
    ASSERT_TRUE(mosaic);
    ASSERT_EQ(mosaic->layers().size(), 2u);
    const Surface surface(*mosaic);
    EXPECT_EQ(surface.border_loops(), 1u);
    if (priority == MosaicPriority::given_order) {
      EXPECT_TRUE(mosaic->seams().empty());  // all of it is covered
    } else {
      EXPECT_FALSE(mosaic->seams().empty());
    }
    for (const auto& [a, b] : surface.borders()) EXPECT_NE(mosaic->layers()[a.layer].map.x_per_column, 30);
    surface.area();
  }
}

std::vector<double> sea(std::uint64_t count) {
  return std::vector<double>(count, 1);
}

TEST(MosaicSeams, AcrossTheAntimeridianOfAWholeEarth) {
  const test::ScratchFolder folder;
  for (const double west : {-180.0, 0.0, 2.0}) {
    const auto mosaic = open_mosaic({folder.write("earth.asc", grid(west, 88, 2, 180, sea(180 * 89))),
                                     folder.write("tile.asc", grid(171.3, 20.4, 0.7, 25, sea(25 * 25)))},
                                    degrees());
    ASSERT_TRUE(mosaic);
    ASSERT_TRUE(mosaic->layers()[1].closes());
    const Surface surface(*mosaic);
    EXPECT_EQ(surface.border_loops(), 2u);  // at 88° N and S
    EXPECT_EQ(surface.borders().size(), 360u);
    EXPECT_NEAR(surface.area(), 360 * 176, 1e-6);
  }
}

TEST(MosaicSeams, ABandAroundTheEarth) {
  const test::ScratchFolder folder;
  const auto mosaic = open_mosaic({folder.write("earth.asc", grid(0, 88, 2, 180, sea(180 * 89))),
                                   folder.write("band.asc", grid(-180, 59.5, 1.5, 240, sea(240 * 81)))},
                                  degrees());
  ASSERT_TRUE(mosaic);
  ASSERT_TRUE(mosaic->layers()[0].closes() && mosaic->layers()[1].closes());
  const Surface surface(*mosaic);
  EXPECT_EQ(surface.border_loops(), 2u);
  EXPECT_EQ(surface.borders().size(), 360u);
  EXPECT_NEAR(surface.area(), 360 * 176, 1e-6);
}

TEST(MosaicSeams, APolarTileOnAWholeEarth) {
  const test::ScratchFolder folder;
  folder.write("earth.asc", grid(0, 90, 2, 180, sea(180 * 91)));
  folder.write("earth.asc.json", R"({"epsg": 4326})");
  folder.write("pole.asc", grid(-1000000, 1000000, 50000, 41, sea(41 * 41)));
  folder.write("pole.asc.json", R"({"epsg": 3031})");
  const auto mosaic = open_mosaic({folder / "earth.asc", folder / "pole.asc"});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 2u);
  const Surface surface(*mosaic);
  const std::uint32_t earth = mosaic->layers()[0].closes() ? 0 : 1;
  for (const auto& [a, b] : surface.borders()) {  // the row at the north pole, which is a point
    EXPECT_EQ(a.layer, earth);
    EXPECT_EQ(a.row, 0u);
  }
  EXPECT_EQ(surface.borders().size(), 180u);
}

TEST(MosaicSeams, AreTheSameForAnyOrderOfReadsAndAgain) {
  const test::ScratchFolder folder;
  const Paths files{folder.write("coarse.asc", level_grid(0, 60, 3, 21, 21)),
                    folder.write("fine.asc", level_grid(20.3, 40.1, 1, 16, 16))};
  const auto first = open_mosaic(files), second = open_mosaic(files);
  ASSERT_TRUE(first && second);
  EXPECT_TRUE(std::ranges::equal(first->seams(), second->seams()));
}

/// They meet in one corner, in water, where the fine one has no data.
TEST(RealNeighbours, OneSecondAndThreeAreLayersThatKeepTheirHeights) {
  const auto coarse = test::shared_data("dem/N49W124.tif"), fine = test::shared_data("dem/N48W125.hgt.zip");
  if (coarse.empty() || fine.empty()) GTEST_SKIP() << "not in ../shared/data/dem";
  const auto mosaic = open_mosaic({coarse, fine});
  ASSERT_TRUE(mosaic);
  ASSERT_EQ(mosaic->layers().size(), 2u);
  EXPECT_EQ(mosaic->layers()[0].width, 3601u);
  for (std::uint32_t layer = 0; layer < 2; ++layer) {
    const auto raster = test::open_raster(layer == 0 ? fine : coarse);
    ASSERT_TRUE(raster);
    MosaicCounts counts;
    const std::uint64_t width = raster->info().width;
    for (std::uint64_t row = 0; row < width; row += 100) {
      const Window window{0, row, width, 1};
      test::expect_same_heights(test::read_mosaic(*mosaic, layer, window, &counts),
                                test::window_of(*raster, window));
    }
    EXPECT_EQ(counts.covered, 0u);
  }
}

TEST(ConstrainedDelaunay, CoversTheHullAndHasTheSegments) {
  std::mt19937_64 random(2);
  for (int round = 0; round < 50; ++round) {
    const std::int64_t side = round % 2 == 0 ? 12 : 1'000'000'000;
    std::set<std::pair<std::int64_t, std::int64_t>> places;
    for (std::int64_t corner : {0, 1, 2, 3}) places.insert({(corner & 1) * side, (corner >> 1) * side});
    while (places.size() < 90)
      places.insert({std::int64_t(random() % std::uint64_t(side + 1)),
                     std::int64_t(random() % std::uint64_t(side + 1))});
    std::vector<GridPoint> points;
    for (const auto& [x, y] : places) points.push_back({x, y});
    std::vector<std::array<std::uint32_t, 2>> segments;
    for (std::uint32_t i = 0; i < 6; ++i) {
      const auto a = std::uint32_t(random() % points.size()), b = std::uint32_t(random() % points.size());
      if (a != b) segments.push_back({a, b});
    }
    const Triangulation t = triangulate(points, segments);
    double area = 0;
    std::set<std::pair<std::uint32_t, std::uint32_t>> marked;
    std::set<std::uint32_t> used;
    for (const DelaunayTriangle& face : t.triangles) {
      const GridPoint a = points[face.points[0]], b = points[face.points[1]], c = points[face.points[2]];
      const double twice = double(b.x - a.x) * double(c.y - a.y) - double(b.y - a.y) * double(c.x - a.x);
      EXPECT_GT(twice, 0);
      area += twice / 2;
      for (std::size_t i = 0; i < 3; ++i) {
        used.insert(face.points[i]);
        const auto p = face.points[(i + 1) % 3], q = face.points[(i + 2) % 3];
        if (face.is_segment[i]) marked.insert(std::minmax(p, q));
        if (face.across[i] == DelaunayTriangle::none) continue;
        const DelaunayTriangle& other = t.triangles[face.across[i]];
        EXPECT_TRUE(std::ranges::count(other.points, p) == 1 && std::ranges::count(other.points, q) == 1);
      }
    }
    EXPECT_LE(area, double(side) * double(side) * (1 + 1e-12));
    EXPECT_GT(area, 0.99 * double(side) * double(side));
    EXPECT_EQ(used.size(), points.size());
    std::set<std::pair<std::uint32_t, std::uint32_t>> wanted;
    for (const auto& [a, b] : segments) wanted.insert(std::minmax(a, b));
    EXPECT_GE(marked.size() + t.lost_segments, wanted.size());
    EXPECT_TRUE(std::ranges::includes(wanted, marked));
  }
}

}  // namespace
}  // namespace cuesta
