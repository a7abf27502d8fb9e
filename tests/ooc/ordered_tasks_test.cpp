/// Tasks in parallel, their results in order: what is committed is a prefix, whatever fails and whoever is
/// fastest; and what the tasks share (bucket files, the memory budget) holds when all use it at once.

#include "ooc/ordered_tasks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <numeric>
#include <thread>
#include <vector>

#include "ooc/bucket_file.h"
#include "ooc/memory_budget.h"
#include "tests/ooc/mesh_files.h"

namespace cuesta {
namespace {

constexpr std::uint64_t tasks = 300;
/// Whatever the machine has: two threads at least race.
const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, 4);

/// Later tasks are done sooner.
void dawdle(std::uint64_t i) {
  std::this_thread::sleep_for(std::chrono::microseconds((tasks - i) % 7 * 20));
}

Error wrong(std::uint64_t i) {
  return {ErrorCode::corrupt, "", std::to_string(i), "wrong"};
}

struct Outcome {
  std::vector<std::uint64_t> committed;
  Result<void> result;
  std::size_t most_at_a_time = 0;
};

/// Tasks `bad_work` and later multiples of it fail, so does commit number `bad_commit`.
Outcome run(std::size_t tokens, std::uint64_t bad_work, std::uint64_t bad_commit) {
  Outcome out;
  std::atomic<std::size_t> running{0}, most{0};
  out.result = run_in_order<std::uint64_t>(
      3, tasks, tokens,
      [&](std::uint64_t i) -> Result<std::uint64_t> {
        const std::size_t now = ++running;
        for (std::size_t m = most; m < now && !most.compare_exchange_weak(m, now);) {
        }
        dawdle(i);
        --running;
        if (i % bad_work == 0) return fail(wrong(i));
        return i * i;
      },
      [&](std::uint64_t i, std::uint64_t square) -> Result<void> {
        EXPECT_EQ(square, i * i);
        if (i == bad_commit) return fail(wrong(i));
        out.committed.push_back(i);
        return {};
      });
  out.most_at_a_time = most;
  return out;
}

std::vector<std::uint64_t> numbers(std::uint64_t end) {
  std::vector<std::uint64_t> out(end - 3);
  std::iota(out.begin(), out.end(), 3u);
  return out;
}

TEST(OrderedTasks, results_are_committed_in_order) {
  for (const std::size_t tokens : {1u, 2u, 9u}) {
    const Outcome out = run(tokens, 1000, 1000);
    EXPECT_TRUE(out.result);
    EXPECT_EQ(out.committed, numbers(tasks));
    EXPECT_LE(out.most_at_a_time, tokens);
  }
}

TEST(OrderedTasks, the_first_failure_in_order_ends_it) {
  for (const std::size_t tokens : {1u, 2u, 9u}) {
    const Outcome of_work = run(tokens, 100, 150);
    ASSERT_FALSE(of_work.result);
    EXPECT_EQ(of_work.result.error().place, "100");
    EXPECT_EQ(of_work.committed, numbers(100));
    const Outcome of_commit = run(tokens, 100, 50);
    ASSERT_FALSE(of_commit.result);
    EXPECT_EQ(of_commit.result.error().place, "50");
    EXPECT_EQ(of_commit.committed, numbers(50));
  }
}

TEST(OrderedTasks, run_all_gives_the_failure_of_the_lowest) {
  const auto result = run_all(tasks, 4, [](std::uint64_t i) -> Result<void> {
    dawdle(i);
    if (i == 60 || i == 61) return fail(wrong(i));
    return {};
  });
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().place, "60");
}

TEST(BucketFile, records_of_many_writers_all_arrive) {
  const test::ScratchFolder folder;
  auto file = BucketFile::create(folder / "buckets");
  ASSERT_TRUE(file);
  constexpr std::uint32_t buckets = 5, each = 400;
  ASSERT_TRUE(run_all(8, 4, [&](std::uint64_t w) -> Result<void> {
    BucketFile::Writer writer(*file, 64);
    for (std::uint32_t i = 0; i < each; ++i)
      if (auto r = writer.append(i % buckets, static_cast<std::uint32_t>(w * each + i)); !r) return r;
    return writer.flush();
  }));
  const auto again = BucketFile::open(folder / "buckets", file->encode_index());
  ASSERT_TRUE(again) << again.error().text();
  std::vector<std::uint32_t> all;
  for (std::uint32_t b = 0; b < buckets; ++b) {
    const auto records = records_of<std::uint32_t>(again->read(b).value());
    EXPECT_EQ(records.size(), 8 * each / buckets);
    for (const std::uint32_t r : records) EXPECT_EQ(r % each % buckets, b);
    all.insert(all.end(), records.begin(), records.end());
  }
  std::sort(all.begin(), all.end());
  EXPECT_TRUE(std::adjacent_find(all.begin(), all.end()) == all.end());
  EXPECT_EQ(all.back(), 8 * each - 1);
}

TEST(MemoryBudget, is_never_exceeded) {
  MemoryBudget budget(1000);
  std::atomic<int> refused{0};
  ASSERT_TRUE(run_all(tasks, 8, [&](std::uint64_t i) -> Result<void> {
    const auto got = budget.reserve(100 + i, "a task");
    EXPECT_LE(budget.used_bytes(), 1000u);
    if (got)
      dawdle(i);
    else
      ++refused;
    return {};
  }));
  EXPECT_EQ(budget.used_bytes(), 0u);
  EXPECT_LT(refused, static_cast<int>(tasks));
}

}  // namespace
}  // namespace cuesta
