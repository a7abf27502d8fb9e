/// Cells that are known from a build before: the same bytes, and only what is new is simplified.

#include "hierarchy/cell_cache.h"

#include <gtest/gtest.h>

#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

class CellCacheTest : public ::testing::Test {
 protected:
  std::string built(CellCache* cache, const SurfaceMesh& mesh = bumpy_sphere(40)) {
    BuildOptions options = small_cells();
    options.cache = cache;
    const auto path = folder_ / "built.cuesta";
    build_file(mesh, path, options);
    return bytes_of(path);
  }
  CellCache open(const std::string& program = "program") {
    return std::move(CellCache::open(folder_ / "cells", program).value());
  }
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_ / "cells"), {}));
  }
  TemporaryFolder folder_;
};

TEST_F(CellCacheTest, same_bytes) {
  const std::string expected = built(nullptr);
  auto first = open();
  EXPECT_EQ(built(&first), expected);
  EXPECT_EQ(first.found(), 0u);
  EXPECT_GT(first.made(), 5u);
  auto second = open();
  EXPECT_EQ(built(&second), expected);
  EXPECT_EQ(second.found(), first.made());
  EXPECT_EQ(second.made(), 0u);
}

TEST_F(CellCacheTest, what_is_damaged_is_made_again) {
  auto first = open();
  const std::string expected = built(&first);
  std::size_t i = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cells")) {
    const std::string bytes = bytes_of(entry.path());
    if (bytes.empty()) continue;  // the stamp
    ++i;
    if (i % 3 == 0) put_bytes(entry.path(), bytes.substr(0, bytes.size() / 2));
    if (i % 3 == 1) put_bytes(entry.path(), std::string(bytes).replace(bytes.size() / 2, 1, "\x7f"));
  }
  auto second = open();
  EXPECT_EQ(built(&second), expected);
  EXPECT_GT(second.made(), 0u);
  EXPECT_GT(second.found(), 0u);
}

TEST_F(CellCacheTest, another_program_knows_nothing) {
  auto first = open("one");
  built(&first);
  auto second = open("two");
  built(&second);
  EXPECT_EQ(second.found(), 0u);
}

TEST_F(CellCacheTest, unused_cells_go) {
  auto first = open();
  built(&first);
  const std::size_t before = files();
  // Files of another surface join them, and those of the first go.
  auto second = open();
  for (const auto& entry : std::filesystem::directory_iterator(folder_ / "cells"))
    std::filesystem::last_write_time(
        entry.path(), entry.last_write_time() - std::chrono::hours(entry.file_size() > 0 ? 1 : 0));
  built(&second, bumpy_torus(40, 20));
  EXPECT_GT(files(), before);
  second.remove_unused();
  EXPECT_EQ(files(), second.made() + 1);
}

}  // namespace
}  // namespace cuesta::test
