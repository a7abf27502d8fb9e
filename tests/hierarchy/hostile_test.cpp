/// Pages, directories and containers from hostile bytes: an error or a valid object, never a crash.

#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "hierarchy/page_codec.h"
#include "hierarchy/verify_file.h"
#include "ooc/byte_stream.h"
#include "tests/hierarchy/rewritten_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

using Bytes = std::vector<std::byte>;

bool same(const Page& a, const Page& b) {
  return encode_page(a) == encode_page(b);
}

void flip(Bytes& bytes, std::size_t at, int bit) {
  bytes[at] ^= static_cast<std::byte>(1 << bit);
}

class Hostile : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    SurfaceMesh surface;
    for (const NamedSurface& s : surfaces())
      if (s.name == std::string(GetParam())) surface = s.make();
    build_file(std::move(surface), folder_ / "a.cuesta");
    good_ = contents_of(folder_ / "a.cuesta");
    ASSERT_FALSE(good_.pages.empty());
  }
  TemporaryFolder folder_;
  Contents good_;
};

TEST_P(Hostile, page_round_trip) {
  for (const Page& page : good_.pages) {
    const Bytes bytes = encode_page(page);
    const auto again = decode_page(bytes, page.survivors);
    ASSERT_TRUE(again) << again.error().text();
    EXPECT_TRUE(same(page, *again));
    EXPECT_EQ(again->triangles, page.triangles);
    EXPECT_EQ(again->owned.positions, page.owned.positions);
    EXPECT_EQ(again->owned.normals, page.owned.normals);
    EXPECT_EQ(again->owned.colours, page.owned.colours);
    EXPECT_EQ(again->owned.texcoords, page.owned.texcoords);
    EXPECT_EQ(again->orphans, page.orphans);
    ASSERT_EQ(again->script.fans.size(), page.script.fans.size());
    for (std::size_t f = 0; f < page.script.fans.size(); ++f)
      EXPECT_EQ(again->script.fans[f].sphere, page.script.fans[f].sphere) << "fan " << f;
  }
}

TEST_P(Hostile, a_page_wants_all_of_its_survivors) {
  for (const Page& page : good_.pages) {
    const Bytes bytes = encode_page(page);
    std::vector<Vec3i> places = page.survivors;
    places.push_back({});
    EXPECT_FALSE(decode_page(bytes, places));
    places.resize(places.size() - std::min<std::size_t>(2, places.size()));
    if (!page.survivors.empty()) {
      EXPECT_FALSE(decode_page(bytes, places));
    }
  }
}

TEST_P(Hostile, page_cut_off_at_every_byte) {
  const Bytes bytes = encode_page(good_.pages.front());
  for (std::size_t n = 0; n < bytes.size(); ++n)
    EXPECT_FALSE(decode_page(std::span(bytes).first(n), good_.pages.front().survivors))
        << n << " of " << bytes.size() << " bytes";
}

/// `page` encoded, with the raw bytes of one stream's first plane replaced.
Bytes with_stream(const Page& page, PageStream which, std::span<const std::byte> raw) {
  PageStreamBytes spent{};
  const Bytes bytes = encode_page(page, &spent);
  std::size_t before = 2 + 8 * 4;
  for (std::size_t s = 0; s < static_cast<std::size_t>(which); ++s) before += spent[s];
  ByteReader in{std::span<const std::byte>(bytes).subspan(before)};
  in.get_varint();
  in.get_bytes(in.get_varint());
  ByteWriter out;
  out.put_bytes(std::span(bytes).first(before));
  out.put_varint(raw.size());
  out.put_varint(raw.size());
  out.put_bytes(raw);
  out.put_bytes(std::span(bytes).subspan(before + in.position()));
  return out.take();
}

// Ascending numbers are stored as gaps: a sum that wraps around is not ascending.
TEST_P(Hostile, gaps_that_wrap_around_are_refused) {
  for (const PageStream stream : {PageStream::wedge_tails, PageStream::orphans}) {
    ByteWriter gaps;
    gaps.put_varint(2);
    gaps.put_varint(1);
    gaps.put_varint(~std::uint64_t{0} - 1);
    EXPECT_FALSE(
        decode_page(with_stream(good_.pages.front(), stream, gaps.bytes()), good_.pages.front().survivors));
  }
}

// Every byte value in every place of the streams whose numbers are checked one by one.
TEST_P(Hostile, classes_and_steps_of_any_value) {
  const Page& page = good_.pages.front();
  for (const PageStream stream : {PageStream::triangles, PageStream::positions, PageStream::normals,
                                  PageStream::fan_centres, PageStream::fan_sizes, PageStream::fan_spheres,
                                  PageStream::child_vertices, PageStream::child_errors}) {
    const std::size_t count = stream == PageStream::triangles       ? page.triangles.size()
                              : stream <= PageStream::normals       ? page.owned.positions.size()
                              : stream < PageStream::child_vertices ? page.script.fans.size()
                                                                    : page.script.children.size();
    for (int value = 0; value < 256; ++value)
      if (const auto got = decode_page(with_stream(page, stream, Bytes(count, static_cast<std::byte>(value))),
                                       page.survivors))
        encode_page(*got);
  }
}

