// SPDX-License-Identifier: Apache-2.0
// Measures the scheduler alone: the CPU time of each kind of call, by the number of running jobs and of
// workers. Prints two tables, of means and of 99th percentiles.
//
// Run build/<preset>/bin/scheduler_bench; --benchmark_filter=1000x1000 chooses rows. Single-threaded. With
// --rare-events it measures events that concern many workers or a large image instead, each once.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/scale/rare_events.hpp"
#include "bench/scale/scheduler_farm.hpp"

namespace tessera::scheduler {
namespace {

struct Call {
  const char* name;
  double (SchedulerFarm::*measure)();
};
constexpr Call kCalls[] = {{"Synchronize with two grants", &SchedulerFarm::synchronize_with_two_grants},
                           {"renewal", &SchedulerFarm::renew},
                           {"result", &SchedulerFarm::deliver},
                           {"tick", &SchedulerFarm::tick},
                           {"100 invariants", &SchedulerFarm::check_slice},
                           {"all invariants", &SchedulerFarm::check}};

void measure(benchmark::State& state, const Call& call, int jobs, int workers) {
  // The benchmarks of a farm follow each other: one is in memory at a time.
  static std::pair<int, int> size;
  static std::unique_ptr<SchedulerFarm> farm;
  if (farm == nullptr || size != std::pair(jobs, workers)) {
    farm = std::make_unique<SchedulerFarm>();
    farm->add_jobs(jobs);
    farm->add_workers(workers);
    size = {jobs, workers};
  }
  std::vector<double> times;
  for ([[maybe_unused]] const auto iteration : state) {
    times.push_back((*farm.*call.measure)());
    state.SetIterationTime(times.back());
  }
  const auto rare = times.begin() + static_cast<std::ptrdiff_t>(times.size() * 99 / 100);
  std::nth_element(times.begin(), rare, times.end());
  state.counters["p99"] = *rare;
}

// Prints the tables when all is measured.
class Tables : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const std::string& name = run.run_name.function_name;
      const std::string call = name.substr(0, name.find('/')), row = name.substr(name.find('/') + 1);
      if (rows_.empty() || rows_.back().name != row) rows_.push_back({row, {}, {}});
      rows_.back().means[call] = run.real_accumulated_time / static_cast<double>(run.iterations);
      rows_.back().rare[call] = run.counters.at("p99");
    }
  }
  void Finalize() override {
    print("mean", &Row::means);
    print("99th percentile", &Row::rare);
  }

 private:
  struct Row {
    std::string name;
    std::map<std::string, double> means, rare;
  };
  void print(const char* title, const std::map<std::string, double> Row::*times) const {
    fmt::print("\n| running jobs x workers, {} in ms |", title);
    for (const Call& call : kCalls) fmt::print(" {} |", call.name);
    fmt::print("\n|---|");
    for ([[maybe_unused]] const Call& call : kCalls) fmt::print("--:|");
    for (const Row& row : rows_) {
      fmt::print("\n| {} |", row.name);
      for (const Call& call : kCalls) {
        const auto time = (row.*times).find(call.name);
        fmt::print(" {} |", time == (row.*times).end() ? "" : fmt::format("{:.4f}", 1e3 * time->second));
      }
    }
    fmt::print("\n");
  }

  std::vector<Row> rows_;
};

void register_all() {
  const std::pair<int, int> sizes[] = {{100, 1000}, {1000, 1000}, {10000, 1000}, {1, 10000}, {10000, 10000}};
  for (const auto& [jobs, workers] : sizes) {
    for (const Call& call : kCalls) {
      benchmark::RegisterBenchmark(fmt::format("{}/{}x{}", call.name, jobs, workers).c_str(),
                                   [&call, jobs = jobs, workers = workers](benchmark::State& state) {
                                     measure(state, call, jobs, workers);
                                   })
          ->UseManualTime()
          ->Unit(benchmark::kMillisecond);
    }
  }
}

}  // namespace
}  // namespace tessera::scheduler

int main(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "--rare-events") {
    tessera::scheduler::print_rare_events();
    return 0;
  }
  benchmark::Initialize(&argc, argv);
  tessera::scheduler::register_all();
  tessera::scheduler::Tables tables;
  benchmark::RunSpecifiedBenchmarks(&tables);
  return 0;
}
