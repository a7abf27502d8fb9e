/// Debug views: how triangles came to be, pages and their borders; text over a picture; what is uploaded.

#include <set>

#include "runtime/draw/bitmap_font.h"
#include "runtime/draw/gl_functions.h"
#include "runtime/draw/png_file.h"
#include "runtime/draw/upload_ranges.h"
#include "tests/runtime/draw_scene.h"

namespace cuesta::test {
namespace {

/// A picture to look at, where CUESTA_TEST_PICTURES names a folder.
void keep(const Picture& picture, const std::string& name) {
  const char* const folder = std::getenv("CUESTA_TEST_PICTURES");
  if (folder) {
    EXPECT_TRUE(write_png(std::filesystem::path(folder) / (name + ".png"), picture));
  }
}

/// A sphere whose triangles are dealt to pages by the sign of x; each page is a range.
struct PagedSphere {
  Scene scene = sphere(4, 1000);
  std::vector<std::uint32_t> pages{7, 8};
  std::vector<std::uint8_t> tags;

  PagedSphere() {
    std::vector<std::uint32_t> left, right;
    for (std::size_t t = 0; t < scene.indices.size(); t += 3) {
      std::int64_t x = 0;
      for (std::size_t c = 0; c < 3; ++c) x += scene.vertices[scene.indices[t + c]].x;
      auto& to = x < 0 ? left : right;
      to.insert(to.end(), scene.indices.begin() + static_cast<std::ptrdiff_t>(t),
                scene.indices.begin() + static_cast<std::ptrdiff_t>(t + 3));
    }
    const auto first = static_cast<std::uint32_t>(left.size()),
               second = static_cast<std::uint32_t>(right.size());
    left.insert(left.end(), right.begin(), right.end());
    scene.indices = left;
    scene.draws = {{0, first}, {first, second}};
    tags.resize(scene.indices.size() / 3);
    for (std::size_t t = 0; t < tags.size(); ++t) tags[t] = highest(t) < -300 ? 2 : highest(t) < 300 ? 1 : 0;
  }
  std::int32_t highest(std::size_t t) const {
    std::int32_t y = -2000;
    for (std::size_t c = 0; c < 3; ++c) y = std::max(y, scene.vertices[scene.indices[3 * t + c]].y);
    return y;
  }
  DrawList list() const {
    DrawList list = scene.list();
    list.draw_pages = pages;
    list.triangle_tags = tags;
    return list;
  }
};

Picture picture_of(Renderer& renderer, const DrawList& list, const DrawOptions& options) {
  EXPECT_TRUE(renderer.draw(list, view_from_front(3000), options));
  auto picture = renderer.read();
  EXPECT_TRUE(picture);
  return picture ? *picture : Picture{};
}

TEST(DrawDebug, ChangesAreThreeShades) {
  const PagedSphere sphere;
  const auto renderer = make_renderer();
  const Picture picture = picture_of(*renderer, sphere.list(), {.shading = Shading::changes});
  keep(picture, "changes");
  // Along the middle: lit by the same light, a shade each.
  EXPECT_GT(brightness(at(picture, 160, 70)), brightness(at(picture, 160, 120)) + 100);
  EXPECT_GT(brightness(at(picture, 160, 120)), brightness(at(picture, 160, 155)) + 60);
  for (const int y : {70, 120, 155}) EXPECT_NEAR(at(picture, 160, y)[0], at(picture, 160, y)[2], 40) << y;
}

TEST(DrawDebug, TagsOfRangesBehindTheFirstAreTheirOwn) {
  PagedSphere sphere;
  std::fill(sphere.tags.begin(), sphere.tags.begin() + sphere.scene.draws[0].count / 3, std::uint8_t{0});
  std::fill(sphere.tags.begin() + sphere.scene.draws[0].count / 3, sphere.tags.end(), std::uint8_t{2});
  const Picture picture = picture_of(*make_renderer(), sphere.list(), {.shading = Shading::changes});
  EXPECT_GT(brightness(at(picture, 140, 110)), brightness(at(picture, 175, 110)) + 200);
}

TEST(DrawDebug, WithoutTagsAllIsUnchanged) {
  PagedSphere sphere;
  const auto renderer = make_renderer();
  std::fill(sphere.tags.begin(), sphere.tags.end(), std::uint8_t{0});
  const Picture unchanged = picture_of(*renderer, sphere.list(), {.shading = Shading::changes});
  sphere.tags.clear();
  EXPECT_EQ(
      compare(unchanged, picture_of(*renderer, sphere.list(), {.shading = Shading::changes})).max_channel, 0);
}

TEST(DrawDebug, PagesHaveColoursOfTheirOwn) {
  const PagedSphere sphere;
  const auto renderer = make_renderer();
  const Picture picture = picture_of(*renderer, sphere.list(), {.shading = Shading::pages});
  keep(picture, "pages");
  const Rgba8 left = at(picture, 150, 120), right = at(picture, 170, 120);
  int most = 0;
  for (std::size_t c = 0; c < 3; ++c) most = std::max(most, std::abs(left[c] - right[c]));
  EXPECT_GT(most, 60);
}

TEST(DrawDebug, BordersOfPagesAreLinesAndChangeNothingElse) {
  const PagedSphere sphere;
  const auto renderer = make_renderer();
  const Picture plain = picture_of(*renderer, sphere.list(), {});
  const Picture lines = picture_of(*renderer, sphere.list(), {.page_borders = true});
  keep(lines, "borders");
  std::size_t changed = 0;
  for (int y = 0; y < plain.height_px; ++y)
    for (int x = 0; x < plain.width_px; ++x)
      if (at(plain, x, y) != at(lines, x, y)) {
        ++changed;
        EXPECT_NEAR(x, 160, 12) << y;
      }
  EXPECT_GT(changed, 100u);
  EXPECT_LT(changed, 800u);
  EXPECT_EQ(compare(plain, picture_of(*renderer, sphere.list(), {})).max_channel, 0)
      << "no state is left behind";
}

TEST(DrawDebug, ObjectsWithDifferentGridsHideEachOther) {
  Scene near = sphere(3, 400), far = sphere(3, 100000);
  near.grid = Grid{{0, 0, 1}, 1.0 / 400};
  far.grid = Grid{{0, 0, -1}, 1.0 / 100000};
  for (DrawVertex& v : near.vertices) v.colour = {255, 0, 0, 255};
  for (DrawVertex& v : far.vertices) v.colour = {0, 255, 0, 255};
  for (const bool swapped : {false, true}) {
    // Objects are told apart by place, so that a swap needs a renderer of its own.
    const auto own = make_renderer();
    const std::vector<DrawList> lists =
        swapped ? std::vector{far.list(), near.list()} : std::vector{near.list(), far.list()};
    ASSERT_TRUE(own->draw(lists, view_from_front(6), {}));
    const auto picture = own->read();
    ASSERT_TRUE(picture);
    EXPECT_GT(at(*picture, 160, 120)[0], at(*picture, 160, 120)[1] + 50) << swapped;
  }
}

TEST(DrawDebug, TextIsShownOverThePictureButNotInIt) {
  auto context = make_osmesa_context(320, 240);
  ASSERT_TRUE(context);
  const GlFunctions gl = *load_gl_functions(**context);
  const auto renderer = Renderer::create(std::move(*context));
  ASSERT_TRUE(renderer);
  const Scene scene = sphere(3, 1000);
  const Picture before = draw(**renderer, scene, view_from_front(3000));
  const std::vector<TextBlock> text{{TextPlace::top_left, {"Triangles 1,234,567", "tau 0.5 px {gjpqy}"}},
                                    {TextPlace::top_right, {"60 fps"}},
                                    {TextPlace::centre,
                                     {"!\"#$%&'()*+,-./0123456789:;<=>?", "@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_",
                                      "`abcdefghijklmnopqrstuvwxyz{|}~"}}};
  ASSERT_TRUE((*renderer)->show(320, 240, text, 1));
  Picture shown{320, 240, std::vector<Rgba8>(320 * 240)};
  gl.ReadPixels(0, 0, 320, 240, GL_RGBA, GL_UNSIGNED_BYTE, shown.pixels.data());
  for (int y = 0; y < 120; ++y)
    std::swap_ranges(shown.pixels.begin() + y * 320, shown.pixels.begin() + (y + 1) * 320,
                     shown.pixels.begin() + (239 - y) * 320);
  keep(shown, "text");
  EXPECT_GT(compare(before, shown).max_channel, 150);
  EXPECT_EQ(at(before, 160, 190), at(shown, 160, 190)) << "where no text is, the bytes are copied";
  EXPECT_EQ(compare(before, *(*renderer)->read()).max_channel, 0);
}

TEST(DrawDebug, EveryPrintableCharacterHasItsOwnGlyph) {
  std::set<std::uint64_t> seen;
  for (char c = '!'; c <= '~'; ++c) EXPECT_TRUE(seen.insert(glyph_bits(c)).second) << c;
  EXPECT_EQ(glyph_bits(' '), 0u);
  EXPECT_EQ(glyph_bits('\n'), glyph_bits('\xff'));
}

TEST(DrawDebug, UploadsOfScatteredChangesAreFewAndComplete) {
  std::vector<Range> changed;
  for (std::uint32_t i = 0; i < 20000; ++i) changed.push_back({(i * 7919) % 20000 * 50, 3});
  const auto ranges = coalesce(changed, 10, 512);
  EXPECT_LE(ranges.size(), 512u);
  std::vector<bool> covered(1'000'100);
  std::uint64_t end = 0;
  for (const Range& r : ranges) {
    EXPECT_GE(r.first, end);
    end = std::uint64_t{r.first} + r.count;
    for (std::uint64_t i = r.first; i < end; ++i) covered[i] = true;
  }
  for (const Range& r : changed)
    for (std::uint32_t i = r.first; i < r.first + r.count; ++i) ASSERT_TRUE(covered[i]);
  EXPECT_TRUE(coalesce({}, 10, 4).empty());
  EXPECT_EQ(coalesce(std::vector<Range>{{5, 0}, {100, 1}, {90, 2}}, 1, 4).size(), 2u);
  const auto last = coalesce(std::vector<Range>{{0xFFFFFFF0u, 15}, {0xFFFFFFE0u, 16}}, 1, 4);
  ASSERT_EQ(last.size(), 1u);
  EXPECT_EQ(last[0].count, 31u);
}

}  // namespace
}  // namespace cuesta::test