TEST_P(Hostile, bytes_per_stream_add_up) {
  for (const Page& page : good_.pages) {
    PageStreamBytes spent{};
    const Bytes bytes = encode_page(page, &spent);
    const auto again = bytes_per_stream(bytes);
    ASSERT_TRUE(again);
    EXPECT_EQ(*again, spent);
    EXPECT_EQ(std::accumulate(spent.begin(), spent.end(), std::uint64_t{2 + 8 * 4}), bytes.size());
    for (std::size_t n = 0; n < bytes.size(); ++n)
      EXPECT_FALSE(bytes_per_stream(std::span(bytes).first(n))) << n;
  }
}

TEST_P(Hostile, page_with_a_flipped_bit) {
  constexpr std::size_t header = 30;
  for (const Page& page : {good_.pages.front(), good_.pages.back()}) {
    Bytes bytes = encode_page(page);
    const std::size_t step = bytes.size() / 1500 + 1;
    for (std::size_t at = 0; at < bytes.size(); at += at < header ? 1 : step)
      for (int bit = 0; bit < 8; ++bit) {
        flip(bytes, at, bit);
        if (const auto got = decode_page(bytes, page.survivors)) encode_page(*got);
        flip(bytes, at, bit);
      }
  }
}

/// Checksums are right, contents are not: the replay must survive what the decoder lets through.
TEST_P(Hostile, flipped_pages_are_replayed_without_a_crash) {
  std::mt19937 random(1);
  const std::size_t victim = good_.pages.size() / 2;
  const Bytes bytes = encode_page(good_.pages[victim]);
  for (int i = 0; i < 200; ++i) {
    Bytes flipped = bytes;
    flip(flipped, 30 + random() % (bytes.size() - 30), static_cast<int>(random() % 8));
    auto page = decode_page(flipped, good_.pages[victim].survivors);
    if (!page || page->vertex_count != good_.pages[victim].vertex_count) continue;
    Contents contents = good_;
    contents.pages[victim] = std::move(*page);
    write_contents(contents, folder_ / "flipped.cuesta");
    const auto file = CuestaFile::open(folder_ / "flipped.cuesta");
    ASSERT_TRUE(file);
    EXPECT_TRUE(verify_file(*file));
  }
}

TEST_P(Hostile, directory_round_trip_cut_off_and_flipped) {
  Bytes bytes = encode_directory(good_.directory);
  const auto again = decode_directory(bytes);
  ASSERT_TRUE(again);
  EXPECT_EQ(encode_directory(*again), bytes);
  for (std::size_t n = 0; n < bytes.size(); ++n) EXPECT_FALSE(decode_directory(std::span(bytes).first(n)));
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; ++bit) {
      flip(bytes, at, bit);
      if (const auto got = decode_directory(bytes)) encode_directory(*got);
      flip(bytes, at, bit);
    }
}

INSTANTIATE_TEST_SUITE_P(of, Hostile, testing::Values("sphere", "cube", "vase", "triangle"),
                         [](const auto& s) { return std::string(s.param); });

class Container : public testing::Test {
 protected:
  void SetUp() override {
    build_file(bumpy_sphere(6), folder_ / "a.cuesta");
    bytes_ = bytes_of(folder_ / "a.cuesta");
  }
  ErrorCode code_of(const std::string& bytes) {
    put_bytes(folder_ / "b.cuesta", bytes);
    const auto file = CuestaFile::open(folder_ / "b.cuesta");
    EXPECT_FALSE(file);
    return file ? ErrorCode::io : file.error().code;
  }
  TemporaryFolder folder_;
  std::string bytes_;
};

TEST_F(Container, cut_off_at_every_byte) {
  for (std::size_t n = 0; n < bytes_.size(); n += n < 200 ? 1 : 37)
    EXPECT_EQ(code_of(bytes_.substr(0, n)), ErrorCode::corrupt);
}

TEST_F(Container, appended_to) {
  EXPECT_EQ(code_of(bytes_ + "x"), ErrorCode::corrupt);
}

TEST_F(Container, every_bit_of_the_header) {
  for (std::size_t at = 0; at < 64; ++at)
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = bytes_;
      bad[at] = static_cast<char>(bad[at] ^ (1 << bit));
      EXPECT_EQ(code_of(bad), at >= 8 && at < 12 ? ErrorCode::unsupported_version : ErrorCode::corrupt) << at;
    }
}

TEST_F(Container, another_file_a_folder_and_nothing) {
  EXPECT_EQ(code_of("ply\nformat ascii 1.0\n"), ErrorCode::corrupt);
  EXPECT_EQ(code_of(""), ErrorCode::corrupt);
  EXPECT_EQ(CuestaFile::open(folder_ / "missing.cuesta").error().code, ErrorCode::not_found);
  EXPECT_EQ(CuestaFile::open(folder_ / "").error().code, ErrorCode::invalid_input);
}

TEST_F(Container, blocks_are_aligned_and_checked) {
  const auto file = CuestaFile::open(folder_ / "a.cuesta");
  ASSERT_TRUE(file);
  for (const PageEntry& e : file->directory().pages) EXPECT_EQ(e.block.offset % container_alignment, 0u);
  const auto reader = ContainerReader::open(folder_ / "a.cuesta", ContainerKind::surface);
  BlockRef beyond = file->directory().pages[0].block;
  beyond.bytes = ~std::uint64_t{0};
  EXPECT_EQ(reader->read(beyond).error().code, ErrorCode::corrupt);
  beyond.offset = ~std::uint64_t{0};
  EXPECT_EQ(reader->read(beyond).error().code, ErrorCode::corrupt);
}

}  // namespace
}  // namespace cuesta::test
