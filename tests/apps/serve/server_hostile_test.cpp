/// Clients that mean no good, and disks that fail: the server stays up, and others are served.

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include "apps/serve/send_pieces.h"
#include "tests/apps/serve/served_folder.h"

namespace cuesta::test {
namespace {

using namespace std::chrono_literals;
using HostileClients = ServedFolder;
using serve::ServerSettings;

template <class Condition>
bool eventually(Condition condition) {
  for (int i = 0; i < 500; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(10ms);
  }
  return false;
}

void reset(RawClient& client) {
  const linger now{1, 0};
  setsockopt(client.socket(), SOL_SOCKET, SO_LINGER, &now, sizeof now);
}

TEST_F(HostileClients, that_vanish_in_the_middle_of_a_response) {
  start();
  for (int i = 0; i < 40; ++i) {
    RawClient c = client(4096);
    c.get("/data/large.cuesta", i % 2 ? "" : "Range: bytes=0-9999999,10000000-\r\n");
    c.receive();
    if (i % 3) reset(c);
  }
  expect_alive();
  EXPECT_TRUE(eventually([&] { return metric("cuesta_connections") <= 1; }));
}

TEST_F(HostileClients, that_send_a_head_byte_by_byte) {
  ServerSettings s;
  s.limits.head_ms = 300;
  start(s);
  std::vector<RawClient> slow;
  for (int i = 0; i < 50; ++i) slow.push_back(client());
  const auto end = std::chrono::steady_clock::now() + 250ms;
  const std::string head = "GET / HTTP/1.1\r\nHost: h\r\nX: xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx";
  for (std::size_t i = 0; std::chrono::steady_clock::now() < end; ++i) {
    for (RawClient& c : slow) c.send(head.substr(i % head.size(), 1));
    std::this_thread::sleep_for(20ms);
  }
  expect_alive();
  for (RawClient& c : slow) EXPECT_EQ(c.reply().status, 408);
  EXPECT_GE(metric("cuesta_connections_timed_out_total"), 50);
}

TEST_F(HostileClients, that_say_nothing) {
  ServerSettings s;
  s.limits.head_ms = 100;
  start(s);
  EXPECT_TRUE(client().is_closed(3000));
}

TEST_F(HostileClients, that_take_a_response_too_slowly) {
  ServerSettings s;
  s.limits.stall_ms = 200;
  start(s);
  RawClient c = client(4096);
  c.get("/data/large.cuesta");
  EXPECT_TRUE(eventually([&] { return metric("cuesta_connections_timed_out_total") >= 1; }));
  EXPECT_EQ(c.reply().status, 0);
  expect_alive();
}

TEST_F(HostileClients, that_are_too_many) {
  ServerSettings s;
  s.limits.connections = 8;
  s.threads = 2;
  start(s);
  std::vector<RawClient> idle;
  for (int i = 0; i < 100; ++i) {
    idle.push_back(client());
    ASSERT_TRUE(idle.back().connected());
  }
  // Those that only wait make room.
  expect_alive();
  EXPECT_GE(metric("cuesta_connections_displaced_total"), 80);
  EXPECT_LE(metric("cuesta_connections"), 8);
}

TEST_F(HostileClients, with_heads_that_are_too_long) {
  start();
  RawClient c = client();
  c.send("GET / HTTP/1.1\r\nHost: h\r\nX: " + std::string(100'000, 'x'));
  EXPECT_EQ(c.reply().status, 431);
  EXPECT_TRUE(c.is_closed(4000));
  RawClient d = client();
  std::string lines = "GET / HTTP/1.1\r\nHost: h\r\n";
  for (int i = 0; i < 10'000; ++i) lines += "X-" + std::to_string(i) + ": y\r\n";
  d.send(lines + "\r\n");
  EXPECT_EQ(d.reply().status, 431);
  RawClient e = client();
  EXPECT_EQ(e.ask("/" + std::string(12'000, 'x')).status, 404);
  expect_alive();
}

TEST_F(HostileClients, with_heads_that_are_none) {
  start();
  for (const std::string& bytes :
       {std::string("\x16\x03\x01\x02\x01", 5) + "\r\n\r\n", std::string("\0\0\0\0\r\n\r\n", 8),
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET /\x7f HTTP/1.1\r\nHost: h\r\n\r\n"),
        std::string("GET / HTTP/1.1\r\nHost: h\r\nContent-Length: 1x\r\n\r\n"),
        std::string("PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n")}) {
    RawClient c = client();
    c.send(bytes);
    const int status = c.reply().status;
    EXPECT_TRUE(status == 400 || status == 505) << bytes;
    EXPECT_TRUE(c.is_closed(4000));
  }
  expect_alive();
}

TEST_F(HostileClients, with_bodies) {
  start();
  RawClient c = client();
  c.send("POST /data/sphere.cuesta HTTP/1.1\r\nHost: h\r\nContent-Length: 1000000\r\n\r\n" +
         std::string(100'000, 'x'));
  EXPECT_EQ(c.reply().status, 413);
  RawClient d = client();
  d.send(
      "GET / HTTP/1.1\r\nHost: h\r\nContent-Length: 40\r\n\r\nGET /healthz HTTP/1.1\r\nHost: "
      "smuggled\r\n\r\n");
  EXPECT_EQ(d.reply().status, 413);
  EXPECT_EQ(d.reply(1000).status, 0);
  expect_alive();
}

TEST_F(HostileClients, that_look_for_files_outside) {
  put_bytes(folder / "secret.cuesta", bytes_of(folder / "served/sphere.cuesta"));
  std::filesystem::create_symlink(folder / "secret.cuesta", folder / "served/link.cuesta");
  start();
  for (const char* target : {"/data/../secret.cuesta",
                             "/data/%2e%2e/secret.cuesta",
                             "/data/..%2fsecret.cuesta",
                             "/data/%2e%2e%2fsecret.cuesta",
                             "/data/..%5csecret.cuesta",
                             "/data/%252e%252e%252fsecret.cuesta",
                             "/data/link.cuesta",
                             "/data//etc/passwd",
                             "/data/sphere.cuesta%00.cuesta",
                             "/data/sphere%00.cuesta",
                             "/data/%c0%ae%c0%ae/secret.cuesta",
                             "/view/../secret.cuesta",
                             "/view/%2e%2e/%2e%2e/etc/passwd",
                             "/thumbnail/../secret.png",
                             "/api/datasets/../secret",
                             "//etc/passwd",
                             "http://h/data/../secret.cuesta",
                             "/data/....//secret.cuesta",
                             "/data/.%2e/secret.cuesta",
                             "/data/secret.cuesta"}) {
    RawClient c = client();
    const Reply r = c.ask(target);
    EXPECT_TRUE(r.status == 400 || r.status == 404) << target << ": " << r.status;
  }
  expect_alive();
}

TEST_F(HostileClients, that_ask_for_ten_thousand_ranges) {
  ServerSettings s;
  s.limits.head_bytes = 256 * 1024;
  start(s);
  std::string many = "Range: bytes=0-0";
  for (int i = 1; i < 10'000; ++i) many += "," + std::to_string(i) + "-" + std::to_string(i);
  RawClient c = client();
  EXPECT_EQ(c.ask("/data/large.cuesta", many + "\r\n").status, 416);
  std::string overlapping = "Range: bytes=0-";
  for (int i = 1; i < 60; ++i) overlapping += ",0-";
  EXPECT_EQ(c.ask("/data/large.cuesta", overlapping + "\r\n").status, 416);
  expect_alive();
}

TEST_F(HostileClients, with_noise) {
  start();
  std::mt19937 random(3);
  const std::string valid =
      "GET /data/sphere.cuesta?v=1 HTTP/1.1\r\nHost: h\r\nRange: bytes=0-9,-4\r\nIf-None-Match: "
      "\"x\"\r\nConnection: keep-alive\r\n\r\n";
  for (int i = 0; i < 300; ++i) {
    std::string bytes = valid + valid;
    for (auto n = 1 + random() % 8; n > 0; --n) bytes[random() % bytes.size()] = static_cast<char>(random());
    RawClient c = client();
    c.send(bytes.substr(0, random() % bytes.size()));
    if (i % 10 == 0) c.receive(50);
  }
  expect_alive();
}

std::atomic<int> fault_after{-1};
int failing_disk(const serve::ServedFile&, std::uint64_t offset, std::uint64_t) {
  return fault_after >= 0 && offset >= static_cast<std::uint64_t>(fault_after.load()) ? EIO : 0;
}

TEST_F(HostileClients, none_but_a_disk_that_fails) {
  start();
  serve::set_send_fault(failing_disk);
  fault_after = 4 << 20;
  RawClient c = client();
  const Reply cut = c.ask("/data/large.cuesta");
  EXPECT_EQ(cut.status, 0);
  EXPECT_TRUE(c.is_closed(2000));
  EXPECT_LT(c.buffered(), large_bytes);
  expect_alive();
  EXPECT_GE(metric("cuesta_files_failed_total"), 1);
  serve::set_send_fault(nullptr);
  EXPECT_EQ(client().ask("/data/large.cuesta").status, 200);
}

TEST_F(HostileClients, none_but_a_file_that_is_cut_short_while_it_is_sent) {
  start();
  RawClient c = client(65536);
  c.get("/data/large.cuesta");
  ASSERT_TRUE(c.receive());
  std::filesystem::resize_file(folder / "served/large.cuesta", 1 << 20);
  EXPECT_EQ(c.reply().status, 0);
  expect_alive();
  catalogue->update();
  EXPECT_EQ(client().ask("/data/large.cuesta").status, 404);
}

TEST_F(HostileClients, at_the_same_time_as_good_ones) {
  start();
  const std::string bytes = bytes_of(folder / "served/sphere.cuesta");
  std::atomic<bool> over{false};
  std::vector<std::thread> attackers;
  for (unsigned seed = 0; seed < 3; ++seed)
    attackers.emplace_back([&, seed] {
      std::mt19937 random(seed);
      while (!over) {
        RawClient c = client(4096);
        c.get("/data/large.cuesta");
        if (random() % 2) c.receive(20);
        if (random() % 2) reset(c);
      }
    });
  std::thread replacer([&] {
    for (int i = 0; !over; ++i) {
      std::filesystem::copy_file(folder / "served/sphere.cuesta", folder / "served/x.new");
      std::filesystem::rename(folder / "served/x.new", folder / "served/x.cuesta");
      catalogue->update();
      std::this_thread::sleep_for(5ms);
    }
  });
  RawClient good = client();
  for (int i = 0; i < 500; ++i) {
    const std::string first = std::to_string(i);
    const Reply r =
        good.ask("/data/sphere.cuesta", "Range: bytes=" + first + "-" + std::to_string(i + 99) + "\r\n");
    ASSERT_EQ(r.status, 206);
    ASSERT_EQ(r.body, bytes.substr(static_cast<std::size_t>(i), 100));
  }
  over = true;
  for (std::thread& t : attackers) t.join();
  replacer.join();
}

}  // namespace
}  // namespace cuesta::test
