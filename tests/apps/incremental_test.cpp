/// A tile that is added to a terrain: only what it touches is built, and the file is that of a full build.

#include <gtest/gtest.h>

#include <cmath>

#include "tests/apps/run_program.h"

namespace cuesta::test {
namespace {

constexpr int side = 801;

void write_hgt(const std::filesystem::path& path, int east) {
  std::string bytes;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      const double x = east * (side - 1) + c;
      const auto h =
          static_cast<int>(500 + 300 * std::sin(x / 37) * std::cos(r / 53.0) + 40 * std::sin(x * r / 3000));
      bytes += static_cast<char>(h >> 8 & 255);
      bytes += static_cast<char>(h & 255);
    }
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST(Incremental, a_new_tile_changes_what_it_touches) {
  const TestFolder folder;
  const std::string west = folder / "N10E020.hgt", east = folder / "N10E021.hgt";
  write_hgt(west, 0);
  write_hgt(east, 1);
  const std::string grown = folder / "grown.cuesta", whole = folder / "whole.cuesta";
  const auto first = run(folder, {"build", west, "-o", grown, "--frame", "ecef", "--incremental", "--quiet"});
  ASSERT_EQ(first.status, 0) << first.err;
  const auto second =
      run(folder, {"build", west, east, "-o", grown, "--frame", "ecef", "--incremental", "--quiet"});
  ASSERT_EQ(second.status, 0) << second.err;
  const auto full = run(folder, {"build", west, east, "-o", whole, "--frame", "ecef", "--quiet"});
  ASSERT_EQ(full.status, 0) << full.err;
  EXPECT_EQ(read_text(grown), read_text(whole));
  std::size_t at = second.out.find(" cells were known");
  ASSERT_NE(at, std::string::npos) << second.out;
  const std::string words = second.out.substr(second.out.rfind('\n', at) + 1);
  const int known = std::atoi(words.c_str()), all = std::atoi(words.substr(words.find("of ") + 3).c_str());
  EXPECT_GT(known, all / 5) << second.out;
  EXPECT_LT(known, all);
}

}  // namespace
}  // namespace cuesta::test
