/// Sessions without sockets: what a thin client has is what the server's cut draws, whatever the link.

#include "apps/serve/session.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>

#include "tests/runtime/open_file.h"

namespace cuesta::serve {
namespace {

using test::TemporaryFolder;
using Triangle = std::array<std::array<std::int32_t, 9>, 3>;

std::array<std::int32_t, 9> numbers(const DrawVertex& v) {
  return {v.x, v.y, v.z, v.normal_u, v.normal_v, v.colour[0], v.colour[1], v.colour[2], v.colour[3]};
}

std::vector<Triangle> triangles_of(const DrawList& list) {
  std::vector<Triangle> all;
  for (const Range& r : list.draws)
    for (std::uint32_t i = r.first; i < r.first + r.count; i += 3)
      all.push_back({numbers(list.vertices[list.indices[i]]), numbers(list.vertices[list.indices[i + 1]]),
                     numbers(list.vertices[list.indices[i + 2]])});
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<Triangle> triangles_of(const SessionMesh& mesh) {
  std::vector<Triangle> all;
  for (const auto& t : mesh.triangles())
    if (t[0] != no_vertex)
      all.push_back(
          {numbers(mesh.vertices()[t[0]]), numbers(mesh.vertices()[t[1]]), numbers(mesh.vertices()[t[2]])});
  std::sort(all.begin(), all.end());
  return all;
}

/// A link of a bandwidth and a delay, a session at one end and a thin client at the other, in a time of their
/// own.
class Line {
 public:
  Line(const std::filesystem::path& path, double bytes_per_second, double delay_ms, SessionLimits limits = {},
       std::shared_ptr<PageShelf> shelf = nullptr)
      : bytes_per_ms_(bytes_per_second / 1000), delay_ms_(delay_ms) {
    auto file = CuestaFile::open(path);
    EXPECT_TRUE(file);
    file->set_shelf(std::move(shelf));
    limits.adapt_ms = std::numeric_limits<double>::infinity();
    auto opened = Session::open(std::move(*file), limits, [this] { return now_ms_; });
    EXPECT_TRUE(opened) << opened.error().text();
    session = std::move(*opened);
    const auto welcome = decode_welcome(bytes_of(session->welcome()));
    EXPECT_TRUE(welcome);
    mesh = std::make_unique<SessionMesh>(welcome->has_normals, welcome->has_colours);
  }
  void tell(const Hello& hello) { ASSERT_TRUE(session->receive(bytes_of(encode(hello)))); }
  void look(const View& view) { ASSERT_TRUE(session->receive(bytes_of(encode(view)))); }

  void run(double ms) {
    const double end = now_ms_ + ms;
    for (; now_ms_ < end; now_ms_ += 1) {
      if (auto message = session->step()) send(std::move(*message));
      while (!flying_.empty() && flying_.front().arrives_ms <= now_ms_) {
        const auto head = mesh->apply(bytes_of(flying_.front().message));
        ASSERT_TRUE(head) << head.error().text();
        last = *head;
        received_bytes += flying_.front().message.size();
        acks_.push_back({now_ms_ + delay_ms_, encode(Ack{head->sequence})});
        flying_.pop_front();
        ++messages;
      }
      while (!acks_.empty() && acks_.front().arrives_ms <= now_ms_) {
        ASSERT_TRUE(session->receive(bytes_of(acks_.front().message)));
        acks_.pop_front();
      }
    }
  }
  bool settle(double most_ms) {
    for (double ms = 0; ms < most_ms; ms += 100) {
      run(100);
      if (last.settled && flying_.empty() && std::isinf(session->wait_ms())) return true;
    }
    return false;
  }
  /// What the session's own cut draws now.
  std::vector<Triangle> drawn() { return triangles_of(const_cast<Cut&>(session->cut()).draw_list()); }

  std::unique_ptr<Session> session;
  std::unique_ptr<SessionMesh> mesh;
  ChangeHead last;
  std::uint64_t received_bytes = 0;
  int messages = 0;

 private:
  struct Flying {
    double arrives_ms;
    std::string message;
  };
  void send(std::string message) {
    free_ms_ = std::max(free_ms_, now_ms_) + static_cast<double>(message.size()) / bytes_per_ms_;
    flying_.push_back({free_ms_ + delay_ms_, std::move(message)});
  }
  double bytes_per_ms_, delay_ms_, now_ms_ = 0, free_ms_ = 0;
  std::deque<Flying> flying_, acks_;
};

class SessionTest : public testing::Test {
 protected:
  void SetUp() override { test::build_file(test::bumpy_sphere(96), path = folder / "sphere.cuesta"); }
  View view_at(int i) {
    std::mt19937 random(static_cast<unsigned>(i));
    return test::random_view(CuestaFile::open(path)->directory(), random);
  }
  TemporaryFolder folder;
  std::filesystem::path path;
};

TEST_F(SessionTest, a_client_has_what_the_cut_draws) {
  Line line(path, 1e7, 5);
  line.tell({});
  for (int i = 0; i < 12; ++i) {
    line.look(view_at(i));
    line.run(100 + 40 * (i % 4));
    if (i % 3 != 2) continue;
    ASSERT_TRUE(line.settle(60'000)) << i;
    EXPECT_EQ(triangles_of(*line.mesh), line.drawn()) << i;
    EXPECT_EQ(line.mesh->triangle_count(), line.last.triangles);
    EXPECT_LE(line.last.achieved_px, 1.0001F);
  }
}

TEST_F(SessionTest, only_what_changes_is_sent) {
  Line line(path, 1e7, 5);
  line.tell({});
  line.look(view_at(1));
  ASSERT_TRUE(line.settle(60'000));
  const auto first = line.received_bytes;
  const int messages = line.messages;
  line.look(view_at(1));
  ASSERT_TRUE(line.settle(60'000));
  EXPECT_LT(line.received_bytes - first, 100u);
  line.run(5'000);
  EXPECT_LE(line.messages, messages + 1);
  View moved = view_at(1);
  moved.eye = moved.eye + (moved.target - moved.eye) * 0.01;
  line.look(moved);
  ASSERT_TRUE(line.settle(60'000));
  EXPECT_LT(line.received_bytes - first, first / 5);
}

TEST_F(SessionTest, budgets_of_the_client_hold) {
  Line line(path, 1e7, 5);
  Hello hello;
  hello.triangles = 3000;
  line.tell(hello);
  line.look(view_at(3));
  ASSERT_TRUE(line.settle(60'000));
  EXPECT_LE(line.mesh->triangle_count(), 3000u);
  EXPECT_GT(line.mesh->triangle_count(), 2000u);
  hello.triangles = 800;
  line.tell(hello);
  ASSERT_TRUE(line.settle(60'000));
  EXPECT_LE(line.mesh->triangle_count(), 800u);
}

TEST_F(SessionTest, memory_stays_within_what_is_set_aside_for_it) {
  const auto directory = CuestaFile::open(path)->directory();
  for (const std::uint64_t cache_bytes : {2u << 20, 4u << 20, 8u << 20}) {
    SessionLimits limits;
    limits.cache_bytes = cache_bytes;
    limits.pages_per_step = 100;
    Line line(path, 1e8, 1, limits);
    Hello hello;
    hello.triangles = 1'000'000;
    hello.tau_px = 0.01F;
    line.tell(hello);
    for (int i = 0; i < 20; ++i) {
      line.look(view_at(i));
      line.run(200);
      ASSERT_LE(line.session->bytes(), Session::most_bytes(directory, limits)) << i;
    }
    EXPECT_GT(line.session->bytes(), Session::most_bytes(directory, limits) / 4);
  }
}

TEST_F(SessionTest, bytes_per_second_are_held) {
  Line line(path, 1e7, 5);
  Hello hello;
  hello.bytes_per_second = 20'000;
  line.tell(hello);
  for (int i = 0; i < 20; ++i) {
    line.look(view_at(i));
    line.run(500);
  }
  EXPECT_LE(line.session->sent_bytes(), 20'000 * 10.5 + 5'000);
  EXPECT_GE(line.session->sent_bytes(), 20'000 * 5u);
}

TEST_F(SessionTest, a_slow_link_is_found_out_and_not_flooded) {
  for (const double bytes_per_second : {10'000.0, 100'000.0, 1'000'000.0}) {
    Line line(path, bytes_per_second, 40);
    line.tell({});
    for (int i = 0; i < 40; ++i) {
      line.look(view_at(i));
      line.run(250);
    }
    // What is under way takes the link about a second, so a new camera is answered within about that time;
    // how long a message becomes is not known to the byte before it is made.
    EXPECT_LE(line.session->link().under_way_bytes(), std::max(bytes_per_second, 10'000.0) * 1.1)
        << bytes_per_second;
    // The link is used, as far as there is something to send.
    const double least = bytes_per_second < 500'000 ? bytes_per_second * 10 * 0.5 : 0;
    EXPECT_GE(static_cast<double>(line.received_bytes), least) << bytes_per_second;
  }
}

TEST_F(SessionTest, sessions_share_decoded_pages) {
  const auto shelf = std::make_shared<PageShelf>(1 << 28);
  Line first(path, 1e7, 5, {}, shelf), second(path, 1e7, 5, {}, shelf);
  for (Line* line : {&first, &second}) {
    line->tell({});
    line->look(view_at(5));
    ASSERT_TRUE(line->settle(60'000));
  }
  EXPECT_EQ(triangles_of(*first.mesh), triangles_of(*second.mesh));
  EXPECT_GE(shelf->counts().hits, shelf->counts().reads);
  EXPECT_EQ(shelf->counts().reads, first.session->cut().cache().counters().loads);
}

TEST(PageShelves, forget_the_oldest_and_no_error) {
  PageShelf shelf(3 * (sizeof(Page) + 1200));
  int reads = 0;
  const auto read = [&]() -> Result<std::shared_ptr<const Page>> {
    ++reads;
    Page page;
    page.triangles.resize(100);
    return std::make_shared<const Page>(std::move(page));
  };
  for (const PageId id : {1u, 2u, 3u, 1u, 4u, 1u, 3u}) ASSERT_TRUE(shelf.take(id, read));
  EXPECT_EQ(reads, 4);
  ASSERT_TRUE(shelf.take(2, read));
  EXPECT_EQ(reads, 5);
  const auto fails = []() -> Result<std::shared_ptr<const Page>> { return fail(ErrorCode::io, "", "", ""); };
  EXPECT_FALSE(shelf.take(9, fails));
  EXPECT_TRUE(shelf.take(9, read));
}

TEST_F(SessionTest, what_a_client_may_not_say_ends_it) {
  const auto refused = [&](std::string message) {
    Line line(path, 1e7, 5);
    line.tell({});
    return line.session->receive(bytes_of(message)).error().code;
  };
  View view = view_at(0);
  Line mute(path, 1e7, 5);
  EXPECT_EQ(mute.session->receive(bytes_of(encode(view))).error().code, ErrorCode::invalid_input);
  Hello hello;
  hello.version = 2;
  EXPECT_EQ(refused(encode(hello)), ErrorCode::unsupported_version);
  hello = {};
  hello.tau_px = std::nanf("");
  EXPECT_EQ(refused(encode(hello)), ErrorCode::invalid_input);
  EXPECT_EQ(refused(encode(View{view.eye, view.eye})), ErrorCode::invalid_input);
  view.up = view.target - view.eye;
  EXPECT_EQ(refused(encode(view)), ErrorCode::invalid_input);
  view = view_at(0);
  view.eye.x = std::numeric_limits<double>::infinity();
  EXPECT_EQ(refused(encode(view)), ErrorCode::invalid_input);
  EXPECT_EQ(refused(""), ErrorCode::corrupt);
  EXPECT_EQ(refused("\x03"), ErrorCode::corrupt);
  EXPECT_EQ(refused(encode(Ack{1}) + "x"), ErrorCode::corrupt);
}

TEST_F(SessionTest, random_messages_never_break_it) {
  Line line(path, 1e7, 5);
  line.tell({});
  std::mt19937 random(5);
  const std::vector<std::string> valid{encode(Hello{}), encode(view_at(2)), encode(Ack{3})};
  for (int i = 0; i < 3000; ++i) {
    std::string message = valid[random() % valid.size()];
    for (auto n = random() % 4; n > 0; --n) message[random() % message.size()] = static_cast<char>(random());
    const auto received = line.session->receive(bytes_of(message));
    const auto change = received && i % 10 == 0 ? line.session->step() : std::nullopt;
    if (change) {
      ASSERT_TRUE(line.mesh->apply(bytes_of(*change)));
    }
  }
}

TEST_F(SessionTest, a_damaged_change_is_refused_or_harmless) {
  Line line(path, 1e7, 5);
  line.tell({});
  line.look(view_at(2));
  std::optional<std::string> change = line.session->step();
  ASSERT_TRUE(change);
  std::mt19937 random(9);
  for (int i = 0; i < 20'000; ++i) {
    std::string bytes = *change;
    for (auto n = 1 + random() % 4; n > 0; --n) bytes[random() % bytes.size()] = static_cast<char>(random());
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    SessionMesh mesh(true, false);
    if (!mesh.apply(bytes_of(bytes))) continue;
    for (const auto& t : mesh.triangles())
      for (const std::uint32_t v : t) ASSERT_TRUE(v == no_vertex || v < mesh.vertices().size());
  }
}

TEST(LinkRates, converge_to_the_link) {
  LinkRate link(66);
  double now = 0, free = 0;
  for (std::uint32_t i = 1; i < 200; ++i) {
    const double bytes = std::max(link.window_bytes() / 2, 1000.0);
    link.sent(i, static_cast<std::uint64_t>(bytes), now);
    free = std::max(free, now) + bytes / 50;  // 50,000 bytes per second
    now = free + 30;
    link.acknowledged(i, now);
  }
  EXPECT_GT(link.bytes_per_second(), 20'000);
  EXPECT_LT(link.bytes_per_second(), 75'000);
  EXPECT_EQ(link.under_way_bytes(), 0);
  const double window = link.window_bytes();
  link.acknowledged(7777, now + 1);
  link.acknowledged(3, now + 1);
  EXPECT_EQ(link.window_bytes(), window);
}

}  // namespace
}  // namespace cuesta::serve
