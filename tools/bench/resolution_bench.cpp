// cuesta-bench-resolutions [Google Benchmark's options]: choose_resolutions for a million objects on one
// core. Counters: ms, rounds, and `gap`, by which the cost misses the budget, relative to it.
#include <benchmark/benchmark.h>

#include <cmath>
#include <random>
#include <vector>

#include "runtime/resolution_optimizer.h"

namespace {

using namespace cuesta;

struct Scene {
  std::vector<float> interest, cost, r_min;
  double least = 0, most = 0;

  explicit Scene(std::size_t n) : interest(n), cost(n), r_min(n) {
    std::mt19937_64 random(7);
    std::lognormal_distribution<float> size(0, 2), coverage(0, 3);
    std::uniform_real_distribution<float> floor(0.001f, 0.2f);
    for (std::size_t i = 0; i < n; ++i) {
      interest[i] = coverage(random), cost[i] = 1e-4f * size(random), r_min[i] = floor(random);
      least += double(cost[i]) * double(r_min[i]), most += double(cost[i]);
    }
  }
};

/// Arguments: objects, α in hundredths, share of the budget between r_min and full resolution in hundredths.
void choose(benchmark::State& state) {
  const Scene scene(static_cast<std::size_t>(state.range(0)));
  std::vector<float> r(scene.cost.size());
  const double budget = scene.least + 0.01 * double(state.range(2)) * (scene.most - scene.least);
  const ResolutionProblem problem{scene.interest, scene.cost, scene.r_min, budget,
                                  0.01 * double(state.range(1))};
  ResolutionScratch scratch;
  ResolutionAnswer answer;
  for (auto _ : state) answer = choose_resolutions(problem, scratch, r);
  double cost = 0;
  for (std::size_t i = 0; i < r.size(); ++i) cost += double(scene.cost[i]) * double(r[i]);
  state.counters["rounds"] = double(answer.rounds);
  state.counters["gap"] = (budget - cost) / budget;
}

BENCHMARK(choose)
    ->ArgNames({"objects", "alpha", "share"})
    ->ArgsProduct({{1'000'000}, {50, 100, 200}, {5, 50, 95}})
    ->Args({10'000, 100, 50})
    ->Args({1'000, 100, 50})
    ->Unit(benchmark::kMillisecond)
    ->MinTime(0.3);

}  // namespace

BENCHMARK_MAIN();
