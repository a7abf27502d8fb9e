/// Scenes among what is served: facts, ranges, a picture on the start page, and no sessions.

#include <nlohmann/json.hpp>

#include "apps/serve/session_server.h"
#include "apps/serve/thumbnails.h"
#include "hierarchy/build_scene.h"
#include "ooc/mesh_writer.h"
#include "runtime/draw/png_file.h"
#include "tests/apps/serve/served_folder.h"
#include "tests/apps/serve/thin_client.h"

namespace cuesta::test {
namespace {

using nlohmann::json;

/// Two balls, one of them as a fan-hierarchy, with 6 between their middles along x.
class ServedScene : public ServedFolder {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder / "in");
    std::filesystem::create_directories(folder / "served");
    ASSERT_TRUE(write_mesh(folder / "in/ball.ply", bumpy_sphere(16)));
    ASSERT_TRUE(write_mesh(folder / "in/large.ply", bumpy_sphere(24, {6, 0, 0})));
    auto source = open_scene(folder / "in", std::uint64_t{64} << 20);
    auto work = WorkFolder::open((folder / "work").string(), "test");
    ASSERT_TRUE(source && work);
    MemoryBudget memory(std::uint64_t{1} << 30);
    SceneBuildOptions options;
    options.largest_tom = 3000;
    options.cell_triangles = 512;
    ASSERT_TRUE(build_scene(**source, folder / "served/balls.cuesta", options, *work, memory));
    thumbnails = serve::Thumbnails::create({});
    sessions = serve::SessionServer::start({});
    serve::SiteParts parts;
    parts.thumbnail = [&](auto set, auto done) { thumbnails->make(std::move(set), std::move(done)); };
    parts.session = [&](auto set, auto connection, auto bytes) {
      sessions->take(std::move(set), std::move(connection), std::move(bytes));
    };
    start({}, parts);
  }
  void TearDown() override {
    ServedFolder::TearDown();
    thumbnails.reset();
    sessions.reset();
  }
  std::unique_ptr<serve::Thumbnails> thumbnails;
  std::unique_ptr<serve::SessionServer> sessions;
};

TEST_F(ServedScene, facts_tell_what_it_is) {
  RawClient c = client();
  const json list = json::parse(c.ask("/api/datasets").body);
  ASSERT_EQ(list["datasets"].size(), 1u) << list;
  const json one = json::parse(c.ask("/api/datasets/balls").body);
  for (const json& told : {list["datasets"][0], one}) {
    EXPECT_EQ(told["kind"], "scene");
    EXPECT_EQ(told["parts"], 2);
    EXPECT_EQ(told["instances"], 2);
    EXPECT_EQ(told["whole"], true);
    EXPECT_EQ(told["thumbnail"], "/thumbnail/balls.png");
    EXPECT_FALSE(told.contains("session"));
    EXPECT_GT(told["triangles"], 3000);
    EXPECT_GT(told["bounds"]["hi"][0].get<double>() - told["bounds"]["lo"][0].get<double>(), 7);
  }
  EXPECT_TRUE(one.contains("metadata"));
}

TEST_F(ServedScene, its_bytes_are_read_in_ranges) {
  const std::string bytes = bytes_of(folder / "served/balls.cuesta");
  RawClient c = client();
  EXPECT_EQ(c.ask("/data/balls.cuesta").body, bytes);
  const Reply part = c.ask("/data/balls.cuesta", "Range: bytes=64-1063\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, bytes.substr(64, 1000));
}

TEST_F(ServedScene, the_start_page_shows_a_picture_of_all_of_it) {
  RawClient c = client();
  const std::string page = c.ask("/").body;
  EXPECT_NE(page.find("<img src=\"/thumbnail/balls.png"), page.npos);
  EXPECT_NE(page.find("Scene, "), page.npos);
  c.get("/thumbnail/balls.png");
  const Reply r = c.reply(60'000);
  ASSERT_EQ(r.status, 200) << r.head << r.body;
  put_bytes(folder / "picture.png", r.body);
  const auto picture = read_png(folder / "picture.png");
  ASSERT_TRUE(picture);
  ASSERT_EQ(picture->width_px, 480);
  // Two balls: there is something on both sides, and a gap between them.
  std::vector<int> drawn(480, 0);
  for (std::size_t i = 0; i < picture->pixels.size(); ++i) drawn[i % 480] += picture->pixels[i][3] == 255;
  const auto from = std::find_if(drawn.begin(), drawn.end(), [](int n) { return n > 0; });
  const auto to = std::find_if(drawn.rbegin(), drawn.rend(), [](int n) { return n > 0; }).base();
  EXPECT_GT(to - from, 200);
  EXPECT_NE(std::find(from, to, 0), to);
}

TEST_F(ServedScene, a_session_is_refused_with_words) {
  ThinClient c(server->port(), "balls");
  ASSERT_TRUE(c.upgraded);
  const auto message = c.receive();
  ASSERT_TRUE(message);
  const auto words = serve::decode_refusal(serve::bytes_of(*message));
  ASSERT_TRUE(words);
  EXPECT_NE(words->find("a scene of many parts has no sessions"), words->npos) << *words;
  EXPECT_FALSE(c.receive());
  EXPECT_EQ(client().ask("/healthz").body, "ok\n");
}

}  // namespace
}  // namespace cuesta::test
