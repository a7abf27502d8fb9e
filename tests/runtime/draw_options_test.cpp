/// Shadings, colours, uploads of what changed, and what is refused.

#include "runtime/draw/camera_matrices.h"
#include "tests/runtime/draw_scene.h"

namespace cuesta::test {
namespace {

/// An axis-aligned box of half side 500 with flat facets, each with its own normal or with none.
Scene box(bool with_normals) {
  Scene scene;
  for (int axis = 0; axis < 3; ++axis)
    for (const std::int32_t side : {-500, 500}) {
      const auto corner = [&](std::int32_t u, std::int32_t v) {
        Vec3i p;
        p[axis] = side;
        p[(axis + 1) % 3] = side > 0 ? u : v;
        p[(axis + 2) % 3] = side > 0 ? v : u;
        return p;
      };
      scene.add_quad(corner(-500, -500), corner(500, -500), corner(500, 500), corner(-500, 500));
      Vec3f normal;
      normal[axis] = side > 0 ? 1.0f : -1.0f;
      const auto code = encode_oct(normal, 16);
      if (!with_normals) continue;
      for (auto v = scene.vertices.end() - 6; v != scene.vertices.end(); ++v)
        std::tie(v->normal_u, v->normal_v) = std::tie(code[0], code[1]);
    }
  scene.draw_all();
  return scene;
}

View corner_view() {
  View view = view_from_front(0);
  view.eye = {1400, 1100, 1700};
  return view;
}

TEST(DrawOptions, WithoutNormalsFacetsAreShadedFlat) {
  const auto difference = compare(draw(box(true), corner_view()), draw(box(false), corner_view()));
  EXPECT_GE(difference.fraction_within(2), 0.99);
}

TEST(DrawOptions, BackgroundIsExact) {
  Scene empty;
  for (const Rgba8 c :
       {Rgba8{0, 0, 0, 0}, Rgba8{255, 255, 255, 255}, Rgba8{26, 90, 178, 255}, Rgba8{3, 12, 200, 128}})
    for (const bool antialias : {false, true}) {
      const Picture picture = draw(empty, view_from_front(1), {.background = c, .antialias = antialias});
      EXPECT_EQ(covered(picture, c), 0u) << int{c[0]} << ' ' << antialias;
    }
}

TEST(DrawOptions, NormalsAreInTheCamerasFrame) {
  View view = view_from_front(3000);
  view.eye = {3000, 0, 0};
  const Picture picture = draw(sphere(5, 1000), view, {.shading = Shading::normals});
  const Rgba8 centre = at(picture, 160, 120), left = at(picture, 110, 120), top = at(picture, 160, 70);
  EXPECT_NEAR(centre[0], 128, 3);
  EXPECT_NEAR(centre[1], 128, 3);
  EXPECT_NEAR(centre[2], 255, 2);
  EXPECT_LT(left[0], 80);
  EXPECT_GT(top[1], 175);
}

TEST(DrawOptions, VertexColoursAreTintedBySurfaceColour) {
  Scene scene = sphere(3, 1000);
  for (DrawVertex& v : scene.vertices) v.colour = {40, 200, 40, 255};
  const View view = view_from_front(3000);
  const Rgba8 untinted = at(draw(scene, view, {.surface_colour = white}), 150, 110);
  const Rgba8 tinted = at(draw(scene, view), 150, 110);
  EXPECT_GT(untinted[1], 2 * untinted[0]);
  EXPECT_GT(untinted[1], tinted[1]);
}

TEST(DrawOptions, WireframeDarkensEdgesAndHidesWhatIsBehind) {
  const Picture lit = draw(box(false), corner_view());
  const Picture wire = draw(box(false), corner_view(), {.shading = Shading::wireframe});
  std::size_t darker = 0, same = 0;
  for (std::size_t i = 0; i < lit.pixels.size(); ++i) {
    darker += brightness(wire.pixels[i]) + 60 < brightness(lit.pixels[i]);
    same += lit.pixels[i] == wire.pixels[i] && lit.pixels[i] != white;
  }
  EXPECT_GT(darker, 400u);
  EXPECT_GT(same, 10 * darker);
}

TEST(DrawOptions, AntialiasingOnlyTouchesEdges) {
  const View view = view_from_front(3000);
  const auto difference =
      compare(draw(sphere(4, 1000), view), draw(sphere(4, 1000), view, {.antialias = false}));
  EXPECT_GT(difference.max_channel, 20);
  EXPECT_GT(difference.fraction_within(4), 0.98);
}

TEST(DrawUploads, OnlyChangedRangesReachTheGpu) {
  const auto renderer = make_renderer();
  const View view = view_from_front(3000);
  Scene scene = sphere(3, 1000);
  const Picture before = draw(*renderer, scene, view);
  for (DrawVertex& v : scene.vertices) v.x /= 2;
  std::reverse(scene.indices.begin(), scene.indices.end());
  EXPECT_EQ(compare(before, draw(*renderer, scene, view)).max_channel, 0) << "nothing was marked as changed";
  const std::uint32_t vertices = static_cast<std::uint32_t>(scene.vertices.size());
  const std::uint32_t indices = static_cast<std::uint32_t>(scene.indices.size());
  scene.changed_vertices = {{0, 7}, {7, vertices - 9}, {vertices - 2, 2}};
  scene.changed_indices = {{indices / 2, indices - indices / 2}, {0, indices / 2}, {5, 0}};
  EXPECT_EQ(compare(draw(scene, view), draw(*renderer, scene, view)).max_channel, 0);
}

TEST(DrawUploads, AGrownPoolKeepsWhatItHadAndTakesWhatChanged) {
  const auto renderer = make_renderer();
  const View view = view_from_front(3000);
  Scene scene = sphere(4, 1000);
  draw(*renderer, scene, view);
  for (const std::int32_t y : {0, -500, 500}) {
    const auto vertices = static_cast<std::uint32_t>(scene.vertices.size());
    const auto indices = static_cast<std::uint32_t>(scene.indices.size());
    for (int i = 0; i < 1000; ++i)
      scene.add_triangle({-800 + i, y, 1200}, {800, y, 1200}, {0, y + 200, 1200}, {255, 0, 0, 255});
    scene.draw_all();
    scene.changed_vertices = {{vertices, 3000}};
    scene.changed_indices = {{indices, 3000}};
    EXPECT_EQ(compare(draw(scene, view), draw(*renderer, scene, view)).max_channel, 0);
    EXPECT_EQ(renderer->uploads().bytes, 3000 * (sizeof(DrawVertex) + 4));
    EXPECT_EQ(renderer->uploads().calls, 2u);
  }
}

TEST(DrawUploads, MorphedVerticesAreDrawnInsteadOfThePools) {
  const auto renderer = make_renderer();
  const View view = view_from_front(3000);
  const Scene scene = sphere(4, 1000);
  const Picture before = draw(*renderer, scene, view);
  Scene half = scene;
  std::vector<MorphedVertex> morphed;
  for (std::uint32_t i = 0; i < scene.vertices.size(); i += 1 + i % 7 + (i > 2000 ? 300 : 0)) {
    half.vertices[i].y /= 2;
    morphed.push_back({i, half.vertices[i]});
  }
  std::reverse(morphed.begin() + 3, morphed.end());
  DrawList list = scene.list();
  list.morphed = morphed;
  ASSERT_TRUE(renderer->draw(list, view, {}));
  EXPECT_EQ(compare(*renderer->read(), draw(half, view)).max_channel, 0);
  EXPECT_LT(renderer->uploads().calls, 40u);
  Scene restored = scene;
  for (const MorphedVertex& m : morphed) restored.changed_vertices.push_back({m.slot, 1});
  EXPECT_EQ(compare(before, draw(*renderer, restored, view)).max_channel, 0);
}

TEST(DrawUploads, OnlyTheDrawRangesAreDrawn) {
  Scene scene;
  for (const std::int32_t x : {-600, 0, 600})
    scene.add_triangle({x - 100, -100, 0}, {x + 100, -100, 0}, {x, 100, 0});
  scene.draws = {{6, 3}, {0, 3}, {3, 0}};
  const View view = view_from_front(2000);
  const Picture picture = draw(scene, view);
  const int step = static_cast<int>(view.pixels_per_unit() / 2000 * 600);
  EXPECT_NE(at(picture, 160 - step, 120), white);
  EXPECT_EQ(at(picture, 160, 120), white);
  EXPECT_NE(at(picture, 160 + step, 120), white);
}

TEST(DrawErrors, AViewLargerThanTheDriverAllowsIsRefusedAndTheNextIsDrawn) {
  const auto renderer = make_renderer();
  View view = view_from_front(3000);
  view.width_px = 1 << 24;
  const auto drawn = renderer->draw(sphere(2, 1000).list(), view, {});
  ASSERT_FALSE(drawn);
  EXPECT_EQ(drawn.error().code, ErrorCode::invalid_input);
  EXPECT_GT(covered(draw(*renderer, sphere(2, 1000), view_from_front(3000))), 1000u);
}

TEST(DrawErrors, ReadingBeforeDrawingIsRefused) {
  const auto picture = make_renderer()->read();
  ASSERT_FALSE(picture);
  EXPECT_EQ(picture.error().code, ErrorCode::invalid_input);
}

TEST(DrawErrors, AMissingEntryPointIsNamed) {
  class Poor final : public GlContext {
    bool make_current() override { return true; }
    GlProc proc(const char*) const override { return nullptr; }
    std::string_view kind() const override { return "poor"; }
  };
  const auto renderer = Renderer::create(std::make_unique<Poor>());
  ASSERT_FALSE(renderer);
  EXPECT_EQ(renderer.error().code, ErrorCode::io);
  EXPECT_NE(renderer.error().message.find("gl"), std::string::npos);
}

TEST(CameraMatrices, TheEyeIsSplitExactlyAndNeverOverflows) {
  View view = view_from_front(1);
  view.eye = {100.5, -0.25, 3e12};
  view.target = {};
  const CameraMatrices camera = camera_matrices(view, Grid{{0, 0, 0}, 0.5});
  EXPECT_EQ(camera.eye_whole, (Vec3i{201, -1, (1 << 30) - 1}));
  EXPECT_EQ(camera.eye_part.x, 0.0f);
  EXPECT_EQ(camera.eye_part.y, 0.5f);
  EXPECT_NEAR(camera.eye_part.z, 6e12 - (1 << 30), 1e6);
}

}  // namespace
}  // namespace cuesta::test
