/// Terrain as it is drawn: colours of heights, light from the north-west, exaggeration.

#include "runtime/relief.h"
#include "tests/runtime/draw_scene.h"

namespace cuesta::test {
namespace {

Relief globe(double radius, double exaggeration = 1) {
  return {.equatorial_radius = radius, .polar_radius = radius, .exaggeration = exaggeration};
}

/// A square of 16 × 16 quads in x and y from -800 to 800, with a height in each corner.
template <class Height>
Scene ground(const Height& height) {
  Scene scene;
  const auto corner = [&](int i, int j) {
    const Vec3i p{100 * i, 100 * j, 0};
    return Vec3i{p.x, p.y, static_cast<std::int32_t>(std::lround(height(p.x, p.y)))};
  };
  for (int i = -8; i < 8; ++i)
    for (int j = -8; j < 8; ++j)
      scene.add_quad(corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
  scene.draw_all();
  return scene;
}

DrawOptions relief_look(double least, double most) {
  DrawOptions options;
  options.shading = Shading::relief;
  options.relief = Relief{};
  options.heights = {least, most};
  return options;
}

View from_above(double distance = 2500) {
  return view_from_front(distance);
}

TEST(DrawRelief, HeightsHaveColours) {
  const auto colour_at = [&](double height) {
    return at(draw(ground([&](int, int) { return height; }), from_above(6000), relief_look(-4000, 4000)), 160,
              120);
  };
  const Rgba8 deep = colour_at(-3900), sea = colour_at(0), meadow = colour_at(120), brown = colour_at(2200),
              snow = colour_at(3950);
  EXPECT_GT(deep[2], deep[0] + 50);
  EXPECT_GT(sea[2], sea[0] + 30);
  EXPECT_GT(brightness(sea), brightness(deep) + 150);
  EXPECT_GT(meadow[1], meadow[2] + 20);
  EXPECT_GT(meadow[1], meadow[0]);
  EXPECT_GT(brown[0], brown[2] + 30);
  EXPECT_GT(brightness(snow), 3 * 225);
}

TEST(DrawRelief, TheSeaIsWhereItsLevelIs) {
  // Heights above the ellipsoid where the sea is 45 above it, or 90 below.
  for (const double level : {45.0, -90.0}) {
    DrawOptions options = relief_look(level - 10, 2000);
    options.heights.sea_level = level;
    const Rgba8 sea = at(draw(ground([&](int, int) { return level; }), from_above(), options), 160, 120),
                shore =
                    at(draw(ground([&](int, int) { return level + 15; }), from_above(), options), 160, 120);
    EXPECT_GT(sea[2], sea[0] + 30) << level;
    EXPECT_GT(shore[1], shore[2] + 10) << level;
  }
}

TEST(DrawRelief, ColoursOfAnImageStay) {
  Scene scene = ground([](int, int) { return 500.0; });
  for (DrawVertex& v : scene.vertices) v.colour = {200, 20, 20, 255};
  DrawOptions options = relief_look(0, 4000);
  options.heights.vertex_colours = true;
  options.surface_colour = white;
  const Rgba8 red = at(draw(scene, from_above(), options), 160, 120);
  EXPECT_NEAR(red[0], 200, 12);
  EXPECT_LT(red[1], 40);
}

/// A slope that faces where `x` and `y` point, seen from `view`.
int slope_brightness(double x, double y, const View& view) {
  const Picture picture =
      draw(ground([&](int u, int v) { return 900 - 0.6 * (x * u + y * v); }), view, relief_look(0, 4000));
  return brightness(at(picture, 160, 120));
}

TEST(DrawRelief, LightComesFromTheNorthWestWhereverTheEyeIs) {
  View from_south = from_above(), from_east = from_above();
  from_south.eye = {0, -2000, 2600};
  from_south.target = {0, 0, 900};
  from_south.up = {0, 0, 1};
  from_east = from_south;
  from_east.eye = {2000, 0, 2600};
  for (const View& view : {from_above(4000), from_south, from_east}) {
    const int lit = slope_brightness(-0.7, 0.7, view), level = slope_brightness(0, 0, view),
              shaded = slope_brightness(0.7, -0.7, view);
    EXPECT_GT(lit, level + 20);
    EXPECT_GT(level, shaded + 60);
  }
}

TEST(DrawRelief, OnAGlobeNorthWestIsThatOfThePlace) {
  // A smooth sphere of land, seen from above the equator: level everywhere, so equally bright from rim to
  // rim.
  Scene sphere_scene = sphere(5, 1000);
  DrawOptions options = relief_look(-100, 100);
  options.relief = globe(950);
  const Picture picture = draw(sphere_scene, view_from_front(3500), options);
  const int middle = brightness(at(picture, 160, 120));
  for (const auto& [x, y] : {std::pair{130, 120}, {190, 120}, {160, 95}, {160, 145}, {140, 140}})
    EXPECT_NEAR(brightness(at(picture, x, y)), middle, 12) << x << " " << y;
}

/// What the shader raises, raised here.
Scene raised(Scene scene, const Relief& relief) {
  for (DrawVertex& v : scene.vertices) {
    const Vec3d p = relief.raised(scene.grid.world({v.x, v.y, v.z}));
    const Vec3i g = scene.grid.snap(p);
    v.x = g.x, v.y = g.y, v.z = g.z;
  }
  return scene;
}

TEST(DrawRelief, ExaggerationIsWhereReliefRaisesTo) {
  const Scene hills =
      ground([](int x, int y) { return 200 + 90 * std::sin(x * 0.01) * std::cos(y * 0.008); });
  View oblique = from_above();
  oblique.eye = {200, -2600, 2300};
  oblique.target = {0, 0, 500};
  oblique.up = {0, 0, 1};
  Relief flat;
  Relief ball = globe(5000);
  ball.origin = {0, 0, -5000};
  for (Relief relief : {flat, ball})
    for (const double factor : {0.5, 3.0}) {
      relief.exaggeration = factor;
      DrawOptions options;
      options.relief = relief;
      const Picture shown = draw(hills, oblique, options);
      const auto difference = compare(shown, draw(raised(hills, relief), oblique));
      EXPECT_GE(difference.fraction_within(6), 0.99) << factor;
      EXPECT_LT(compare(shown, draw(hills, oblique)).fraction_within(6), 0.95) << "it does something";
    }
}

TEST(DrawRelief, ExaggeratedNormalsAreThoseOfTheExaggeratedSurface) {
  // The same plane with and without vertex normals.
  Scene facets = ground([](int x, int) { return 300 + 0.3 * x; }), smooth = facets;
  const auto code = encode_oct(normalized(Vec3f{-0.3f, 0, 1}), 16);
  for (DrawVertex& v : smooth.vertices) v.normal_u = code[0], v.normal_v = code[1];
  DrawOptions options = relief_look(0, 1000);
  options.relief->exaggeration = 2.5;
  const auto difference =
      compare(draw(facets, from_above(4000), options), draw(smooth, from_above(4000), options));
  EXPECT_GE(difference.fraction_within(3), 0.99);
}

}  // namespace
}  // namespace cuesta::test
