/// The same things give the same fingerprint, other things another.

#include "ooc/fingerprint.h"

#include <set>

#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

std::string of(std::initializer_list<std::string_view> texts) {
  Fingerprint print;
  for (const auto text : texts) print.add(text);
  return print.hex();
}

TEST(Fingerprint, ItemsDoNotRunTogether) {
  std::set<std::string> seen;
  for (const auto& texts : {of({}), of({""}), of({"", ""}), of({"abc"}), of({"ab", "c"}), of({"a", "bc"})}) {
    EXPECT_EQ(texts.size(), 32u);
    EXPECT_TRUE(seen.insert(texts).second);
  }
  EXPECT_EQ(of({"ab", "c"}), of({"ab", "c"}));
}

TEST(Fingerprint, IsTheSameOnEveryMachine) {
  EXPECT_EQ(of({"cuesta"}), "7b23fed26739ff2d7da1a07c3cba728f");
}

TEST(Fingerprint, AFileIsItsBytesInBlocksOfAnySize) {
  std::string bytes(700'000, 'x');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i >> 7);
  const test::ScratchFolder folder;
  const auto path = folder.write("a", bytes);
  Fingerprint file;
  std::uint64_t last = 0;
  ASSERT_TRUE(file.add_file(path, [&](std::uint64_t done) {
    EXPECT_GT(done, last);
    last = done;
    return true;
  }));
  EXPECT_EQ(last, bytes.size());
  EXPECT_EQ(file.hex(), of({bytes}));
  bytes[650'000] ^= 1;
  EXPECT_NE(file.hex(), of({bytes}));
}

TEST(Fingerprint, FaultsAndCancel) {
  const test::ScratchFolder folder;
  const auto path = folder.write("a", "bytes");
  Fingerprint print;
  EXPECT_EQ(print.add_file(folder / "gone").error().code, ErrorCode::not_found);
  EXPECT_EQ(print.add_file(folder / "").error().code, ErrorCode::io);
  EXPECT_EQ(print.add_file(path, [](std::uint64_t) { return false; }).error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace cuesta
