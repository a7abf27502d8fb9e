/// EGL and OSMesa give the same picture.

#include <thread>

#include "tests/runtime/draw_scene.h"

namespace cuesta::test {
namespace {

struct Drawn {
  std::string error, driver;
  Picture lit, wireframe;
};

/// In a thread of its own: each kind of context may bring its own copy of Mesa.
Drawn drawn_with(OffscreenContext kind) {
  Drawn result;
  std::thread([&] {
    auto context = make_offscreen_context(kind);
    if (!context) {
      result.error = context.error().text();
      return;
    }
    auto renderer = Renderer::create(std::move(*context));
    if (!renderer) {
      result.error = renderer.error().text();
      return;
    }
    result.driver = (*renderer)->driver();
    result.lit = draw(**renderer, sphere(4, 1000), view_from_front(2500));
    result.wireframe =
        draw(**renderer, sphere(4, 1000), view_from_front(2500), {.shading = Shading::wireframe});
  }).join();
  return result;
}

TEST(DrawContext, EglDrawsWhatOsMesaDraws) {
  const Drawn egl = drawn_with(OffscreenContext::egl);
  if (!egl.error.empty()) GTEST_SKIP() << "no EGL context here: " << egl.error;
  EXPECT_TRUE(egl.driver.starts_with("egl, ")) << egl.driver;
  const Drawn osmesa = drawn_with(OffscreenContext::osmesa);
  ASSERT_EQ(osmesa.error, "");
  for (const auto& [a, b] : {std::pair(egl.lit, osmesa.lit), std::pair(egl.wireframe, osmesa.wireframe)}) {
    const auto difference = compare(a, b);
    EXPECT_GE(difference.fraction_within(4), 0.995) << egl.driver;
    EXPECT_GE(difference.ssim, 0.99) << egl.driver;
  }
}

TEST(DrawContext, AutomaticGivesOne) {
  const Drawn drawn = drawn_with(OffscreenContext::automatic);
  EXPECT_EQ(drawn.error, "");
  EXPECT_GT(covered(drawn.lit), 10'000u);
}

TEST(DrawContext, ContextsComeAndGo) {
  for (int i = 0; i < 3; ++i) {
    const Drawn drawn = drawn_with(OffscreenContext::egl);
    if (!drawn.error.empty()) GTEST_SKIP() << "no EGL context here: " << drawn.error;
    EXPECT_GT(covered(drawn.lit), 10'000u);
  }
}

}  // namespace
}  // namespace cuesta::test
