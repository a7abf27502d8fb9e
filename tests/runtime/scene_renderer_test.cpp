#include "runtime/draw/scene_renderer.h"

#include "runtime/draw/picture_compare.h"
#include "tests/runtime/small_scene.h"

namespace cuesta::test {
namespace {

constexpr double nearest = 1e-4;

View front_view() {
  View view;
  view.eye = {0, 0, 5}, view.target = {0, 0, 0}, view.width_px = 200, view.height_px = 150;
  return view;
}

SceneRenderer& renderer() {
  static const auto made = SceneRenderer::create(make_osmesa_context().value()).value();
  return *made;
}

struct Drawing {
  SmallScene scene;
  std::unique_ptr<LiveScene> live;
  double now = 0;

  void open() {
    SceneSettings settings;
    settings.load_threads = 0;
    live = LiveScene::open(scene.directory, {scene.reader(), {}}, settings, [this] {
             return now += 0.01;
           }).value();
  }
  Picture draw(const View& view = front_view(), Shading shading = Shading::lit, double uniform = 1) {
    SceneFrameOptions options;
    options.uniform = uniform, options.tau_px = 1e-6, options.least_px = 0;
    live->settle(view, options);
    DrawOptions look;
    look.shading = shading, look.surface_colour = {255, 255, 255, 255}, look.antialias = false;
    EXPECT_TRUE(renderer().draw(live->list(), view, nearest, look));
    return renderer().read().value();
  }
};

std::unique_ptr<Drawing> one_ball(bool with_normals = false) {
  auto d = std::make_unique<Drawing>();
  d->scene.add_node(d->scene.add_part(bumpy_ball(40, 60, with_normals)), {0, 0, 0});
  d->open();
  return d;
}

Rgba8 at(const Picture& p, int x, int y) {
  return p.pixels[static_cast<std::size_t>(y * p.width_px + x)];
}
bool is_background(Rgba8 c) {
  return c[0] == 255 && c[1] == 255 && c[2] == 255;
}
int covered(const Picture& p) {
  return static_cast<int>(
      std::count_if(p.pixels.begin(), p.pixels.end(), [](Rgba8 c) { return !is_background(c); }));
}

TEST(SceneRenderer, DrawsABallWhereItIs) {
  const auto d = one_ball();
  const View view = front_view();
  const Picture p = d->draw();
  const double r = view.pixels_per_unit() / std::sqrt(24.0);
  EXPECT_NEAR(covered(p) / (std::numbers::pi * r * r), 1, 0.04);
  EXPECT_FALSE(is_background(at(p, 100, 75)));
  EXPECT_TRUE(is_background(at(p, 5, 5)));
}

TEST(SceneRenderer, AMovedEyeSeesWhatAMovedBallShows) {
  const auto d = one_ball();
  View view = front_view();
  view.eye.x += 0.5, view.target.x += 0.5;
  const Picture eye_moved = d->draw(view);
  d->live->pose().set_local(0, Trs{{-0.5, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}});
  const Picture ball_moved = d->draw();
  int different = 0;
  for (std::size_t i = 0; i < ball_moved.pixels.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      if (std::abs(ball_moved.pixels[i][c] - eye_moved.pixels[i][c]) > 2) ++different;
  EXPECT_LT(different, 60);
}

/// Far from the origin nothing jitters: instances are placed relative to the eye in f64.
TEST(SceneRenderer, FarFromTheOriginItLooksTheSame) {
  const auto d = one_ball();
  const Picture here = d->draw();
  const Vec3d far{4e6, -2e6, 7e6};
  d->live->pose().set_local(0, Trs{far, {0, 0, 0, 1}, {1, 1, 1}});
  View view = front_view();
  view.eye = view.eye + far, view.target = view.target + far;
  const Picture there = d->draw(view);
  int different = 0;
  for (std::size_t i = 0; i < here.pixels.size(); ++i) different += here.pixels[i] == there.pixels[i] ? 0 : 1;
  EXPECT_LT(different, 150);
}

/// A mirrored instance is lit from outside, as its twin is.
TEST(SceneRenderer, MirroredInstancesAreNotInsideOut) {
  const auto d = one_ball(true);
  const Picture plain = d->draw(front_view(), Shading::normals);
  d->live->pose().set_local(0, Trs{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, -1}});
  const Picture mirrored = d->draw(front_view(), Shading::normals);
  const Rgba8 a = at(plain, 100, 75), b = at(mirrored, 100, 75);
  for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 12) << c;
  EXPECT_GT(b[2], 200) << "towards the eye";
}

/// Normals of a flattened ball lean towards the flat side.
TEST(SceneRenderer, NormalsFollowUnevenScales) {
  const auto d = one_ball(true);
  d->live->pose().set_local(0, Trs{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 0.1}});
  const Picture p = d->draw(front_view(), Shading::normals);
  EXPECT_GT(at(p, 100 + 10, 75)[2], 245) << "z of the normal";
}

