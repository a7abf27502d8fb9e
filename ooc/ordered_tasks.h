#pragma once
/// Independent tasks in parallel, their results taken in order: one bounded pipeline for all stages of a
/// build.

#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>

#include "ooc/result.h"

namespace cuesta {

/// Threads of the calling arena.
inline std::size_t arena_threads() {
  return static_cast<std::size_t>(tbb::this_task_arena::max_concurrency());
}

/// Runs work(i) for i = first … end - 1, at most `tokens` at a time, and commit(i, result) one after the
/// other in ascending order. The first failure, in order, ends it: what comes before is committed, nothing
/// after.
/// @param work    Result<T>(std::uint64_t), called from several threads
/// @param commit  Result<void>(std::uint64_t, T)
template <class T, class Work, class Commit>
Result<void> run_in_order(std::uint64_t first, std::uint64_t end, std::size_t tokens, Work work,
                          Commit commit) {
  struct Done {
    std::uint64_t number;
    Result<T> result;
  };
  std::atomic<bool> stopped{false};
  std::optional<Error> error;
  std::uint64_t next = first;
  const auto number = [&](tbb::flow_control& flow) -> std::uint64_t {
    if (next == end || stopped) flow.stop();
    return next < end ? next++ : end;
  };
  const auto do_work = [&](std::uint64_t i) {
    return stopped ? std::shared_ptr<Done>() : std::make_shared<Done>(Done{i, work(i)});
  };
  const auto keep = [&](const std::shared_ptr<Done>& done) {
    if (!done || stopped) return;
    Result<void> r;
    if (!done->result)
      r = fail(done->result.error());
    else
      r = commit(done->number, std::move(*done->result));
    if (r) return;
    error = r.error();
    stopped = true;
  };
  using Item = std::shared_ptr<Done>;
  constexpr auto in_order = tbb::filter_mode::serial_in_order;
  tbb::parallel_pipeline(tokens,
                         tbb::make_filter<void, std::uint64_t>(in_order, number) &
                             tbb::make_filter<std::uint64_t, Item>(tbb::filter_mode::parallel, do_work) &
                             tbb::make_filter<Item, void>(in_order, keep));
  if (error) return fail(*error);
  return {};
}

/// Runs work(i) for all i < count, in parallel, in no order. @return the failure of the lowest i, if any.
template <class Work>
Result<void> run_all(std::uint64_t count, std::size_t tokens, Work work) {
  struct Nothing {};
  return run_in_order<Nothing>(
      0, count, tokens,
      [&](std::uint64_t i) -> Result<Nothing> {
        if (auto r = work(i); !r) return fail(r.error());
        return Nothing{};
      },
      [](std::uint64_t, Nothing) -> Result<void> { return {}; });
}

}  // namespace cuesta
