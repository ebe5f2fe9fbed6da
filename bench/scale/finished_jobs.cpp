// SPDX-License-Identifier: Apache-2.0
// Measures a coordinator with many finished jobs. Without --open, fills a folder with them and runs itself on
// that. Prints a Markdown table; docs/scaling.md has results.
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "proto/blob.hpp"
#include "proto/convert.hpp"
#include "server/base/wall_clock.hpp"
#include "server/coordinator.hpp"
#include "server/farm/wire.hpp"
#include "server/film/tile_row.hpp"

namespace {

using namespace tessera;

constexpr int kSidePx = 64;
constexpr std::uint32_t kSpp = 16;
// A common scene, and a scene file of its own for each job.
constexpr int kCommonFiles = 10;
constexpr int kThreads = 64, kJobsAtOnce = 64;

v1::Bundle bundle_of(int job) {
  v1::Bundle bundle;
  bundle.set_scene_path("scene.json");
  const auto add = [&](const std::string& path, const std::string& content) {
    v1::Bundle::Asset& asset = *bundle.add_assets();
    asset.set_path(path);
    *asset.mutable_digest() = proto::to_proto(proto::digest_of(content));
  };
  add("scene.json", fmt::format("scene {}", job));
  for (int i = 0; i < kCommonFiles; ++i) add(fmt::format("meshes/{}.obj", i), fmt::format("mesh {}", i));
  return bundle;
}

store::JobRow row_of(int job) {
  v1::Job spec;
  spec.set_id(fmt::format("{:032x}", job + 1));
  spec.set_name(fmt::format("shot {} frame {}", job / 1000, job % 1000));
  spec.set_owner(fmt::format("artist {}", job % 50));
  core::RenderSettings settings;
  settings.width_px = settings.height_px = kSidePx;
  settings.spp = kSpp;
  *spec.mutable_settings() = proto::to_proto(settings);
  *spec.mutable_bundle() = bundle_of(job);
  *spec.mutable_created_at() = farm::timestamp_from_ms(base::wall_clock_ms());
  farm::JobRecord record;
  record.spec = std::make_shared<const v1::Job>(std::move(spec));
  record.finished_ms = base::wall_clock_ms();
  record.stored_counters.samples = std::uint64_t{kSidePx} * kSidePx * kSpp;
  scheduler::JobView view;
  view.id = {record.spec->id()};
  view.shape = {kSidePx, kSidePx, kSpp};
  view.state = scheduler::JobState::kDone;
  store::JobRow row = farm::to_row({record, view});
  row.settled = true;
  return row;
}

store::TileRow tile_of(const std::string& job) {
  film::TileContent content;
  constexpr std::size_t kSums = std::size_t{kSidePx} * kSidePx * 3;
  content.sums = {std::vector<std::uint64_t>(kSums, 1 << 20), std::vector<std::uint64_t>(kSums, 1 << 19),
                  kSpp, kSpp / 2};
  content.counters.samples = std::uint64_t{kSidePx} * kSidePx * kSpp;
  return film::encode_tile_row(job, 0, {0, 0, kSidePx, kSidePx}, {{0, kSpp}}, content);
}

// Many threads at once share the store's transactions.
bool fill(store::JobStore& jobs, int count) {
  std::atomic<int> next = 0;
  std::atomic<bool> whole = true;
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int begin = next.fetch_add(kJobsAtOnce); begin < count; begin = next.fetch_add(kJobsAtOnce)) {
        std::vector<store::TileRow> tiles;
        for (int job = begin; job < std::min(count, begin + kJobsAtOnce); ++job) {
          const store::JobRow row = row_of(job);
          if (!jobs.insert_job(row)) whole = false;
          tiles.push_back(tile_of(row.id));
        }
        if (!jobs.write_tiles(tiles)) whole = false;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  return whole;
}

double peak_resident_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

class Stopwatch {
 public:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

// The milliseconds of a call, which returns a Result.
template <typename Call>
double milliseconds(const Call& call) {
  const Stopwatch stopwatch;
  const auto result = call();
  const double seconds = stopwatch.seconds();
  if (!result) {
    std::cerr << "finished_jobs_bench: " << result.error().message << '\n';
    std::exit(EXIT_FAILURE);
  }
  return 1e3 * seconds;
}

int measure(const std::filesystem::path& folder) {
  const Stopwatch start;
  auto state = store::StateDirectory::open(folder);
  if (!state) return std::cerr << state.error().message << '\n', EXIT_FAILURE;
  const auto check = [](const v1::Bundle&, const v1::RenderOverrides&, const std::vector<std::int32_t>&,
                        const std::stop_token&) -> core::Result<jobs::CheckedScene> {
    return core::fail(core::ErrorCode::kInvalidArgument, "nothing is submitted");
  };
  const auto opened = server::Coordinator::open({}, std::move(*state), check);
  if (!opened) return std::cerr << opened.error().message << '\n', EXIT_FAILURE;
  server::Coordinator& coordinator = **opened;
  const double start_seconds = start.seconds();
  const double start_mib = peak_resident_mib();
  v1::ListJobsRequest page, of_owner, unfinished;
  of_owner.set_owner("artist 7");
  unfinished.add_states(v1::JOB_STATE_RUNNING);
  const std::string id = fmt::format("{:032x}", 777);
  jobs::JobService& jobs = coordinator.jobs();
  const auto lists = [&](const v1::ListJobsRequest& request) { return [&] { return jobs.list(request); }; };
  std::cout << fmt::format(
      "| start, s | peak resident, MiB | page of 1,000, ms | of one owner, ms | of no job, ms | GetJob, ms | "
      "GetImage, ms | files of all jobs, ms |\n|--:|--:|--:|--:|--:|--:|--:|--:|\n"
      "| {:.2f} | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {:.0f} |\n",
      start_seconds, start_mib, milliseconds(lists(page)), milliseconds(lists(of_owner)),
      milliseconds(lists(unfinished)), milliseconds([&] { return jobs.get(id); }),
      milliseconds([&] { return coordinator.images().get(id); }), milliseconds([&] {
        coordinator.files().collect();
        return core::Status();
      }));
  std::cout << fmt::format("\npeak resident after all of them: {:.0f} MiB\n", peak_resident_mib());
  return EXIT_SUCCESS;
}

int fill_and_measure(char* program, int count) {
  std::string folder = (std::filesystem::temp_directory_path() / "finished_jobs-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return EXIT_FAILURE;
  const Stopwatch stopwatch;
  {
    auto state = store::StateDirectory::open(folder);
    if (!state || !fill(state->jobs, count)) return EXIT_FAILURE;
    std::cout << fmt::format("{} jobs were stored in {:.0f} s with {} transactions\n\n", count,
                             stopwatch.seconds(), state->jobs.transactions());
  }
  const int status = std::system(fmt::format("{} --open {}", program, folder).c_str());
  std::filesystem::remove_all(folder);
  return status == 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Measures a coordinator with many finished jobs; prints a Markdown table.");
  int count = 100'000;
  std::string folder;
  app.add_option("--jobs", count, "How many")->capture_default_str();
  app.add_option("--open", folder, "The state folder of an earlier run");
  CLI11_PARSE(app, argc, argv);
  return folder.empty() ? fill_and_measure(argv[0], count) : measure(folder);
}
