/// Tiles that are made when they are asked for: the bytes of an export, made once, within bounds, whatever
/// comes.

#include <atomic>
#include <condition_variable>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/serve/live_tiles.h"
#include "tests/apps/serve/served_folder.h"
#include "tests/apps/terrain_file.h"
#include "tests/apps/tiles/made_tiles.h"

namespace cuesta::test {
namespace {

using serve::LiveTiles;
using serve::LiveTileSettings;
using serve::TileKind;

TEST(TileAddress, divides_names_of_data_sets_from_names_of_files) {
  const auto parsed = [](std::string_view path) {
    const auto a = serve::parse_tile_address(path);
    return !a ? "none"
              : std::string(a->kind == TileKind::terrain ? "terrain " : "tiles ") + std::string(a->dataset) +
                    " " + std::string(a->file);
  };
  EXPECT_EQ(parsed("/tiles/alps/tileset.json"), "tiles alps tileset.json");
  EXPECT_EQ(parsed("/tiles/a/b/t03-7.glb"), "tiles a/b t03-7.glb");
  EXPECT_EQ(parsed("/terrain/a/b/layer.json"), "terrain a/b layer.json");
  EXPECT_EQ(parsed("/terrain/alps/3/10/5.terrain"), "terrain alps 3/10/5.terrain");
  EXPECT_EQ(parsed("/terrain/1/2/3/10/5.terrain"), "terrain 1/2 3/10/5.terrain");
  for (const char* none :
       {"", "/", "/tiles", "/tiles/", "/tiles/alps", "/tiles/alps/", "/tiles//x", "/terrain/",
        "/terrain/5.terrain", "/terrain/10/5.terrain", "/terrain/3/10/5.terrain", "/data/a/b"})
    EXPECT_EQ(parsed(none), "none") << none;
}

/// Takes the only thread that makes tiles until it is let go.
class BusyMaker {
 public:
  LiveTiles::Done taker() {
    return [this](const auto&) {
      begun_.set_value();
      end_.get_future().wait();
    };
  }
  void wait() { begun_.get_future().wait(); }
  void let_go() { end_.set_value(); }

 private:
  std::promise<void> begun_, end_;
};

/// Of a scan of several tiles and a terrain.
class LiveTilesTest : public ServedFolder {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder / "served/lands");
    build_file(bumpy_sphere(170, 230), scan(), BuildOptions{});
    build_terrain(hills(), Frame::ecef(), folder / "served/lands/hills.cuesta");
  }
  void TearDown() override {
    ServedFolder::TearDown();
    tiles.reset();
  }
  std::filesystem::path scan() const { return folder / "served/sphere.cuesta"; }

  void start_tiles(const LiveTileSettings& settings = {}) {
    tiles = LiveTiles::start(settings);
    serve::SiteParts parts;
    parts.tile = [this](auto set, auto kind, const auto& file, auto client, auto done) {
      tiles->make(std::move(set), kind, file, std::move(client), std::move(done));
    };
    parts.tile_revision = "1";
    parts.gauges = [this] { return tiles->gauges(); };
    start({}, std::move(parts));
  }
  std::shared_ptr<const serve::Dataset> set(const char* name) const {
    return catalogue->contents()->dataset(name);
  }

  /// One thread, which `busy` has.
  void start_with(BusyMaker& busy) {
    LiveTileSettings settings;
    settings.threads = 1;
    start_tiles(settings);
    tiles->make(set("lands/hills"), TileKind::terrain, "layer.json", here, busy.taker());
    busy.wait();
  }
  void wait_for_metric(const std::string& name, double least) const {
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (metric(name) < least && std::chrono::steady_clock::now() < limit)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_GE(metric(name), least) << name;
  }

  std::unique_ptr<LiveTiles> tiles;
  const std::shared_ptr<int> here = std::make_shared<int>();  // a client that stays
};

std::map<std::string, std::string> exported_tiles(const std::filesystem::path& path) {
  FilesInMemory files;
  EXPECT_TRUE(tiles::export_tiles(*open_tiles(path, {}), files, go_on));
  return files.files;
}

std::map<std::string, std::string> exported_terrain(const std::filesystem::path& path) {
  FilesInMemory files;
  EXPECT_TRUE(tiles::export_terrain(**tiles::TerrainPyramid::open(path, {}), files, go_on));
  return files.files;
}

/// All that a client finds from the tileset on.
std::map<std::string, std::string> downloaded_tiles(RawClient& client, const std::string& folder) {
  std::map<std::string, std::string> files;
  const std::function<void(const std::string&)> follow = [&](const std::string& name) {
    const Reply reply = client.ask(folder + name);
    EXPECT_EQ(reply.status, 200) << name << reply.body;
    EXPECT_TRUE(files.emplace(name, reply.body).second) << name;
    if (!name.ends_with(".json")) return;
    const auto root = nlohmann::json::parse(reply.body)["root"];
    follow(root["content"]["uri"]);
    for (const auto& child : root.value("children", nlohmann::json::array())) follow(child["content"]["uri"]);
  };
  follow("tileset.json");
  return files;
}

