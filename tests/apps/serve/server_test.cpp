#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/serve/start_page.h"
#include "apps/serve/thumbnails.h"
#include "runtime/draw/png_file.h"
#include "tests/apps/serve/served_folder.h"

namespace cuesta::test {
namespace {

using namespace std::chrono_literals;
using serve::ServerSettings;

TEST_F(ServedFolder, whole_files_ranges_and_heads) {
  start();
  const std::string bytes = bytes_of(folder / "served/sphere.cuesta");
  RawClient c = client();
  const Reply whole = c.ask("/data/sphere.cuesta");
  EXPECT_EQ(whole.status, 200);
  EXPECT_EQ(whole.body, bytes);
  EXPECT_EQ(whole.header("Accept-Ranges"), "bytes");
  EXPECT_EQ(whole.header("Access-Control-Allow-Origin"), "*");
  const Reply head = c.ask("/data/sphere.cuesta", "", "HEAD");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.header("Content-Length"), std::to_string(bytes.size()));
  const Reply part = c.ask("/data/sphere.cuesta", "Range: bytes=100-199\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, bytes.substr(100, 100));
  EXPECT_EQ(part.header("Content-Range"), "bytes 100-199/" + std::to_string(bytes.size()));
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "Range: bytes=-64\r\n").body, bytes.substr(bytes.size() - 64));
  const Reply none = c.ask("/data/sphere.cuesta", "Range: bytes=99999999-\r\n");
  EXPECT_EQ(none.status, 416);
  EXPECT_EQ(none.header("Content-Range"), "bytes */" + std::to_string(bytes.size()));
}

TEST_F(ServedFolder, several_ranges_are_parts_that_can_be_taken_apart) {
  start();
  const std::string bytes = bytes_of(folder / "served/sphere.cuesta");
  RawClient c = client();
  const Reply r = c.ask("/data/sphere.cuesta", "Range: bytes=0-9,500-1499,-3\r\n");
  ASSERT_EQ(r.status, 206);
  const std::string type = r.header("Content-Type");
  const std::string mark = "\r\n--" + type.substr(type.find("boundary=") + 9);
  std::vector<std::string> parts;
  std::size_t at = r.body.find(mark);
  while (r.body.compare(at + mark.size(), 2, "--") != 0) {
    const auto start_of_part = r.body.find("\r\n\r\n", at) + 4;
    at = r.body.find(mark, start_of_part);
    ASSERT_NE(at, r.body.npos);
    parts.push_back(r.body.substr(start_of_part, at - start_of_part));
  }
  EXPECT_EQ(parts, (std::vector<std::string>{bytes.substr(0, 10), bytes.substr(500, 1000),
                                             bytes.substr(bytes.size() - 3)}));
}

TEST_F(ServedFolder, conditional_requests) {
  start();
  RawClient c = client();
  const Reply first = c.ask("/data/sphere.cuesta", "", "HEAD");
  const std::string etag = first.header("ETag"), date = first.header("Last-Modified");
  ASSERT_TRUE(etag.starts_with('"'));
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-None-Match: " + etag + "\r\n").status, 304);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-Modified-Since: " + date + "\r\n").status, 304);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-Match: \"other\"\r\n").status, 412);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-Match: " + etag + "\r\nRange: bytes=0-0\r\n").status, 206);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-Range: \"other\"\r\nRange: bytes=0-0\r\n").status, 200);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "If-Range: " + etag + "\r\nRange: bytes=0-0\r\n").status, 206);
}

TEST_F(ServedFolder, a_version_may_be_kept_for_ever) {
  start();
  RawClient c = client();
  const std::string etag = c.ask("/data/sphere.cuesta", "", "HEAD").header("ETag");
  const std::string versioned = "/data/sphere.cuesta?v=" + etag.substr(1, etag.size() - 2);
  EXPECT_NE(c.ask(versioned).header("Cache-Control").find("immutable"), std::string::npos);
  EXPECT_EQ(c.ask("/data/sphere.cuesta").header("Cache-Control"), "no-cache");
  EXPECT_EQ(c.ask("/data/sphere.cuesta?v=older").status, 404);
}

TEST_F(ServedFolder, addresses) {
  start();
  RawClient c = client();
  const Reply page = c.ask("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.header("Cross-Origin-Opener-Policy"), "same-origin");
  EXPECT_EQ(page.header("Cross-Origin-Embedder-Policy"), "require-corp");
  EXPECT_NE(page.body.find("/data/sphere.cuesta"), std::string::npos);
  const auto list = nlohmann::json::parse(c.ask("/api/datasets").body);
  ASSERT_EQ(list["datasets"].size(), 2u);
  EXPECT_EQ(list["datasets"][0]["name"], "large");
  EXPECT_EQ(nlohmann::json::parse(c.ask("/api/datasets/sphere").body)["name"], "sphere");
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "Access-Control-Request-Method: GET\r\n", "OPTIONS").status, 204);
  EXPECT_EQ(c.ask("/healthz").body, "ok\n");
  EXPECT_EQ(c.ask("/session/sphere").status, 404);
  EXPECT_EQ(c.ask("/data/sphere.cuesta", "", "DELETE").status, 405);
  for (const char* nothing :
       {"/data/", "/data/.cuesta", "/data/no.cuesta", "/data/sphere", "/api/datasets/", "/favicon.ico",
        "/thumbnail/sphere.png", "/view/", "/view/index.html", "/data/sphere.cuesta/"})
    EXPECT_EQ(c.ask(nothing).status, 404) << nothing;
  EXPECT_GE(metric("cuesta_datasets"), 2);
}

