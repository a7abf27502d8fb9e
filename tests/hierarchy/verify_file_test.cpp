/// verify_file finds what it says it finds: each case spoils one thing in a good file.

#include "hierarchy/verify_file.h"

#include <gtest/gtest.h>

#include "tests/hierarchy/rewritten_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

class Verify : public testing::Test {
 protected:
  void SetUp() override {
    build_file(bumpy_sphere(24), folder_ / "good.cuesta");
    good_ = contents_of(folder_ / "good.cuesta");
    ASSERT_GT(good_.pages.size(), 4u);
  }
  VerifyReport verified(const Contents& contents) {
    write_contents(contents, folder_ / "bad.cuesta");
    const auto file = CuestaFile::open(folder_ / "bad.cuesta");
    EXPECT_TRUE(file) << file.error().text();
    return file ? verify_file(*file).value() : VerifyReport{};
  }
  /// The report of the good file after `spoil`.
  VerifyReport after(const std::function<void(Contents&)>& spoil) {
    Contents contents = good_;
    spoil(contents);
    return verified(contents);
  }
  static std::uint64_t found(const VerifyReport& r, Check check) {
    return r.found[static_cast<std::size_t>(check)];
  }

  TemporaryFolder folder_;
  Contents good_;
};

TEST_F(Verify, good_file_written_again_is_good) {
  const auto report = verified(good_);
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.pages, good_.pages.size());
  EXPECT_EQ(bytes_of(folder_ / "good.cuesta"), bytes_of(folder_ / "bad.cuesta"));
}

TEST_F(Verify, finds_an_error_below_its_dependencies) {
  const auto report = after([](Contents& c) {
    for (Child& child : c.pages.back().script.children) child.error = 0;
    c.directory.pages.back().least_error = 0;
  });
  EXPECT_GT(found(report, Check::saturated), 0u);
  EXPECT_EQ(found(report, Check::directory), 0u);
  EXPECT_EQ(report.findings.size(), std::min<std::uint64_t>(20, report.violations()));
}

/// A reader that wants a page must want the pages it leans on.
TEST_F(Verify, finds_a_page_that_covers_less_than_those_that_lean_on_it) {
  EXPECT_GT(found(after([](Contents& c) { c.directory.pages.back().bound.radius /= 2; }), Check::directory),
            0u);
  EXPECT_GT(found(after([](Contents& c) { c.directory.pages[0].largest_error = 255; }), Check::directory),
            0u);
}

TEST_F(Verify, finds_a_sphere_that_is_too_small) {
  const auto report = after([](Contents& c) {
    for (Page& page : c.pages)  // of round 0 they are not stored
      if (page.round == 1) page.script.fans.back().sphere.radius /= 2;
  });
  EXPECT_GT(found(report, Check::saturated), 0u);
}

/// A sphere of a coarse page must contain those of the finer page that its triangles came from.
TEST_F(Verify, carries_births_across_pages) {
  const auto report = after([](Contents& c) {
    for (Page& page : c.pages)
      if (page.round == 1) page.script.fans.back().sphere = {encode_radius_up(1e6f), 0, 0, 0};
    for (PageEntry& e : c.directory.pages) e.bound.radius = 1e8f * static_cast<float>(1 + e.round);
  });
  EXPECT_GT(found(report, Check::saturated), 0u);
  EXPECT_GT(good_.directory.pages[report.findings.front().page].round, 1u);
}

TEST_F(Verify, finds_an_illegal_substitution) {
  const auto report = after([](Contents& c) {
    auto& children = c.pages[0].script.children;
    std::swap(children[0].vertex, children[c.pages[0].script.fans[1].first_child].vertex);  // disjoint fans
  });
  EXPECT_GT(found(report, Check::legal), 0u);
}

TEST_F(Verify, finds_wrong_bounds_and_errors_in_the_directory) {
  EXPECT_GT(found(after([](Contents& c) { c.directory.pages[1].bound.radius *= 0.5f; }), Check::directory),
            0u);
  EXPECT_GT(found(after([](Contents& c) { --c.directory.pages[1].largest_error; }), Check::directory), 0u);
  EXPECT_GT(found(after([](Contents& c) { ++c.directory.pages[1].least_error; }), Check::directory), 0u);
  EXPECT_GT(found(after([](Contents& c) { ++c.directory.vertices; }), Check::directory), 0u);
  EXPECT_GT(found(after([](Contents& c) { --c.directory.triangles; }), Check::directory), 0u);
}

TEST_F(Verify, finds_a_missing_link_between_pages) {
  const auto report = after([](Contents& c) {
    const auto several = [](const PageEntry& e) { return e.coarser.size() > 1; };
    const auto entry = std::find_if(c.directory.pages.begin(), c.directory.pages.end(), several);
    ASSERT_NE(entry, c.directory.pages.end());
    entry->coarser.pop_back();
  });
  EXPECT_GT(report.violations(), 0u);
}

TEST_F(Verify, finds_wrong_survivors_in_a_source_table) {
  for (const bool triangles : {true, false}) {
    const auto report = after([triangles](Contents& c) {
      PageSource& s = c.pages.back().sources.front();
      auto& numbers = triangles ? s.triangles : s.vertices;
      ++numbers.back();
    });
    EXPECT_GT(found(report, Check::sources), 0u);
  }
}

TEST_F(Verify, goes_on_past_an_unreadable_page) {
  std::string bytes = bytes_of(folder_ / "good.cuesta");
  bytes[good_.directory.pages[2].block.offset + 40] ^= 1;
  put_bytes(folder_ / "flipped.cuesta", bytes);
  const auto file = CuestaFile::open(folder_ / "flipped.cuesta");
  ASSERT_TRUE(file);
  const auto report = verify_file(*file).value();
  EXPECT_EQ(found(report, Check::readable), 1u);
  EXPECT_EQ(report.findings.front().page, 2u);
  EXPECT_EQ(report.violations(), 1u);
  EXPECT_EQ(report.skipped.size(), 1u);
}

TEST_F(Verify, needs_little_memory_for_positions) {
  const auto file = CuestaFile::open(folder_ / "good.cuesta");
  VerifyOptions options;
  options.position_bytes = 1;
  EXPECT_TRUE(verify_file(*file, options).value().ok());
}

TEST_F(Verify, can_be_cancelled) {
  const auto file = CuestaFile::open(folder_ / "good.cuesta");
  const auto report = verify_file(*file, {}, [](std::uint64_t done, std::uint64_t) { return done < 3; });
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::cancelled);
}

}  // namespace
}  // namespace cuesta::test
