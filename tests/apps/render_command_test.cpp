/// cuesta render: contexts, debug shadings and videos.

#include "ooc/mesh_writer.h"
#include "runtime/draw/picture_compare.h"
#include "runtime/draw/png_file.h"
#include "tests/apps/bumpy_sphere.h"
#include "tests/apps/run_program.h"

namespace cuesta::test {
namespace {

class RenderCommand : public testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(write_mesh(folder / "sphere.ply", bumpy_sphere(60, 60)));
    ASSERT_EQ(cuesta({"build", folder / "sphere.ply", "-o", file(), "--cell", "1024", "--quiet"}).status, 0);
  }
  std::string file() const { return folder / "sphere.cuesta"; }
  Outcome cuesta(std::vector<std::string> words) const { return run(folder, std::move(words)); }
  Outcome render(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> words{"render", file(), "--size", "320x240", "-o", folder / name};
    words.insert(words.end(), more.begin(), more.end());
    return cuesta(std::move(words));
  }
  Picture picture(const std::string& name) const {
    auto p = read_png(folder / name);
    EXPECT_TRUE(p) << name;
    return p ? *p : Picture{1, 1, {{}}};
  }

  TestFolder folder;
};

TEST_F(RenderCommand, EglAndOsMesaGiveTheSamePicture) {
  const Outcome osmesa = render("osmesa.png", {"--context", "osmesa"});
  ASSERT_EQ(osmesa.status, 0) << osmesa.err;
  EXPECT_NE(osmesa.err.find("drawn with osmesa, "), std::string::npos) << osmesa.err;
  ASSERT_EQ(render("auto.png", {}).status, 0);
  const Outcome egl = render("egl.png", {"--context", "egl"});
  if (egl.status != 0) GTEST_SKIP() << "no EGL context here: " << egl.err;
  EXPECT_NE(egl.err.find("drawn with egl, "), std::string::npos) << egl.err;
  for (const char* name : {"egl.png", "auto.png"}) {
    const auto difference = compare(picture(name), picture("osmesa.png"));
    EXPECT_GE(difference.fraction_within(4), 0.995) << name;
    EXPECT_GE(difference.ssim, 0.99) << name;
  }
  EXPECT_EQ(render("none.png", {"--context", "telepathy"}).status, 1);
}

TEST_F(RenderCommand, PagesAndTheirBordersShow) {
  for (const char* shading : {"lit", "pages", "changes"})
    ASSERT_EQ(render(std::string(shading) + ".png", {"--shading", shading}).status, 0);
  ASSERT_EQ(render("borders.png", {"--page-borders"}).status, 0);
  EXPECT_LT(compare(picture("lit.png"), picture("pages.png")).fraction_within(8), 0.9);
  const double same = compare(picture("lit.png"), picture("borders.png")).fraction_within(0);
  EXPECT_LT(same, 0.999);
  EXPECT_GT(same, 0.8);
}

TEST_F(RenderCommand, AVideoIsMadeOrWhatIsMissingIsTold) {
  const bool installed = std::system("command -v ffmpeg >/dev/null 2>&1") == 0;
  for (const char* name : {"orbit.mp4", "orbit.webm"}) {
    const Outcome made =
        cuesta({"render", file(), "--orbit", "6", "--size", "161x99", "--video", folder / name, "--quiet"});
    EXPECT_FALSE(std::filesystem::exists(folder / (std::string(name) + ".part")));
    if (!installed) {
      EXPECT_EQ(made.status, 2);
      EXPECT_NE(made.err.find("Debian: ffmpeg"), std::string::npos) << made.err;
      continue;
    }
    ASSERT_EQ(made.status, 0) << made.err;
    EXPECT_GT(std::filesystem::file_size(folder / name), 1000u);
  }
  EXPECT_EQ(cuesta({"render", file(), "--orbit", "6", "--video", folder / "orbit.gif"}).status, 5);
  EXPECT_EQ(cuesta({"render", file(), "--video", folder / "still.mp4"}).status, 1);
}

}  // namespace
}  // namespace cuesta::test
