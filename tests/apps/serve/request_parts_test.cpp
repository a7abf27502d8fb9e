#include <gtest/gtest.h>

#include <random>

#include "apps/serve/byte_range.h"
#include "apps/serve/conditions.h"
#include "apps/serve/http_date.h"
#include "apps/serve/request.h"
#include "apps/serve/target.h"

namespace cuesta::serve {
namespace {

std::vector<ByteRange> ranges_of(std::string_view header, std::uint64_t bytes, RangeAnswer expected) {
  std::vector<ByteRange> ranges{{1, 1}};
  EXPECT_EQ(parse_ranges(header, bytes, ranges), expected) << header;
  return ranges;
}

TEST(ByteRanges, one_of_each_kind) {
  using R = std::vector<ByteRange>;
  EXPECT_EQ(ranges_of("bytes=0-9", 100, RangeAnswer::partial), (R{{0, 10}}));
  EXPECT_EQ(ranges_of("bytes=90-", 100, RangeAnswer::partial), (R{{90, 10}}));
  EXPECT_EQ(ranges_of("bytes=-7", 100, RangeAnswer::partial), (R{{93, 7}}));
  EXPECT_EQ(ranges_of("bytes=-700", 100, RangeAnswer::partial), (R{{0, 100}}));
  EXPECT_EQ(ranges_of("bytes=95-200", 100, RangeAnswer::partial), (R{{95, 5}}));
  EXPECT_EQ(ranges_of("Bytes= 5-5 ,\t,-1", 100, RangeAnswer::partial), (R{{5, 1}, {99, 1}}));
  EXPECT_EQ(ranges_of("bytes=0-99999999999999999999999", 100, RangeAnswer::partial), (R{{0, 100}}));
  EXPECT_EQ(ranges_of("bytes=100-,3-4", 100, RangeAnswer::partial), (R{{3, 2}}));
}

TEST(ByteRanges, what_is_not_well_formed_counts_as_absent) {
  for (const char* header :
       {"", "bytes", "bytes=", "bytes=,", "bytes=a-b", "bytes=5-4", "bytes=-", "bytes=--1", "lines=1-2",
        "bytes=1-2,x", "bytes=1 -2", "bytes=0x1-2", "bytes=+1-2", "bytes 1-2"})
    EXPECT_TRUE(ranges_of(header, 100, RangeAnswer::whole).empty()) << header;
}

TEST(ByteRanges, what_cannot_be_or_is_too_much_is_refused) {
  for (const char* header :
       {"bytes=100-", "bytes=-0", "bytes=100-200,300-", "bytes=99999999999999999999999-", "bytes=0-,0-"})
    EXPECT_TRUE(ranges_of(header, 100, RangeAnswer::refused).empty()) << header;
  EXPECT_TRUE(ranges_of("bytes=0-", 0, RangeAnswer::refused).empty());
  std::string many = "bytes=0-0";
  for (std::size_t i = 1; i < most_ranges; ++i) many += ",0-0";
  EXPECT_EQ(ranges_of(many, 100, RangeAnswer::partial).size(), most_ranges);
  ranges_of(many + ",0-0", 100, RangeAnswer::refused);
}

TEST(ByteRanges, are_within_the_file_whatever_the_header) {
  std::mt19937 random(7);
  constexpr std::string_view letters = "bytes=0123456789-, \t";
  for (int i = 0; i < 200'000; ++i) {
    std::string header = "bytes=";
    for (auto n = random() % 24; n > 0; --n) header += letters[random() % letters.size()];
    const std::uint64_t bytes = random() % 50;
    std::vector<ByteRange> ranges;
    const RangeAnswer answer = parse_ranges(header, bytes, ranges);
    std::uint64_t total = 0;
    for (const ByteRange& r : ranges) {
      total += r.count;
      ASSERT_TRUE(r.count > 0 && r.first < bytes && r.count <= bytes - r.first) << header << " of " << bytes;
    }
    ASSERT_LE(total, bytes) << header;
    ASSERT_EQ(answer == RangeAnswer::partial, !ranges.empty()) << header;
  }
}

TEST(Targets, are_decoded_once) {
  Target t;
  ASSERT_TRUE(parse_target("/data/a%20b%C3%A9.cuesta?v=1&w=%20", t));
  EXPECT_EQ(t.path, "/data/a b\xC3\xA9.cuesta");
  EXPECT_EQ(query_value(t.query, "w"), "%20");
  EXPECT_EQ(query_value(t.query, "v"), "1");
  EXPECT_FALSE(query_value(t.query, "x"));
  ASSERT_TRUE(parse_target("/a%252e%252e", t));
  EXPECT_EQ(t.path, "/a%2e%2e");
  ASSERT_TRUE(parse_target("http://host:8080/data/x.cuesta", t));
  EXPECT_EQ(t.path, "/data/x.cuesta");
  ASSERT_TRUE(parse_target("http://host", t));
  EXPECT_EQ(t.path, "/");
}

TEST(Targets, that_could_be_places_are_refused) {
  Target t;
  for (const char* text : {"",
                           "*",
                           "data",
                           "/..",
                           "/../x",
                           "/a/../b",
                           "/a/..",
                           "/.",
                           "/a/./b",
                           "/%2e%2e/x",
                           "/%2E./x",
                           "/a%2f..%2fb",
                           "//x",
                           "/a//b",
                           "/a\\b",
                           "/a%5cb",
                           "/a%00b",
                           "/a%0ab",
                           "/a%",
                           "/a%2",
                           "/a%zz",
                           "/a%7fb",
                           "file:///etc/passwd"})
    EXPECT_FALSE(parse_target(text, t)) << text;
}

TEST(Targets, have_plain_segments_whatever_the_bytes) {
  std::mt19937 random(11);
  constexpr std::string_view letters = "/.%2efF5cC0ab\\?";
  Target t;
  for (int i = 0; i < 300'000; ++i) {
    std::string text = "/";
    for (auto n = random() % 16; n > 0; --n) text += letters[random() % letters.size()];
    if (!parse_target(text, t)) continue;
    ASSERT_EQ(t.path.find('\\'), t.path.npos) << text;
    ASSERT_EQ(t.path.find('\0'), t.path.npos) << text;
    const std::string closed = t.path + '/';
    for (const char* bad : {"/./", "/../"}) ASSERT_EQ(closed.find(bad), closed.npos) << text;
  }
}

TEST(Targets, escaped_paths_come_back) {
  Target t;
  const std::string name = "/a b/\xC3\xA9%?#&<\"'+";
  ASSERT_TRUE(parse_target(escaped_path(name), t));
  EXPECT_EQ(t.path, name);
  EXPECT_EQ(t.query, "");
}

TEST(HttpDates, all_three_forms) {
  EXPECT_EQ(http_date(784111777), "Sun, 06 Nov 1994 08:49:37 GMT");
  EXPECT_EQ(parse_http_date("Sun, 06 Nov 1994 08:49:37 GMT"), 784111777);
  EXPECT_EQ(parse_http_date("Sunday, 06-Nov-94 08:49:37 GMT"), 784111777);
  EXPECT_EQ(parse_http_date("Sun Nov  6 08:49:37 1994"), 784111777);
  for (std::int64_t t :
       {std::int64_t{0}, std::int64_t{951782400}, std::int64_t{4102444799}, std::int64_t{-1}})
    EXPECT_EQ(parse_http_date(http_date(t)), t);
  for (const char* text :
       {"", "now", "Sun, 31 Feb 1994 08:49:37 GMT", "Sun, 06 Nov 1994 24:49:37 GMT",
        "Sun, 06 Nov 1994 08:49:37", "Sun, 06 Nov 1994 08:49:37 GMT ", "Xyz, 06 Nov 1994 08:49:37 GMT"})
    EXPECT_FALSE(parse_http_date(text)) << text;
}

TEST(Preconditions, in_the_order_of_the_standard) {
  const Validators now{"\"a-1\"", 784111777};
  const auto check = [&](auto set) {
    Request r;
    set(r);
    return check_preconditions(r, now);
  };
  constexpr auto before = "Sun, 06 Nov 1994 08:49:36 GMT", same = "Sun, 06 Nov 1994 08:49:37 GMT";
  EXPECT_EQ(check([](Request&) {}), Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_match = "\"x\", \"a-1\""; }), Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_match = "*"; }), Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_match = "\"x\""; }), Precondition::failed);
  EXPECT_EQ(check([](Request& r) { r.if_match = "W/\"a-1\""; }), Precondition::failed);
  EXPECT_EQ(check([](Request& r) { r.if_match = "a-1"; }), Precondition::failed);
  EXPECT_EQ(check([](Request& r) { r.if_none_match = "\"x\",W/\"a-1\""; }), Precondition::not_modified);
  EXPECT_EQ(check([](Request& r) {
              r.if_none_match = "\"x\"";
              r.if_modified_since = same;
            }),
            Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_modified_since = same; }), Precondition::not_modified);
  EXPECT_EQ(check([](Request& r) { r.if_modified_since = before; }), Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_modified_since = "yesterday"; }), Precondition::holds);
  EXPECT_EQ(check([](Request& r) { r.if_unmodified_since = before; }), Precondition::failed);
  EXPECT_EQ(check([](Request& r) { r.if_unmodified_since = same; }), Precondition::holds);
  EXPECT_EQ(check([](Request& r) {
              r.if_match = "\"a-1\"";
              r.if_unmodified_since = before;
            }),
            Precondition::holds);
  const auto counts = [&](const char* if_range) {
    Request r;
    r.if_range = if_range;
    return range_counts(r, now);
  };
  EXPECT_TRUE(counts("\"a-1\"") && counts(same));
  EXPECT_FALSE(counts("W/\"a-1\"") || counts("\"x\"") || counts(before) || counts("") || counts("x"));
}