std::map<std::string, std::string> downloaded_terrain(RawClient& client, const std::string& folder) {
  std::map<std::string, std::string> files;
  const auto get = [&](const std::string& name) -> const std::string& {
    const Reply reply = client.ask(folder + name);
    EXPECT_EQ(reply.status, 200) << name << reply.body;
    return files[name] = reply.body;
  };
  const auto layer = nlohmann::json::parse(get("layer.json"));
  for (std::size_t z = 0; z < layer["available"].size(); ++z)
    for (const auto& run : layer["available"][z])
      for (int x = run["startX"]; x <= run["endX"]; ++x)
        for (int y = run["startY"]; y <= run["endY"]; ++y)
          get(std::to_string(z) + "/" + std::to_string(x) + "/" + std::to_string(y) + ".terrain");
  return files;
}

TEST_F(LiveTilesTest, downloads_are_the_files_of_an_export) {
  start_tiles();
  RawClient c = client();
  const auto sphere = exported_tiles(scan());
  EXPECT_GT(sphere.size(), 5u);
  EXPECT_EQ(downloaded_tiles(c, "/tiles/sphere/"), sphere);
  const auto hills = folder / "served/lands/hills.cuesta";
  EXPECT_EQ(downloaded_tiles(c, "/tiles/lands/hills/"), exported_tiles(hills));
  EXPECT_EQ(downloaded_terrain(c, "/terrain/lands/hills/"), exported_terrain(hills));
}

TEST_F(LiveTilesTest, small_memory_makes_the_same_and_stays_small) {
  LiveTileSettings settings;
  settings.kept_bytes = 400'000;
  settings.cache_bytes = 24u << 20;
  settings.idle_ms = 1;
  start_tiles(settings);
  RawClient c = client();
  const auto sphere = exported_tiles(scan());
  EXPECT_EQ(downloaded_tiles(c, "/tiles/sphere/"), sphere);
  EXPECT_EQ(downloaded_tiles(c, "/tiles/sphere/"), sphere);
  EXPECT_LE(metric("cuesta_tiles_kept_bytes"), 400'000);
  EXPECT_GT(metric("cuesta_tiles_made_total"),
            static_cast<double>(sphere.size()));  // for some were forgotten
}

TEST_F(LiveTilesTest, heads_tags_and_caching) {
  start_tiles();
  RawClient c = client();
  const Reply tileset = c.ask("/tiles/sphere/tileset.json");
  EXPECT_EQ(tileset.header("Content-Type"), "application/json");
  EXPECT_EQ(tileset.header("Access-Control-Allow-Origin"), "*");
  EXPECT_EQ(tileset.header("Cache-Control"), "no-cache");
  const std::string etag = tileset.header("ETag");
  ASSERT_TRUE(etag.starts_with('"'));
  const std::string content =
      "/tiles/sphere/" + nlohmann::json::parse(tileset.body)["root"]["content"]["uri"].get<std::string>();
  const Reply whole = c.ask(content), head = c.ask(content, "", "HEAD");
  EXPECT_EQ(whole.header("Content-Type"), "model/gltf-binary");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("Content-Length"), std::to_string(whole.body.size()));
  const Reply same = c.ask(content, "If-None-Match: " + etag + "\r\n");
  EXPECT_EQ(same.status, 304);
  EXPECT_EQ(same.header("ETag"), etag);
  EXPECT_EQ(c.ask(content, "If-Match: \"other\"\r\n").status, 412);
  const Reply kept = c.ask(content + "?v=" + set("sphere")->version());
  EXPECT_NE(kept.header("Cache-Control").find("immutable"), std::string::npos)
      << kept.header("Cache-Control");
  EXPECT_EQ(kept.body, whole.body);
  EXPECT_EQ(c.ask(content + "?v=older").status, 404);
  const Reply terrain = c.ask("/terrain/lands/hills/0/1/0.terrain");
  EXPECT_EQ(terrain.status, 200);
  EXPECT_EQ(terrain.header("Content-Type"), "application/vnd.quantized-mesh");
  EXPECT_EQ(terrain.header("Content-Encoding"), "gzip");
}

