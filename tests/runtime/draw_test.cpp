/// What a picture must show whatever the lighting: silhouettes, sides, directions, depth.

#include "tests/runtime/draw_scene.h"

namespace cuesta::test {
namespace {

const DrawOptions plain{.antialias = false};

TEST(Draw, SilhouetteCoversTheAnalyticProjection) {
  const View view = view_from_front(3000);
  const Picture picture = draw(sphere(5, 1000), view, plain);
  const double radius_px = view.pixels_per_unit() * std::tan(std::asin(1000.0 / 3000.0));
  const double expected = std::numbers::pi * radius_px * radius_px;
  EXPECT_NEAR(static_cast<double>(covered(picture)) / expected, 1, 0.005);
}

TEST(Draw, UpperLeftIsTheLitSide) {
  const Picture picture = draw(sphere(4, 1000), view_from_front(3000));
  EXPECT_GT(brightness(at(picture, 130, 80)), brightness(at(picture, 160, 120)));
  EXPECT_GT(brightness(at(picture, 160, 120)), brightness(at(picture, 190, 160)) + 100);
  EXPECT_GT(brightness(at(picture, 190, 160)), 100) << "the shadow side is not black";
}

TEST(Draw, FrontFacesAreWarmAndBackFacesBlue) {
  const Scene scene = sphere(4, 1000);
  const Picture outside = draw(scene, view_from_front(3000), plain);
  for (const int x : {110, 130, 160}) EXPECT_GT(at(outside, x, 110)[0], at(outside, x, 110)[2]) << x;
  for (const Rgba8 c : draw(scene, view_from_front(10)).pixels) ASSERT_GT(c[2], c[0] + 20);
}

TEST(Draw, CulledBackFacesLeaveTheBackground) {
  const DrawOptions options{.cull_back_faces = true};
  EXPECT_EQ(covered(draw(sphere(3, 1000), view_from_front(10), options)), 0u);
  EXPECT_GT(covered(draw(sphere(3, 1000), view_from_front(3000), options)), 1000u);
}

TEST(Draw, PlusXIsRightAndPlusYIsUp) {
  Scene scene;
  scene.add_triangle({500, -100, 0}, {700, -100, 0}, {600, 100, 0}, {255, 0, 0, 255});
  scene.add_triangle({-100, 400, 0}, {100, 400, 0}, {0, 600, 0}, {0, 255, 0, 255});
  scene.draw_all();
  const View view = view_from_front(2000);
  const Picture picture = draw(scene, view);
  const int step = static_cast<int>(view.pixels_per_unit() / 2000 * 600);
  const Rgba8 right = at(picture, 160 + step, 120), up = at(picture, 160, 120 - step * 5 / 6);
  EXPECT_GT(right[0], right[1] + 60);
  EXPECT_GT(up[1], up[0] + 60);
  EXPECT_EQ(at(picture, 160 - step, 120), white);
  EXPECT_EQ(at(picture, 160, 120 + step * 5 / 6), white);
}

TEST(Draw, TheSameFarFromTheOrigin) {
  constexpr std::int32_t far = (1 << 29) + 12345;  // 10^6 times the object's 512 steps
  const Grid grid{{10, -20, 30}, 1.0 / 512};
  Scene here = sphere(4, 256);
  Scene there = sphere(4, 256, {far, -far, far});
  here.grid = there.grid = grid;
  const auto view = [&](Vec3i centre) {
    View v = view_from_front(1.5, grid.world(centre));
    v.eye = v.eye + Vec3d{0.3, 0.2, 0.1};
    return v;
  };
  const Picture a = draw(here, view({}));
  ASSERT_GT(covered(a), 5000u);
  EXPECT_GE(compare(a, draw(there, view({far, -far, far}))).fraction_within(1), 0.999);
}

/// OpenGL 3.3 as some drivers have it: without glClipControl.
class WithoutClipControl final : public GlContext {
 public:
  explicit WithoutClipControl(std::unique_ptr<GlContext> real) : real_(std::move(real)) {}
  bool make_current() override { return real_->make_current(); }
  GlProc proc(const char* name) const override {
    return std::string_view(name) == "glClipControl" ? nullptr : real_->proc(name);
  }
  std::string_view kind() const override { return real_->kind(); }

 private:
  std::unique_ptr<GlContext> real_;
};

/// Two slanted parallel planes, one part in 10^5 of the distance apart, red in front; something near at 1 :
/// 10^6.
Scene deep_scene() {
  constexpr std::int32_t n = 100'000'000, gap = 1000;
  constexpr Rgba8 red{255, 0, 0, 255}, green{0, 255, 0, 255};
  Scene scene;
  scene.add_quad({-n, -n, -n}, {n, -n, -n}, {n, n, -2 * n}, {-n, n, -2 * n}, red);
  scene.add_quad({-n, -n, -n - gap}, {n, -n, -n - gap}, {n, n, -2 * n - gap}, {-n, n, -2 * n - gap}, green);
  scene.add_quad({-200, -10, -100}, {-20, -10, -100}, {-20, 10, -100}, {-200, 10, -100}, {0, 0, 255, 255});
  scene.draw_all();
  return scene;
}

void expect_no_depth_fighting(const Picture& picture) {
  std::size_t red = 0, green = 0, blue = 0;
  for (const Rgba8 c : picture.pixels) {
    red += c[0] > c[1] + 40 && c[0] > c[2] + 40;
    green += c[1] > c[0] + 40 && c[1] > c[2] + 40;
    blue += c[2] > c[0] + 40 && c[2] > c[1] + 40;
  }
  EXPECT_GT(red, 10'000u);
  EXPECT_GT(blue, 500u);
  EXPECT_EQ(green, 0u);
}

TEST(Draw, DepthResolvesOnePartIn100000AtANearFarRatioOfAMillion) {
  expect_no_depth_fighting(draw(deep_scene(), view_from_front(0.5, {0, 0, -1}), plain));
}

TEST(Draw, DriversWithoutClipControlDrawTheSame) {
  auto renderer = Renderer::create(std::make_unique<WithoutClipControl>(std::move(*make_osmesa_context())));
  ASSERT_TRUE(renderer) << renderer.error().text();
  const View deep = view_from_front(0.5, {0, 0, -1});
  expect_no_depth_fighting(draw(**renderer, deep_scene(), deep, plain));
  Scene scene = sphere(4, 1000);
  for (const double distance : {3000.0, 10.0, 999.0}) {
    scene.changed_vertices = {{0, static_cast<std::uint32_t>(scene.vertices.size())}};
    scene.changed_indices = {{0, static_cast<std::uint32_t>(scene.indices.size())}};
    const View view = view_from_front(distance);
    EXPECT_GE(compare(draw(scene, view, plain), draw(**renderer, scene, view, plain)).fraction_within(1),
              0.999)
        << distance;
  }
}

TEST(Draw, WhatIsBehindTheEyeIsNotSeen) {
  Scene scene;
  scene.add_triangle({-100, -100, 50}, {100, -100, 50}, {0, 100, 50});
  scene.draw_all();
  EXPECT_EQ(covered(draw(scene, view_from_front(20))), 0u);
  EXPECT_GT(covered(draw(scene, view_from_front(200))), 1000u);
}

}  // namespace
}  // namespace cuesta::test
