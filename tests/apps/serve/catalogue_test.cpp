#include "apps/serve/catalogue.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::serve {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::vector<std::string> names(const Catalogue& catalogue) {
  std::vector<std::string> names;
  for (const auto& set : catalogue.contents()->datasets) names.push_back(set->name);
  return names;
}

class CatalogueTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(folder / "served/sub");
    test::build_file(test::bumpy_sphere(6), folder / "sphere.cuesta");
    test::build_file(test::bumpy_torus(12, 8), folder / "torus.cuesta");
  }
  void put(const char* from, const std::string& to) {
    fs::copy_file(folder / from, folder / ("served/" + to + ".new"), fs::copy_options::overwrite_existing);
    fs::rename(folder / ("served/" + to + ".new"), folder / ("served/" + to));
  }
  TemporaryFolder folder;
};

TEST_F(CatalogueTest, files_appear_change_and_disappear) {
  Catalogue catalogue({folder / "served"}, {});
  EXPECT_TRUE(catalogue.update().empty());
  EXPECT_TRUE(names(catalogue).empty());
  put("sphere.cuesta", "b.cuesta");
  put("torus.cuesta", "sub/a.cuesta");
  catalogue.update();
  EXPECT_EQ(names(catalogue), (std::vector<std::string>{"b", "sub/a"}));
  const auto first = catalogue.contents()->dataset("b");
  const auto generation = catalogue.generation();
  catalogue.update();
  EXPECT_EQ(catalogue.generation(), generation);
  EXPECT_EQ(catalogue.contents()->dataset("b"), first);
  put("torus.cuesta", "b.cuesta");
  catalogue.update();
  const auto second = catalogue.contents()->dataset("b");
  EXPECT_NE(second->file->etag, first->file->etag);
  EXPECT_EQ(second->file->etag, catalogue.contents()->dataset("sub/a")->file->etag);
  fs::remove(folder / "served/b.cuesta");
  catalogue.update();
  EXPECT_EQ(names(catalogue), (std::vector<std::string>{"sub/a"}));
  // What is being sent stays as it was.
  std::string bytes(first->file->bytes(), '\0');
  ASSERT_EQ(::pread(first->file->descriptor.get(), bytes.data(), bytes.size(), 0),
            static_cast<ssize_t>(bytes.size()));
  EXPECT_EQ(bytes, test::bytes_of(folder / "sphere.cuesta"));
}

TEST_F(CatalogueTest, nothing_outside_of_the_paths_is_found) {
  put("sphere.cuesta", "x.cuesta");
  fs::create_symlink(folder / "torus.cuesta", folder / "served/link.cuesta");
  fs::create_directory_symlink(folder.operator/(""), folder / "served/up");
  put("sphere.cuesta", ".hidden.cuesta");
  put("sphere.cuesta", "line\nbreak.cuesta");
  put("sphere.cuesta", "x.cuesta.part");
  fs::create_directories(folder / "served/folder.cuesta");
  ASSERT_EQ(mkfifo((folder / "served/pipe.cuesta").c_str(), 0600), 0);
  Catalogue catalogue({folder / "served"}, {});
  EXPECT_TRUE(catalogue.update().empty());
  EXPECT_EQ(names(catalogue), (std::vector<std::string>{"x"}));
}

TEST_F(CatalogueTest, files_and_links_that_are_named_are_served) {
  fs::create_symlink(folder / "torus.cuesta", folder / "named.cuesta");
  fs::create_directory_symlink(folder / "served", folder / "shelf");
  put("sphere.cuesta", "x.cuesta");
  Catalogue catalogue({folder / "named.cuesta", folder / "shelf"}, {});
  EXPECT_TRUE(catalogue.update().empty());
  EXPECT_EQ(names(catalogue), (std::vector<std::string>{"named", "x"}));
}

TEST_F(CatalogueTest, what_is_not_served_is_told_once) {
  put("sphere.cuesta", "x.cuesta");
  test::put_bytes(folder / "served/bad.cuesta", "CUESTA\r\nand nothing else");
  Catalogue catalogue(
      {folder / "served", folder / "sphere.cuesta", folder / "gone", folder / "served/x.cuesta"}, {});
  const auto errors = catalogue.update();
  ASSERT_EQ(errors.size(), 3u);
  EXPECT_EQ(errors[0].code, ErrorCode::corrupt);
  EXPECT_EQ(errors[1].code, ErrorCode::not_found);
  EXPECT_NE(errors[2].message.find("another file of this name"), std::string::npos);
  EXPECT_EQ(catalogue.contents()->unreadable, 1u);
  EXPECT_TRUE(catalogue.update().empty());
  put("torus.cuesta", "bad.cuesta");
  EXPECT_TRUE(catalogue.update().empty());
  EXPECT_EQ(names(catalogue), (std::vector<std::string>{"bad", "sphere", "x"}));
}

TEST_F(CatalogueTest, facts_are_those_of_the_file) {
  put("sphere.cuesta", "a b.cuesta");
  test::put_bytes(folder / "served/a b.attribution", "made by <us>\n");
  Catalogue catalogue({folder / "served"}, {});
  catalogue.update();
  const auto set = catalogue.contents()->dataset("a b");
  ASSERT_TRUE(set);
  const auto file = CuestaFile::open(folder / "sphere.cuesta");
  const auto json = nlohmann::json::parse(set->json);
  EXPECT_EQ(json["triangles"], file->directory().triangles);
  EXPECT_EQ(json["file_bytes"], file->file_bytes());
  EXPECT_EQ(json["data"], "/data/a%20b.cuesta");
  EXPECT_EQ(json["attribution"], "made by <us>");
  EXPECT_TRUE(json.contains("metadata") && json.contains("rounds") && json.contains("least_error"));
  EXPECT_FALSE(nlohmann::json::parse(set->brief_json).contains("metadata"));
}

}  // namespace
}  // namespace cuesta::serve