TEST_F(ServedFolder, names_are_escaped_on_the_start_page) {
  std::filesystem::copy_file(folder / "served/sphere.cuesta", folder / "served/<b>&.cuesta");
  start();
  const std::string page = serve::start_page(*catalogue->contents(), true);
  EXPECT_EQ(page.find("<b>"), page.npos);
  EXPECT_NE(page.find("&lt;b&gt;&amp;"), page.npos);
  EXPECT_EQ(client().ask("/data/%3Cb%3E%26.cuesta", "Range: bytes=0-5\r\n").body, "CUESTA");
}

TEST_F(ServedFolder, requests_in_one_packet_are_answered_in_order) {
  start();
  RawClient c = client();
  std::string many;
  for (int i = 0; i < 100; ++i)
    many += "GET /data/sphere.cuesta HTTP/1.1\r\nHost: h\r\nRange: bytes=" + std::to_string(i) + "-" +
            std::to_string(i) + "\r\n\r\n";
  c.send(many);
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(c.reply().header("Content-Range").starts_with("bytes " + std::to_string(i) + "-"));
}

TEST_F(ServedFolder, a_file_that_is_replaced_goes_on_as_it_was) {
  start();
  const std::string before = bytes_of(folder / "served/large.cuesta");
  RawClient slow = client(65536);
  slow.get("/data/large.cuesta");
  ASSERT_TRUE(slow.receive());
  write_large_file(folder / "next.cuesta", 2);
  std::filesystem::rename(folder / "next.cuesta", folder / "served/large.cuesta");
  catalogue->update();
  RawClient other = client();
  EXPECT_EQ(other.ask("/data/large.cuesta").body, bytes_of(folder / "served/large.cuesta"));
  const Reply r = slow.reply();
  EXPECT_EQ(r.status, 200);
  EXPECT_TRUE(r.body == before);
  std::filesystem::remove(folder / "served/large.cuesta");
  catalogue->update();
  EXPECT_EQ(other.ask("/data/large.cuesta").status, 404);
}

TEST_F(ServedFolder, thumbnails_are_drawn_once_and_hold_nobody_up) {
  auto thumbnails = serve::Thumbnails::create({});
  serve::SiteParts parts;
  parts.thumbnail = [&](auto set, auto done) { thumbnails->make(std::move(set), std::move(done)); };
  start({}, parts);
  RawClient c = client();
  c.get("/thumbnail/sphere.png");
  expect_alive();
  const Reply r = c.reply(60'000);
  ASSERT_EQ(r.status, 200) << r.head << r.body;
  put_bytes(folder / "picture.png", r.body);
  const auto picture = read_png(folder / "picture.png");
  ASSERT_TRUE(picture);
  EXPECT_EQ(picture->width_px, 480);
  std::size_t drawn = 0;
  for (const Rgba8& p : picture->pixels) drawn += p[3] == 255;
  EXPECT_GT(drawn, picture->pixels.size() / 8);
  EXPECT_EQ(c.ask("/thumbnail/sphere.png").body, r.body);
  EXPECT_EQ(thumbnails->drawn(), 1u);
  server->stop();
  thumbnails.reset();
}

TEST_F(ServedFolder, responses_under_way_are_finished_when_it_stops) {
  start();
  const std::string bytes = bytes_of(folder / "served/large.cuesta");
  RawClient busy = client(65536), idle = client();
  EXPECT_EQ(idle.ask("/healthz").status, 200);
  busy.get("/data/large.cuesta");
  ASSERT_TRUE(busy.receive());
  std::thread stopper([this] { server->stop(); });
  EXPECT_TRUE(idle.is_closed(2000));
  const Reply r = busy.reply();
  EXPECT_TRUE(r.body == bytes);
  busy = client();
  stopper.join();
  EXPECT_FALSE(client().ask("/healthz").status == 200);
}

TEST_F(ServedFolder, stopping_waits_only_so_long) {
  start();
  RawClient stuck = client(4096);
  stuck.get("/data/large.cuesta");
  ASSERT_TRUE(stuck.receive());
  const auto from = std::chrono::steady_clock::now();
  server->stop();
  const auto took = std::chrono::steady_clock::now() - from;
  EXPECT_GT(took, 2500ms);
  EXPECT_LT(took, 10s);
}

TEST_F(ServedFolder, an_address_that_is_taken_or_none_is_an_error) {
  start();
  ServerSettings s;
  s.port = server->port();
  EXPECT_EQ(serve::Server::start(s, *site).error().code, ErrorCode::io);
  s.bind = "here";
  EXPECT_EQ(serve::Server::start(s, *site).error().code, ErrorCode::invalid_input);
}

}  // namespace
}  // namespace cuesta::test
