/// The journal of a build: what was recorded is found again, by the same build only; a damaged one is told.

#include "ooc/journal.h"

#include <sys/resource.h>

#include <csignal>
#include <string>
#include <vector>

#include "ooc/work_folder.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

std::vector<std::byte> bytes(std::size_t count, int first = 0) {
  std::vector<std::byte> out(count);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = static_cast<std::byte>(i * 7 + static_cast<std::size_t>(first));
  return out;
}

TEST(Journal, WhatWasRecordedIsFoundByTheNextRun) {
  const test::ScratchFolder folder;
  const auto path = folder / "journal.sqlite";
  {
    auto journal = Journal::open(path, "one");
    ASSERT_TRUE(journal) << journal.error().text();
    EXPECT_FALSE(journal->is_resumed());
    for (const std::size_t size : {0u, 1u, 100'000u})
      ASSERT_TRUE(journal->record("stage", size, bytes(size)));
    ASSERT_TRUE(journal->record("stage", 1, bytes(1, 5))) << "the later result counts";
    ASSERT_TRUE(journal->record("other", 1, bytes(9)));
  }
  auto journal = Journal::open(path, "one");
  ASSERT_TRUE(journal);
  EXPECT_TRUE(journal->is_resumed());
  EXPECT_EQ(journal->count("stage").value(), 3u);
  EXPECT_EQ(journal->count("none").value(), 0u);
  EXPECT_EQ(journal->find("stage", 0).value(), bytes(0));
  EXPECT_EQ(journal->find("stage", 1).value(), bytes(1, 5));
  EXPECT_EQ(journal->find("stage", 100'000).value(), bytes(100'000));
  EXPECT_EQ(journal->find("stage", 2).value(), std::nullopt);
}

TEST(Journal, OfAnotherBuildIsEmptied) {
  const test::ScratchFolder folder;
  const auto path = folder / "journal.sqlite";
  ASSERT_TRUE(Journal::open(path, "one")->record("stage", 0, bytes(3)));
  const auto other = Journal::open(path, "two");
  ASSERT_TRUE(other);
  EXPECT_FALSE(other->is_resumed());
  EXPECT_EQ(other->count("stage").value(), 0u);
}

TEST(Journal, IsHeldByOneAtATime) {
  const test::ScratchFolder folder;
  const auto first = Journal::open(folder / "journal.sqlite", "one");
  ASSERT_TRUE(first);
  const auto second = Journal::open(folder / "journal.sqlite", "one");
  ASSERT_FALSE(second);
  EXPECT_NE(second.error().message.find("another process"), std::string::npos) << second.error().text();
}

std::string contents(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Whatever the bytes are: a journal that works, or an error with the file's name.
TEST(Journal, DamageIsToldNotFollowed) {
  const test::ScratchFolder folder;
  const auto path = folder / "journal.sqlite";
  {
    auto journal = Journal::open(path, "one");
    for (std::uint64_t i = 0; i < 40; ++i) ASSERT_TRUE(journal->record("stage", i, bytes(700)));
  }
  const std::string good = contents(path);
  ASSERT_GT(good.size(), 20'000u);
  const auto expect_answer = [&](const std::string& what) {
    SCOPED_TRACE(what);
    std::filesystem::remove(path.string() + "-wal");  // of the damage before
    auto journal = Journal::open(path, "one");
    if (!journal) {
      EXPECT_EQ(journal.error().file, path.string());
      EXPECT_FALSE(journal.error().message.empty());
      return;
    }
    for (std::uint64_t i = 0; i < 40; ++i) {
      const auto found = journal->find("stage", i);
      if (found)
        EXPECT_TRUE(!*found || **found == bytes(700)) << i;
      else
        EXPECT_FALSE(found.error().message.empty());
    }
    const auto count = journal->count("stage");
    EXPECT_TRUE(count || !count.error().message.empty());
  };
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 60) {
    folder.write("journal.sqlite", good.substr(0, size));
    expect_answer("cut off at " + std::to_string(size));
  }
  for (std::size_t at = 0; at < good.size(); at += at < 100 ? 1 : good.size() / 300) {
    std::string damaged = good;
    damaged[at] ^= 0x5a;
    folder.write("journal.sqlite", damaged);
    expect_answer("flipped at " + std::to_string(at));
  }
}

TEST(Journal, SomethingElseUnderItsNameIsCorrupt) {
  const test::ScratchFolder folder;
  const auto path = folder.write("journal.sqlite", std::string(5000, 'x'));
  const auto journal = Journal::open(path, "one");
  ASSERT_FALSE(journal);
  EXPECT_EQ(journal.error().code, ErrorCode::corrupt);
  EXPECT_NE(journal.error().message.find("--resume=never"), std::string::npos) << journal.error().text();
}

TEST(Journal, ADamagedOneIsNoObstacleToStartingOver) {
  const test::ScratchFolder folder;
  ASSERT_TRUE(WorkFolder::open(folder / "work", "one"));
  folder.write("work/journal.sqlite", std::string(5000, 'x'));
  folder.write("work/left", "something");
  const auto refused = WorkFolder::open(folder / "work", "one");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::corrupt);
  EXPECT_TRUE(std::filesystem::exists(folder / "work/left"));
  const auto fresh = WorkFolder::open(folder / "work", "one", false);
  ASSERT_TRUE(fresh) << fresh.error().text();
  EXPECT_FALSE(std::filesystem::exists(folder / "work/left"));
}

TEST(Journal, AFullDiskIsOutOfBudget) {
  const test::ScratchFolder folder;
  auto journal = Journal::open(folder / "journal.sqlite", "one");
  ASSERT_TRUE(journal);
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit limit{300'000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  const auto refused = journal->record("stage", 0, bytes(1'000'000));
  setrlimit(RLIMIT_FSIZE, &before);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_budget) << refused.error().text();
  EXPECT_TRUE(journal->record("stage", 0, bytes(1'000'000))) << "room was made";
}

}  // namespace
}  // namespace cuesta