int parsed(std::string_view head, Request& request) {
  std::size_t scanned = 0;
  EXPECT_EQ(head_length(head, scanned), head.size());
  return parse_request(head, request);
}

TEST(Requests, headers_that_matter_are_there) {
  Request r;
  ASSERT_EQ(
      parsed(
          "GET /x?y HTTP/1.1\r\nHost: h\r\nX-Other: 1\r\nRANGE:  bytes=0-1 \r\nIf-None-Match: \"e\"\r\n\r\n",
          r),
      0);
  EXPECT_EQ(r.method, Method::get);
  EXPECT_EQ(r.target, "/x?y");
  EXPECT_EQ(r.range, "bytes=0-1");
  EXPECT_EQ(r.if_none_match, "\"e\"");
  EXPECT_EQ(r.if_match.data(), nullptr);
  EXPECT_TRUE(r.keep_alive && !r.has_body && !r.is_http_1_0 && !r.upgrades_to_websocket);
  ASSERT_EQ(parsed("HEAD / HTTP/1.0\r\n\r\n", r), 0);
  EXPECT_TRUE(r.method == Method::head && r.is_http_1_0 && !r.keep_alive);
  ASSERT_EQ(parsed("GET / HTTP/1.1\r\nHost: h\r\nConnection: close\r\n\r\n", r), 0);
  EXPECT_FALSE(r.keep_alive);
  ASSERT_EQ(parsed("POST / HTTP/1.1\r\nHost: h\r\nContent-Length: 3\r\n\r\n", r), 0);
  EXPECT_TRUE(r.has_body && r.method == Method::other);
  ASSERT_EQ(parsed("GET / HTTP/1.1\r\nHost: h\r\nTransfer-Encoding: chunked\r\n\r\n", r), 0);
  EXPECT_TRUE(r.has_body);
  ASSERT_EQ(parsed("GET /s HTTP/1.1\r\nHost: h\r\nConnection: Upgrade\r\nUpgrade: websocket\r\n\r\n", r), 0);
  EXPECT_TRUE(r.upgrades_to_websocket);
}