TEST_F(LiveTilesTest, facts_and_the_start_page_name_them) {
  start_tiles();
  RawClient c = client();
  const auto hills = nlohmann::json::parse(c.ask("/api/datasets/lands/hills").body);
  EXPECT_EQ(hills["tiles"], "/tiles/lands/hills/tileset.json");
  EXPECT_EQ(hills["terrain_tiles"], "/terrain/lands/hills/layer.json");
  const auto sphere = nlohmann::json::parse(c.ask("/api/datasets/sphere").body);
  EXPECT_EQ(sphere["tiles"], "/tiles/sphere/tileset.json");
  EXPECT_FALSE(sphere.contains("terrain_tiles"));
  const std::string page = c.ask("/").body;
  EXPECT_NE(page.find("href=\"/terrain/lands/hills/layer.json\""), std::string::npos) << page;
  EXPECT_NE(page.find("href=\"/tiles/sphere/tileset.json\""), std::string::npos) << page;
  EXPECT_EQ(page.find("/terrain/sphere"), page.npos);
}

TEST_F(LiveTilesTest, what_an_export_does_not_have_is_not_found) {
  start_tiles();
  RawClient c = client();
  for (const char* nothing :
       {"/tiles/sphere/", "/tiles/sphere", "/tiles/no/tileset.json", "/tiles/sphere/tileset.json.gz",
        "/tiles/sphere/t-0.json", "/tiles/sphere/t9-0.glb", "/tiles/sphere/t--1.glb",
        "/tiles/sphere/t-99999999999999999999.glb", "/tiles/sphere/layer.json", "/tiles/sphere/sphere.cuesta",
        "/tiles/lands/tileset.json", "/terrain/sphere/layer.json", "/terrain/sphere/0/0/0.terrain",
        "/terrain/lands/hills/0/0/1.terrain", "/terrain/lands/hills/99/0/0.terrain",
        "/terrain/lands/hills/-1/0/0.terrain", "/terrain/lands/hills/00/0/0.terrain",
        "/terrain/lands/hills/tileset.json", "/terrain/0/0/0.terrain"})
    EXPECT_EQ(c.ask(nothing).status, 404) << nothing;
  for (const char* ill : {"/tiles/sphere/../../etc/passwd", "/tiles/sphere/%2e%2e/x", "/tiles/sphere/%00.glb",
                          "/tiles//tileset.json", "/tiles/sphere/t\\0.glb"})
    EXPECT_EQ(c.ask(ill).status, 400) << ill;
  const std::string deep = "/tiles/sphere/t" + std::string(8000, '0') + "-0.glb";
  EXPECT_EQ(c.ask(deep).status, 404);
  EXPECT_EQ(metric("cuesta_tiles_failed_total"), 0);
  EXPECT_EQ(c.ask("/tiles/sphere/tileset.json").status, 200);
}

/// Answers as they come, from any thread.
struct Answers {
  std::mutex mutex;
  std::condition_variable all_there;
  std::map<std::string, int> count;  // by text of the error; "": a file
  int total = 0;

  LiveTiles::Done taker() {
    return [this](const Result<serve::KeptTiles::Bytes>& bytes) {
      const std::lock_guard lock(mutex);
      ++count[bytes ? "" : bytes.error().message];
      ++total;
      all_there.notify_all();
    };
  }
  void wait_for(int answers) {
    std::unique_lock lock(mutex);
    ASSERT_TRUE(all_there.wait_for(lock, std::chrono::seconds(60), [&] { return total >= answers; }));
  }
};

TEST_F(LiveTilesTest, what_is_asked_for_many_times_is_made_once) {
  start_tiles();
  Answers answers;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&] {
      for (int k = 0; k < 8; ++k)
        tiles->make(set("sphere"), TileKind::tiles_3d, "tileset.json", here, answers.taker());
    });
  for (std::thread& t : threads) t.join();
  answers.wait_for(64);
  EXPECT_EQ(answers.count[""], 64);
  const auto tileset = nlohmann::json::parse(client().ask("/tiles/sphere/tileset.json").body);
  EXPECT_EQ(metric("cuesta_tiles_made_total"), 1.0 + static_cast<double>(tileset["root"]["children"].size()));
  EXPECT_EQ(metric("cuesta_tiles_shared_total") + metric("cuesta_tiles_kept_hits_total"), 63 + 1);
  EXPECT_EQ(metric("cuesta_tiles_waiting"), 0);
}

TEST_F(LiveTilesTest, too_many_at_once_are_refused_and_the_rest_is_answered) {
  LiveTileSettings settings;
  settings.threads = 1;
  settings.most_waiting = 4;
  start_tiles(settings);
  Answers answers;
  constexpr int asked = 200;
  for (int i = 0; i < asked; ++i)
    tiles->make(set("sphere"), TileKind::tiles_3d, "t0-" + std::to_string(i) + ".glb", here, answers.taker());
  answers.wait_for(asked);
  EXPECT_EQ(answers.total, asked);
  EXPECT_GT(answers.count["too many tiles are being made; ask again later"], 100);
  EXPECT_GE(asked - answers.count["too many tiles are being made; ask again later"], 4);
}

