// SPDX-License-Identifier: Apache-2.0
// Measures how a farm scales: the samples of the image per core-second of its workers, and how soon all of
// them render. Workers wait instead of rendering (scaling_run.hpp). Prints a Markdown table, whose columns
// docs/scaling.md explains.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string>
#include <vector>

#include "bench/scaling/scaling_run.hpp"
#include "core/common/open_files.hpp"

namespace {

using namespace tessera;
using bench::ScalingFigures;
using bench::ScalingRun;

struct Options {
  std::string coordinator;
  std::vector<int> workers{1, 4, 16, 64, 256, 1024};
  std::vector<std::string> scenes{"balanced", "unbalanced"};
  std::vector<double> dying{0, 0.05};
  double seconds = 120;
  double at_least = 0;
};

Options parse_options(int argc, char** argv) {
  Options options;
  options.coordinator = std::filesystem::path(argv[0]).parent_path() / "tessera-coordinator";
  CLI::App app(
      "Measures the samples per core-second of farms of simulated workers; prints a Markdown table.");
  app.add_option("--coordinator", options.coordinator, "The tessera-coordinator to start")
      ->capture_default_str();
  app.add_option("--workers", options.workers, "Numbers of workers")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.add_option("--scenes", options.scenes, "balanced, unbalanced or both")
      ->check(CLI::IsMember({"balanced", "unbalanced"}))
      ->capture_default_str();
  app.add_option("--dying", options.dying, "Shares of the workers that are killed, from 0 to 0.9")
      ->check(CLI::Range(0.0, 0.9))
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "How long each render takes if no time is lost")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  app.add_option("--at-least", options.at_least, "Fail if a render makes less of its cores, from 0 to 1")
      ->check(CLI::Range(0.0, 1.0));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : 2);
  }
  return options;
}

// Farms with fewer workers than one death have the same render twice.
std::vector<ScalingRun> runs(const Options& options) {
  std::vector<ScalingRun> all;
  for (const int workers : options.workers)
    for (const std::string& scene : options.scenes)
      for (const double dying : options.dying) {
        const ScalingRun run{workers, scene == "balanced", dying, options.seconds};
        if (dying == 0 || run.dying() > 0) all.push_back(run);
      }
  return all;
}

void print_head() {
  std::cout << "| workers | scene | killed | spp | seconds | efficiency | redundant | all busy after, s | "
               "coordinator, cores | simulated workers, cores |\n"
            << "|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|" << std::endl;
}

void print_row(const ScalingRun& run, const ScalingFigures& figures) {
  std::cout << fmt::format("| {} | {} | {} | {} | {:.1f} | {:.1f} % | {:.1f} % | {:.2f} | {:.2f} | {:.2f} |",
                           run.workers, run.is_balanced ? "balanced" : "unbalanced", run.dying(), run.spp(),
                           figures.seconds, 100 * figures.efficiency(), 100 * figures.duplicate_share,
                           figures.all_busy_seconds, figures.coordinator_cpu_seconds / figures.seconds,
                           figures.workers_cpu_seconds / figures.seconds)
            << std::endl;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse_options(argc, argv);
  common::raise_file_limit();  // each worker's connection needs a file descriptor
  bool enough = true;
  print_head();
  for (const ScalingRun& run : runs(options)) {
    const auto figures = bench::measure(run, options.coordinator);
    if (!figures) {
      std::cerr << "farm_scaling: " << figures.error().message << '\n';
      return EXIT_FAILURE;
    }
    print_row(run, *figures);
    enough = enough && figures->efficiency() >= options.at_least;
  }
  return enough ? EXIT_SUCCESS : EXIT_FAILURE;
}