TEST(Requests, that_are_not_well_formed_are_refused) {
  Request r;
  for (const char* head : {"\r\n\r\n", "GET\r\n\r\n", "GET /\r\n\r\n", "GET / HTTP/1.1\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost h\r\n\r\n", "GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nRange: a\r\nRange: b\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nRange: bytes=0-\r\n 1\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nContent-Length: -1\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: h\r\nContent-Length: 1\r\nContent-Length: 2\r\n\r\n",
                           "G\tET / HTTP/1.1\r\nHost: h\r\n\r\n", "GET / HTTP/1.1\r\nHo st: h\r\n\r\n",
                           "GET / HTTP/1.1\r\nHost: h\x01\r\n\r\n"})
    EXPECT_EQ(parsed(head, r), 400) << head;
  EXPECT_EQ(parsed("GET / HTTP/2.0\r\nHost: h\r\n\r\n", r), 505);
}

TEST(Requests, the_end_of_a_head_is_found_however_it_comes) {
  const std::string head = "GET / HTTP/1.1\r\nHost: h\r\n\r\n", bytes = head + "GET";
  for (std::size_t cut = 0; cut < head.size(); ++cut) {
    std::size_t scanned = 0;
    EXPECT_EQ(head_length(std::string_view(bytes).substr(0, cut), scanned), 0u);
    EXPECT_EQ(head_length(bytes, scanned), head.size());
  }
}

}  // namespace
}  // namespace cuesta::serve
