/// Sessions over real connections, of good clients and of bad ones.

#include <thread>

#include "apps/serve/session_server.h"
#include "apps/serve/turns.h"
#include "tests/apps/serve/served_folder.h"
#include "tests/apps/serve/thin_client.h"

namespace cuesta::test {
namespace {

using serve::Hello;

class Sessions : public ServedFolder {
 protected:
  void start_sessions(const serve::SessionServerSettings& settings = {}) {
    build_file(bumpy_sphere(64), folder / "served/scan.cuesta");
    sessions = serve::SessionServer::start(settings);
    serve::SiteParts parts;
    parts.session = [this](auto set, auto connection, auto bytes) {
      sessions->take(std::move(set), std::move(connection), std::move(bytes));
    };
    parts.gauges = [this] { return sessions->gauges(); };
    start({}, parts);
  }
  void TearDown() override {
    ServedFolder::TearDown();
    sessions.reset();
  }
  /// Looks at the sphere from its right.
  static View view(double distance) {
    View v;
    v.eye = {distance, 0.1, 0.2};
    v.target = {0, 0, 0};
    return v;
  }
  void expect_session() {
    ThinClient c(server->port(), "scan");
    ASSERT_TRUE(c.begin({}));
    c.send(serve::encode(view(3)));
    EXPECT_TRUE(c.settle());
    EXPECT_GT(c.mesh->triangle_count(), 100u);
  }
  std::unique_ptr<serve::SessionServer> sessions;
};

TEST_F(Sessions, a_client_follows_its_camera) {
  start_sessions();
  ThinClient c(server->port(), "scan");
  ASSERT_TRUE(c.begin({}));
  c.send(serve::encode(view(30)));
  ASSERT_TRUE(c.settle());
  const auto far = c.mesh->triangle_count();
  c.send(serve::encode(view(1.5)));
  ASSERT_TRUE(c.settle());
  EXPECT_GT(c.mesh->triangle_count(), far);
  EXPECT_EQ(ThinClient(server->port(), "no").upgraded, false);
  EXPECT_EQ(client().ask("/session/scan").status, 426);
  expect_alive();
}

TEST_F(Sessions, many_at_once) {
  start_sessions();
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i)
    threads.emplace_back([&, i] {
      ThinClient c(server->port(), "scan");
      ASSERT_TRUE(c.begin({}));
      for (int k = 0; k < 3; ++k) {
        c.send(serve::encode(view(2 + 0.2 * i + k)));
        ASSERT_TRUE(c.settle());
      }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_GE(metric("cuesta_sessions_begun_total"), 8);
}

TEST_F(Sessions, one_too_many_is_refused_with_words) {
  serve::SessionServerSettings settings;
  settings.sessions = 1;
  start_sessions(settings);
  ThinClient first(server->port(), "scan");
  ASSERT_TRUE(first.begin({}));
  ThinClient second(server->port(), "scan");
  const auto message = second.receive();
  ASSERT_TRUE(message);
  const auto words = serve::decode_refusal(serve::bytes_of(*message));
  ASSERT_TRUE(words);
  EXPECT_NE(words->find("too many sessions"), words->npos);
  first.send(serve::encode(view(3)));
  EXPECT_TRUE(first.settle());
}

TEST_F(Sessions, memory_that_is_taken_is_refused_with_words) {
  serve::SessionServerSettings settings;
  settings.limits.cache_bytes = 16u << 20;
  settings.memory_bytes = 72u << 20;  // of which a quarter is the shelf's: room for one session
  start_sessions(settings);
  std::optional<ThinClient> first(std::in_place, server->port(), "scan");
  ASSERT_TRUE(first->begin({}));
  EXPECT_GE(metric("cuesta_session_memory_bytes"), 40e6);
  ThinClient second(server->port(), "scan");
  const auto message = second.receive();
  ASSERT_TRUE(message);
  const auto words = serve::decode_refusal(serve::bytes_of(*message));
  ASSERT_TRUE(words);
  EXPECT_NE(words->find("memory for sessions is taken"), words->npos);
  first.reset();
  for (int i = 0; i < 300 && metric("cuesta_session_memory_bytes") > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(metric("cuesta_session_memory_bytes"), 0);
  expect_session();
}

/// Ten clients with fifty messages each, and a step of each that is due.
TEST(SessionTurns, messages_are_read_between_two_steps) {
  boost::asio::io_context loop;
  serve::Turns turns(loop);
  constexpr int clients = 10, messages = 50;
  int read = 0, steps = 0;
  std::function<void(int)> read_on = [&](int left) {
    ++read;
    if (left > 1) boost::asio::post(loop, [&, left] { read_on(left - 1); });
  };
  for (int i = 0; i < clients; ++i) boost::asio::post(loop, [&] { read_on(messages); });
  for (int i = 0; i < clients; ++i)
    turns.add([&] {
      EXPECT_GE(read, clients * ++steps);
      if (steps == 1) turns.add([&] { EXPECT_EQ(++steps, clients + 1); });  // behind the others
    });
  loop.run();
  EXPECT_EQ(steps, clients + 1);
  EXPECT_EQ(read, clients * messages);
}

TEST_F(Sessions, wrong_messages_end_a_session_with_words) {
  start_sessions();
  ThinClient c(server->port(), "scan");
  ASSERT_TRUE(c.begin({}));
  c.send("nonsense");
  const auto message = c.receive();
  ASSERT_TRUE(message);
  EXPECT_TRUE(serve::decode_refusal(serve::bytes_of(*message)));
  EXPECT_FALSE(c.receive());
  expect_session();
}

TEST_F(Sessions, wrong_frames_end_theirs_only) {
  start_sessions();
  ThinClient good(server->port(), "scan");
  ASSERT_TRUE(good.begin({}));
  std::mt19937 random(4);
  for (int i = 0; i < 60; ++i) {
    ThinClient c(server->port(), "scan");
    ASSERT_TRUE(c.upgraded);
    std::string bytes =
        ThinClient::frame(serve::encode(Hello{}), i % 16) + ThinClient::frame(std::string(300, 'x'));
    for (auto n = random() % 6; n > 0; --n) bytes[random() % bytes.size()] = static_cast<char>(random());
    c.raw.send(bytes.substr(0, 1 + random() % bytes.size()));
    if (i % 4 == 0) c.receive(20);
  }
  ThinClient unmasked(server->port(), "scan");
  unmasked.raw.send(std::string("\x82\x02hi", 4));
  unmasked.receive();
  EXPECT_TRUE(unmasked.raw.is_closed(5000));
  good.send(serve::encode(view(3)));
  EXPECT_TRUE(good.settle());
  expect_alive();
}

TEST_F(Sessions, clients_that_vanish_or_never_answer) {
  start_sessions();
  std::vector<std::unique_ptr<ThinClient>> mute;
  for (int i = 0; i < 10; ++i) {
    mute.push_back(std::make_unique<ThinClient>(server->port(), "scan"));
    ASSERT_TRUE(mute.back()->begin({}));
    mute.back()->send(serve::encode(view(1.2)));
  }
  expect_session();
  mute.clear();
  for (int i = 0; i < 300 && metric("cuesta_sessions") > 0; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(metric("cuesta_sessions"), 0);
}

TEST_F(Sessions, go_on_with_the_old_file_when_it_is_replaced) {
  start_sessions();
  ThinClient c(server->port(), "scan");
  ASSERT_TRUE(c.begin({}));
  c.send(serve::encode(view(30)));
  ASSERT_TRUE(c.settle());
  std::filesystem::remove(folder / "served/scan.cuesta");
  catalogue->update();
  c.send(serve::encode(view(1.5)));
  EXPECT_TRUE(c.settle());
}

}  // namespace
}  // namespace cuesta::test
