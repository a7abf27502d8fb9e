#pragma once
/// Real scans for tests that want them: a folder beside the checkout that need not be there.

#include <filesystem>
#include <string>

namespace cuesta::test {

/// Path of `name` in the shared data folder, for example "mesh/bun_zipper.ply"; empty if it is not there.
inline std::filesystem::path shared_data(const std::string& name) {
  const std::filesystem::path path =
      std::filesystem::path(CUESTA_SOURCE_DIR) / ".." / "shared" / "data" / name;
  return std::filesystem::exists(path) ? path : std::filesystem::path{};
}

}  // namespace cuesta::test

#define CUESTA_NEED_SHARED(path, name)                                \
  const std::filesystem::path path = cuesta::test::shared_data(name); \
  if (path.empty()) GTEST_SKIP() << name << " is not in ../shared/data"