TEST(SceneRenderer, InstancesHaveTheirMaterialsColour) {
  Drawing d;
  const std::uint32_t part = d.scene.add_part(bumpy_ball(30, 40));
  d.scene.add_node(part, {-1.2, 0, 0});
  d.scene.add_node(part, {1.2, 0, 0});
  d.scene.directory.scene.materials.resize(2);
  d.scene.directory.scene.materials[0].base_colour = {255, 0, 0, 255};
  d.scene.directory.scene.materials[1].base_colour = {0, 0, 255, 255};
  d.scene.directory.scene.nodes[1].material = 1;
  d.open();
  const Picture p = d.draw();
  ASSERT_EQ(d.live->list().groups.size(), 1u) << "one call";
  const Rgba8 left = at(p, 68, 75), right = at(p, 132, 75);
  EXPECT_GT(left[0], left[2] + 60);
  EXPECT_GT(right[2], right[0] + 60);
}

TEST(SceneRenderer, NearerInstancesHideFartherOnes) {
  Drawing d;
  const std::uint32_t part = d.scene.add_part(bumpy_ball(30, 40));
  d.scene.add_node(part, {0, 0, 2});
  d.scene.add_node(part, {0, 0, -500});
  d.scene.directory.scene.materials.resize(2);
  d.scene.directory.scene.materials[1].base_colour = {0, 0, 255, 255};
  d.scene.directory.scene.nodes[1].material = 1;
  d.open();
  const Rgba8 c = at(d.draw(), 100, 75);
  EXPECT_NEAR(c[0], c[2], 40);
}

TEST(SceneRenderer, CoarserLooksAlmostTheSame) {
  const auto d = one_ball();
  const Picture fine = d->draw(), coarse = d->draw(front_view(), Shading::lit, 0.25);
  EXPECT_NEAR(covered(coarse), covered(fine), 0.02 * covered(fine));
  EXPECT_LT(d->live->list().groups[0].indices->triangles.size(), d->scene.toms[0].triangles.size() / 3);
}

TEST(SceneRenderer, UploadsWhatIsNewOnly) {
  const auto d = one_ball();
  d->draw();
  d->draw();
  EXPECT_LE(renderer().uploads().bytes, 64u) << "the instance alone";
}

TEST(SceneRenderer, GroupsMayComeInAnyOrder) {
  Drawing d;
  d.scene.add_node(d.scene.add_part(bumpy_ball(40, 60)), {-1.2, 0, 0});
  d.scene.add_node(d.scene.add_part(bumpy_ball(20, 30)), {1.2, 0, 0});
  d.open();
  const Picture before = d.draw();
  SceneDrawList list = d.live->list();
  std::vector<DrawnGroup> groups(list.groups.rbegin(), list.groups.rend());
  ASSERT_EQ(groups.size(), 2u);
  list.groups = groups;
  DrawOptions look;
  look.surface_colour = {255, 255, 255, 255}, look.antialias = false;
  ASSERT_TRUE(renderer().draw(list, front_view(), nearest, look));
  EXPECT_EQ(renderer().read().value().pixels, before.pixels);
}

TEST(SceneRenderer, HiddenFragmentsCountButNotAsPixels) {
  Drawing d;
  d.scene.add_node(d.scene.add_part(bumpy_ball(30, 40)), {0, 0, 2});
  d.scene.add_node(d.scene.add_part(bumpy_ball(20, 30)), {0, 0, -4});
  d.open();
  d.draw();
  const auto fill = renderer().fill();
  ASSERT_EQ(fill.size(), 2u) << "the near one first";
  EXPECT_GT(fill[0].pixels, 500);
  EXPECT_GE(fill[0].fragments, fill[0].pixels);
  EXPECT_EQ(fill[1].pixels, 0);
  EXPECT_GT(fill[1].fragments, 100);
}

TEST(SceneRenderer, CountsThePixelsOfEachGroup) {
  Drawing d;
  d.scene.add_node(d.scene.add_part(bumpy_ball(40, 60)), {0, 0, 0});
  d.scene.add_node(d.scene.add_part(bumpy_ball(20, 30)), {2, 0, 0});
  d.open();
  View view = front_view();
  const int both = covered(d.draw(view));
  const auto fill = renderer().fill();
  ASSERT_EQ(fill.size(), 2u);
  const double written = double(fill[0].pixels + fill[1].pixels);
  EXPECT_GE(written, both);
  EXPECT_LE(written, 2.1 * both) << "a far side that was drawn before the near one counts";
  EXPECT_GT(fill[0].pixels, 500);
  view.target = view.eye + (view.eye - view.target);
  d.draw(view);
  EXPECT_TRUE(renderer().fill().empty());
}

TEST(SceneRenderer, NothingInViewIsAnEmptyPicture) {
  const auto d = one_ball();
  View away = front_view();
  away.target = {0, 0, 50};
  EXPECT_EQ(covered(d->draw(away)), 0);
}

}  // namespace
}  // namespace cuesta::test