TEST_F(LiveTilesTest, what_nobody_waits_for_any_more_is_not_made) {
  BusyMaker busy;
  start_with(busy);
  Answers answers;
  auto leaves = std::make_shared<int>();
  for (int i = 0; i < 5; ++i)
    tiles->make(set("sphere"), TileKind::tiles_3d, "t1-" + std::to_string(i) + ".glb", leaves,
                answers.taker());
  tiles->make(set("sphere"), TileKind::tiles_3d, "t1-4.glb", here, answers.taker());  // so one stays wanted
  leaves.reset();
  busy.let_go();
  answers.wait_for(2);
  EXPECT_EQ(answers.total, 2);
  EXPECT_EQ(metric("cuesta_tiles_let_go_total"), 4);
  EXPECT_EQ(metric("cuesta_tiles_waiting"), 0);
}

TEST_F(LiveTilesTest, a_client_that_closes_its_connection_waits_no_more) {
  BusyMaker busy;
  start_with(busy);
  {
    RawClient leaves = client();
    leaves.get("/tiles/sphere/t1-0.glb");
    wait_for_metric("cuesta_tiles_waiting", 1);
  }
  wait_for_metric("cuesta_clients_gone_total", 1);
  RawClient stays = client();
  stays.get("/tiles/sphere/t1-1.glb");
  wait_for_metric("cuesta_tiles_waiting", 2);
  busy.let_go();
  EXPECT_NE(stays.reply().status, 0);
  EXPECT_EQ(metric("cuesta_tiles_let_go_total"), 1);
}

TEST_F(LiveTilesTest, a_stop_answers_those_that_wait) {
  LiveTileSettings settings;
  settings.threads = 1;
  start_tiles(settings);
  Answers answers;
  for (int i = 0; i < 100; ++i)
    tiles->make(set("sphere"), TileKind::tiles_3d, "t0-" + std::to_string(i) + ".glb", here, answers.taker());
  tiles.reset();
  EXPECT_EQ(answers.total, 100);
  EXPECT_GT(answers.count["the server stops"], 0);
}

TEST_F(LiveTilesTest, a_file_that_is_replaced_has_new_tiles) {
  start_tiles();
  RawClient c = client();
  const Reply before = c.ask("/tiles/sphere/tileset.json");
  build_file(bumpy_sphere(40, 50), folder / "new.cuesta");
  std::filesystem::rename(folder / "new.cuesta", scan());
  EXPECT_EQ(c.ask("/tiles/sphere/tileset.json").body, before.body);  // until it is looked for
  catalogue->update();
  const Reply after = c.ask("/tiles/sphere/tileset.json", "If-None-Match: " + before.header("ETag") + "\r\n");
  EXPECT_EQ(after.status, 200);
  EXPECT_NE(after.header("ETag"), before.header("ETag"));
  EXPECT_EQ(downloaded_tiles(c, "/tiles/sphere/"), exported_tiles(scan()));
}

/// Every page of the file, and back.
void flip_pages(const std::filesystem::path& path) {
  const auto file = CuestaFile::open(path);
  ASSERT_TRUE(file);
  std::fstream bytes(path, std::ios::binary | std::ios::in | std::ios::out);
  for (const PageEntry& page : file->directory().pages) {
    const auto at = static_cast<std::streamoff>(page.block.offset + page.block.bytes / 2);
    bytes.seekg(at);
    const int byte = bytes.get();
    bytes.seekp(at);
    bytes.put(static_cast<char>(byte ^ 0x55));
  }
}

TEST_F(LiveTilesTest, damage_is_told_and_the_server_goes_on) {
  start_tiles();
  flip_pages(scan());
  RawClient c = client();
  for (int again = 0; again < 2; ++again) {
    const Reply broken = c.ask("/tiles/sphere/tileset.json");
    EXPECT_EQ(broken.status, 500);
    EXPECT_NE(broken.body.find("sphere"), std::string::npos) << broken.body;
    EXPECT_NE(broken.body.find("corrupt"), std::string::npos) << broken.body;
    EXPECT_EQ(broken.header("Cache-Control"), "no-cache");
  }
  EXPECT_EQ(metric("cuesta_tiles_failed_total"), 2);
  EXPECT_EQ(c.ask("/terrain/lands/hills/0/1/0.terrain").status, 200);
  flip_pages(scan());
  EXPECT_EQ(c.ask("/tiles/sphere/tileset.json").status, 200);
}

TEST_F(LiveTilesTest, a_tile_that_does_not_fit_the_cache_is_refused_in_words) {
  LiveTileSettings settings;
  settings.cache_bytes = 1u << 20;
  start_tiles(settings);
  const Reply refused = client().ask("/tiles/sphere/tileset.json");
  EXPECT_EQ(refused.status, 503);
  EXPECT_NE(refused.body.find("--tile-cache"), std::string::npos) << refused.body;
}

}  // namespace
}  // namespace cuesta::test
