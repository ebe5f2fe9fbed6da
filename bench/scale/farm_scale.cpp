// SPDX-License-Identifier: Apache-2.0
// Measures a coordinator with many workers, large images and many jobs. Processes and connections are real,
// but workers render nothing (simulated_worker.hpp). Prints a Markdown table of the resources that the
// coordinator used. docs/scaling.md explains the columns and has results.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <iostream>

#include "bench/scale/farm.hpp"
#include "core/common/open_files.hpp"

namespace {

using namespace tessera;
using bench::Counts;
using bench::Figures;
using bench::Load;

constexpr double kTileSamples = 64 * 64;
constexpr double kMiB = 1024 * 1024;
const bench::Speed kAtOnce{.samples_per_second = kTileSamples / 2, .takes_time = false};

struct Options {
  std::string coordinator;
  std::vector<std::string> only;
  bool quick = false, list = false;
  int core = -1;
  double seconds = 20;
  int workers = 0;
};

// Leases of two seconds with one sample of one tile each, in an image so large that no tile recurs within the
// first passes. This load costs the coordinator most for each second of a worker's time.
Load two_second_leases(int workers, double seconds) {
  return {.name = fmt::format("{} workers", workers),
          .workers = workers,
          .speed = {.samples_per_second = kTileSamples / 2},
          .width_px = 8192,
          .height_px = 4096,
          .measured_seconds = seconds};
}

// A job of one sample, to its end, by workers that render in no time.
Load whole_image(const std::string& name, int side_px, double longest_seconds) {
  return {.name = name,
          .workers = 32,
          .speed = kAtOnce,
          .width_px = side_px,
          .height_px = side_px,
          .spp = 1,
          .measured_seconds = longest_seconds,
          .until_done = true};
}

std::vector<Load> loads(const Options& options) {
  const double seconds = options.seconds;
  const auto saturated_by = [&](int workers, const std::string& name) {
    return Load{.name = name,
                .workers = workers,
                .speed = kAtOnce,
                .width_px = 8192,
                .height_px = 8192,
                .warm_up_seconds = 3,
                .measured_seconds = seconds / 2,
                .coordinator_core = options.core < 0 ? std::nullopt : std::optional<int>(options.core)};
  };
  std::vector<Load> all;
  for (const int workers : {10, 100, 300, 1000, 2000, 3000})
    all.push_back(two_second_leases(workers, seconds));
  if (options.workers > 0) all = {two_second_leases(options.workers, seconds)};
  all.push_back(saturated_by(32, "saturated"));
  all.push_back(saturated_by(1000, "saturated by 1000"));
  for (const int watchers : {0, 1, 200}) {
    // 1080p, of which 50 of 510 tiles change in a second.
    Load watched = two_second_leases(100, seconds);
    watched.name = fmt::format("{} watchers", watchers);
    watched.width_px = 1920;
    watched.height_px = 1088;
    watched.watchers = watchers;
    all.push_back(watched);
  }
  for (const int viewers : {1, 200}) {
    // The same number of changes, by fewer workers, so that the first tile does not take seconds.
    Load shown = two_second_leases(5, seconds);
    shown.name = fmt::format("{} page viewers", viewers);
    shown.speed = {.samples_per_second = 10 * kTileSamples};
    shown.width_px = 1920;
    shown.height_px = 1088;
    shown.page_viewers = viewers;
    all.push_back(shown);
  }
  Load hundred = two_second_leases(1000, seconds);
  hundred.name = "100 jobs";
  hundred.jobs = 100;
  hundred.width_px = hundred.height_px = 1024;
  all.push_back(hundred);
  Load thousands = two_second_leases(1000, seconds);
  thousands.name = "10,000 jobs";
  thousands.jobs = 10'000;
  thousands.width_px = thousands.height_px = 512;
  thousands.coordinator_options = {"--max-open-jobs", "20000"};
  all.push_back(thousands);
  Load large = two_second_leases(1000, seconds);
  large.name = "16K x 16K";
  large.width_px = large.height_px = 16384;
  all.push_back(large);
  all.push_back(whole_image("16K x 16K, whole", 16384, 300));
  Load gigapixel = whole_image("32K x 32K, whole", 32768, 3600);
  gigapixel.coordinator_options = {"--max-image-pixels", "1073741824", "--max-film-gib", "1.5"};
  all.push_back(gigapixel);
  gigapixel.name = "32K x 32K, four layers";
  gigapixel.layers = *core::parse_layers("direct,indirect,emission,albedo");
  all.push_back(gigapixel);
  return all;
}

std::vector<Load> quick_loads() {
  std::vector<Load> all{two_second_leases(20, 4), two_second_leases(200, 8)};
  all[0].warm_up_seconds = all[1].warm_up_seconds = 6;
  all[0].watchers = 2;
  all.push_back({.name = "4 jobs, to their end",
                 .workers = 20,
                 .speed = {.samples_per_second = 20 * kTileSamples},
                 .jobs = 4,
                 .width_px = 512,
                 .height_px = 512,
                 .spp = 4,
                 .measured_seconds = 60,
                 .until_done = true});
  return all;
}

void print_head() {
  std::cout
      << "| | results/s | samples/s | items/result | CPU, share of a core | ms CPU/result | us "
         "CPU/worker-second "
         "| MB/s in | MB/s written | MiB resident | beyond the films | result counted, ms: median, p99 "
         "| next "
         "lease, ms: median, p99 | workers busy | own CPU | failed calls | tiles/s to watchers | MB/s to "
         "watchers | first pixel, s | tile shown, ms: median, p99 |\n"
      << "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|" << std::endl;
}

std::string milliseconds(const std::vector<double>& seconds) {
  return fmt::format("{:.1f}, {:.1f}", 1e3 * bench::quantile(seconds, 0.5),
                     1e3 * bench::quantile(seconds, 0.99));
}

void print_row(const Load& load, const Figures& figures) {
  const Counts& counts = figures.counts;
  const double results = static_cast<double>(std::max<std::uint64_t>(counts.results, 1));
  const double cpu = figures.after.cpu_seconds - figures.before.cpu_seconds;
  const double worker_seconds = figures.seconds * load.workers;
  const double resident = static_cast<double>(figures.after.most_resident_bytes);
  const double written = static_cast<double>(figures.after.written_bytes - figures.before.written_bytes);
  std::cout << fmt::format(
                   "| {} | {:.1f} | {:.3g} | {:.2f} | {:.3f} | {:.3f} | {:.0f} | {:.1f} | {:.1f} | {:.0f} | "
                   "{:.0f} | {} | {} | {:.0f} % | {:.2f} | {} | {:.0f} | {:.2f} | {:.2f} | {} |",
                   load.name, results / figures.seconds,
                   static_cast<double>(counts.samples) / figures.seconds,
                   static_cast<double>(counts.items) / results, cpu / figures.seconds, 1e3 * cpu / results,
                   1e6 * cpu / worker_seconds, static_cast<double>(counts.sent_bytes) / figures.seconds / 1e6,
                   written / figures.seconds / 1e6, resident / kMiB,
                   (resident - static_cast<double>(figures.film_bytes)) / kMiB,
                   milliseconds(counts.submit_seconds), milliseconds(counts.next_lease_seconds),
                   100 * counts.rendering_seconds / worker_seconds, figures.own_cpu_seconds / figures.seconds,
                   counts.failed_calls, static_cast<double>(figures.watched_tiles) / figures.seconds,
                   static_cast<double>(figures.watched_bytes) / figures.seconds / 1e6,
                   figures.first_pixel_seconds, milliseconds(figures.shown_seconds))
            << std::endl;
}

Options parse_options(int argc, char** argv) {
  Options options;
  options.coordinator = std::filesystem::path(argv[0]).parent_path() / "tessera-coordinator";
  CLI::App app("Measures a coordinator with simulated workers; prints a Markdown table.");
  app.add_option("--coordinator", options.coordinator, "The tessera-coordinator to start")
      ->capture_default_str();
  app.add_flag("--quick", options.quick, "Half a minute of small farms, to see that it runs");
  app.add_option("--only", options.only, "Only the loads of these names");
  app.add_flag("--list", options.list, "Print the names of the loads");
  app.add_option("--seconds", options.seconds, "How long each is measured")->capture_default_str();
  app.add_option("--workers", options.workers, "Two-second leases for this many workers alone");
  app.add_option("--core", options.core, "The core on which the coordinator is saturated; any by default");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    std::exit(app.exit(error) == EXIT_SUCCESS ? EXIT_SUCCESS : 2);
  }
  return options;
}

bool is_wanted(const Options& options, const Load& load) {
  return options.only.empty() ||
         std::find(options.only.begin(), options.only.end(), load.name) != options.only.end();
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse_options(argc, argv);
  common::raise_file_limit();  // each worker's connection needs a file descriptor
  bool whole = true;
  if (!options.list) print_head();
  for (const Load& load : options.quick ? quick_loads() : loads(options)) {
    if (!is_wanted(options, load)) continue;
    if (options.list) {
      std::cout << load.name << '\n';
      continue;
    }
    const auto figures = bench::measure(load, options.coordinator);
    if (!figures) {
      std::cerr << "farm_scale: " << load.name << ": " << figures.error().message << '\n';
      return EXIT_FAILURE;
    }
    print_row(load, *figures);
    whole = whole && figures->counts.items > 0 && (!load.until_done || figures->all_done);
  }
  return whole ? EXIT_SUCCESS : EXIT_FAILURE;
}
