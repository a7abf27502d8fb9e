/// What changes between two frames beyond the camera's motion is no more than what τ allows, and blends make
/// it less.

#include <gtest/gtest.h>

#include "runtime/draw/renderer.h"

#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

constexpr int size_px = 320, window_px = 8, frames = 60;
constexpr double frame_ms = 33, tau_px = 6;

double luma(const Rgba8& p) {
  return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// The largest mean difference of luma over a window: a pop is a change in one place.
double largest_difference(const Picture& a, const Picture& b) {
  double most = 0;
  for (int y = 0; y + window_px <= size_px; y += window_px / 2)
    for (int x = 0; x + window_px <= size_px; x += window_px / 2) {
      double sum = 0;
      for (int j = 0; j < window_px; ++j)
        for (int i = 0; i < window_px; ++i) {
          const auto at = static_cast<std::size_t>((y + j) * size_px + x + i);
          sum += std::abs(luma(a.pixels[at]) - luma(b.pixels[at]));
        }
      most = std::max(most, sum / (window_px * window_px));
    }
  return most;
}

class Popping : public testing::Test {
 protected:
  void SetUp() override {
    build_file(bumpy_sphere(60), folder_ / "a.cuesta");
    full_ = open_cut(folder_ / "a.cuesta");
    full_->settle(ErrorScale::uniform(full_->directory().grid), -1, {});
    auto context = make_osmesa_context();
    if (!context) GTEST_SKIP() << context.error().text();
    full_renderer_ = Renderer::create(std::move(*context)).value();
  }

  Picture draw(Renderer& renderer, Cut& cut, const View& view) {
    EXPECT_TRUE(renderer.draw(cut.draw_list(), view, {}));
    return renderer.read().value();
  }

  /// Towards the sphere and past it, with refinements and coarsenings.
  View camera(int frame) const {
    const Directory& d = full_->directory();
    const Vec3d lo = d.grid.world(d.lo), hi = d.grid.world(d.hi);
    View view;
    view.width_px = view.height_px = size_px;
    view.target = (lo + hi) / 2.0;
    const double t = static_cast<double>(frame) / frames;
    const double distance = length(hi - lo) * (1.6 - 1.6 * t * (1 - t) * 2);
    view.eye = view.target + normalized(Vec3d{0.3 + t * 0.2, 0.2, 1}) * distance;
    return view;
  }

  struct Seen {
    double change =
        0;  ///< the largest that a frame makes beside the camera's: its view, drawn before and after
    double deviation = 0;  ///< the largest from the full resolution
  };
  Seen fly(double geomorph_ms) {
    double now = 0;
    const auto cut = open_cut(folder_ / "a.cuesta", unlimited, [&now] { return now; });
    cut->set_geomorph_ms(geomorph_ms);
    cut->set_path_policy(PathPolicy::always_fine);
    const auto renderer = Renderer::create(make_osmesa_context().value()).value();
    Seen seen;
    cut->settle(ErrorScale::perspective(cut->directory().grid, camera(0)), tau_px, {});
    for (int frame = 1; frame < frames; ++frame) {
      now += frame_ms;
      const View view = camera(frame);
      const Picture before = draw(*renderer, *cut, view);
      cut->adapt(ErrorScale::perspective(cut->directory().grid, view), tau_px, {});
      const Picture after = draw(*renderer, *cut, view), exact = draw(*full_renderer_, *full_, view);
      seen.change = std::max(seen.change, largest_difference(before, after));
      seen.deviation = std::max(seen.deviation, largest_difference(after, exact));
    }
    return seen;
  }

  TemporaryFolder folder_;
  std::unique_ptr<Cut> full_;
  std::unique_ptr<Renderer> full_renderer_;
};

TEST_F(Popping, blends_hide_what_pops_without_them) {
  const Seen blended = fly(400), plain = fly(0);
  RecordProperty("change_with_geomorphs", std::to_string(blended.change));
  RecordProperty("change_without", std::to_string(plain.change));
  EXPECT_LE(blended.change, blended.deviation);
  EXPECT_LT(blended.change, 0.6 * plain.change);
}

}  // namespace
}  // namespace cuesta::test
