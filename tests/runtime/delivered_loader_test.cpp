/// Pages that are brought from outside: asked for once, never waited for, and in the end the same cut.

#include "runtime/delivered_loader.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/runtime/open_file.h"

namespace cuesta::test {
namespace {

std::vector<std::byte> bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

/// A host with the file, and a cut that has only what it was sent.
struct Remote {
  std::vector<std::byte> all;
  std::shared_ptr<DeliveredBytes> bytes;
  DeliveredLoader* loader = nullptr;
  std::unique_ptr<Cut> cut;
  std::vector<ByteRange> sent;

  explicit Remote(const std::filesystem::path& path)
      : all(bytes_of(path)), bytes(std::make_shared<DeliveredBytes>("http://host/a.cuesta", all.size())) {}

  std::vector<std::byte> range(ByteRange r) const {
    return {all.begin() + static_cast<std::ptrdiff_t>(r.offset),
            all.begin() + static_cast<std::ptrdiff_t>(r.offset + r.bytes)};
  }
  void send(ByteRange r) {
    sent.push_back(r);
    bytes->deliver(r.offset, range(r));
  }
  Result<void> open() {
    auto file = CuestaFile::open(bytes);
    while (!file && bytes->missing()) {
      send(*bytes->missing());
      file = CuestaFile::open(bytes);
    }
    if (!file) return fail(file.error());
    const BlockRef base = file->directory().pages[file->directory().base()].block;
    send({base.offset, base.bytes});
    auto opened = Cut::open(
        std::move(*file), unlimited, [] { return 0.0; },
        [this](const CuestaFile& f, GeometryPool& pool) {
          auto made = std::make_unique<DeliveredLoader>(f, pool, *bytes);
          loader = made.get();
          return made;
        });
    if (!opened) return fail(opened.error());
    bytes->forget();
    cut = std::move(*opened);
    return {};
  }
  std::vector<std::byte> stored(PageId id) const {
    const BlockRef& block = cut->directory().pages[id].block;
    return range({block.offset, block.bytes});
  }
};

std::vector<std::uint32_t> drawn_indices(Cut& cut) {
  const DrawList list = cut.draw_list();
  std::vector<std::uint32_t> corners;
  for (const Range& r : list.draws)
    for (std::uint32_t i = r.first; i < r.first + r.count; ++i) {
      const DrawVertex& v = list.vertices[list.indices[i]];
      corners.push_back(static_cast<std::uint32_t>(v.x) * 73856093u ^
                        static_cast<std::uint32_t>(v.y) * 19349663u ^
                        static_cast<std::uint32_t>(v.z) * 83492791u);
    }
  std::sort(corners.begin(), corners.end());
  return corners;
}

class DeliveredPages : public testing::Test {
 protected:
  DeliveredPages() { build_file(bumpy_sphere(40), folder_ / "a.cuesta"); }
  TemporaryFolder folder_;
};

TEST_F(DeliveredPages, opens_with_header_directory_and_base_page_alone) {
  Remote remote(folder_ / "a.cuesta");
  ASSERT_TRUE(remote.open());
  ASSERT_EQ(remote.sent.size(), 3u);
  EXPECT_EQ(remote.sent[0], (ByteRange{0, 64}));
  EXPECT_EQ(remote.sent[1].offset + remote.sent[1].bytes, remote.all.size());
  EXPECT_EQ(remote.cut->cache().resident_ids().size(), 1u);
}

TEST_F(DeliveredPages, nothing_waits_and_the_end_is_the_cut_of_a_local_file) {
  Remote remote(folder_ / "a.cuesta");
  ASSERT_TRUE(remote.open());
  const auto scale = ErrorScale::uniform(remote.cut->directory().grid);
  std::deque<PageId> asked;
  AdaptReport report;
  std::uint64_t coarser = 0;
  for (int frame = 0; frame < 10'000 && !report.settled; ++frame) {
    report = remote.cut->adapt(scale, 0, {});
    coarser += report.pages_missing > 0;
    for (const PageId id : remote.loader->take_asked()) asked.push_back(id);
    ASSERT_LE(asked.size(), DeliveredLoader::usual_width);
    if (frame % 3 != 0 || asked.empty()) continue;
    ASSERT_TRUE(
        remote.loader->bring(asked.back(), remote.stored(asked.back())));  // in another order than asked
    asked.pop_back();
  }
  EXPECT_TRUE(report.settled);
  EXPECT_GT(coarser, 0u);
  const auto local = open_cut(folder_ / "a.cuesta");
  local->settle(ErrorScale::uniform(local->directory().grid), 0, {});
  EXPECT_EQ(drawn_indices(*remote.cut), drawn_indices(*local));
}

TEST_F(DeliveredPages, damaged_and_lost_pages_cost_quality) {
  Remote remote(folder_ / "a.cuesta");
  ASSERT_TRUE(remote.open());
  const auto scale = ErrorScale::uniform(remote.cut->directory().grid);
  std::vector<PageId> asked;
  for (int frame = 0; frame < 10 && asked.size() < 2; ++frame) {
    remote.cut->adapt(scale, 0, {});
    for (const PageId id : remote.loader->take_asked()) asked.push_back(id);
  }
  ASSERT_GE(asked.size(), 2u);
  auto damaged = remote.stored(asked[0]);
  damaged[damaged.size() / 2] ^= std::byte{1};
  EXPECT_TRUE(remote.loader->bring(asked[0], damaged));
  EXPECT_TRUE(remote.loader->give_up(asked[1], {ErrorCode::io, "", "page", "the host is gone"}));
  EXPECT_FALSE(remote.loader->bring(asked[0], remote.stored(asked[0]))) << "it was brought";
  const auto report = remote.cut->adapt(scale, 0, {});
  EXPECT_GT(report.triangles, 0u);
  ASSERT_EQ(remote.cut->cache().errors().size(), 2u);
  EXPECT_EQ(remote.cut->cache().errors()[0].code, ErrorCode::corrupt);
  EXPECT_EQ(remote.cut->cache().errors()[1].message, "the host is gone");
}

TEST_F(DeliveredPages, another_file_is_refused_with_its_address) {
  Remote remote(folder_ / "a.cuesta");
  remote.all[0] = std::byte{'X'};
  const auto refused = remote.open();
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
  EXPECT_EQ(refused.error().file, "http://host/a.cuesta");
}

}  // namespace
}  // namespace cuesta::test
