// SPDX-License-Identifier: Apache-2.0
#include "bench/scaling/scaling_run.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "bench/scale/farm_client.hpp"
#include "bench/scale/measured_coordinator.hpp"
#include "bench/scale/simulated_workers.hpp"

namespace tessera::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr auto kPoll = std::chrono::milliseconds(20);
constexpr double kPixels = double{kScalingWidthPx} * kScalingHeightPx;
constexpr int kColumns = kScalingWidthPx / core::kTilePx, kRows = kScalingHeightPx / core::kTilePx;
// The expensive region: a tenth of the tiles, in the middle, so that a pass over the image ends with cheap
// ones.
constexpr int kExpensiveColumns = 10, kExpensiveRows = 5;
constexpr int kFirstColumn = (kColumns - kExpensiveColumns) / 2, kFirstRow = (kRows - kExpensiveRows) / 2;
constexpr double kExpensive = 20;

double seconds_since(Clock::time_point start) {
  return Seconds(Clock::now() - start).count();
}

void wait_for_workers(v1::RenderService::Stub& users, int workers) {
  while (count_workers(users) < static_cast<std::size_t>(workers)) std::this_thread::sleep_for(kPoll);
}

bool is_done(v1::RenderService::Stub& users, const std::string& id) {
  grpc::ClientContext context;
  v1::GetJobRequest request;
  request.set_job_id(id);
  v1::GetJobResponse response;
  return users.GetJob(&context, request, &response).ok() && response.job().state() == v1::JOB_STATE_DONE;
}

// Kills workers at times spread over the render.
class Deaths {
 public:
  Deaths(const ScalingRun& run, SimulatedWorkers& workers) : run_(run), workers_(workers) {}

  // Kills those that are due this many seconds after the submission.
  void advance(double seconds) {
    while (killed() < run_.dying() && seconds >= run_.ideal_seconds * (killed() + 0.5) / run_.dying()) {
      workers_.kill(static_cast<std::size_t>(killed() * run_.workers / run_.dying()));
      at_seconds_.push_back(seconds);
    }
  }
  // The time of all cores in a render of this length.
  double core_seconds(double seconds) const {
    double sum = seconds * (run_.workers - killed());
    for (const double at : at_seconds_) sum += at;
    return sum;
  }

 private:
  int killed() const { return static_cast<int>(at_seconds_.size()); }

  const ScalingRun& run_;
  SimulatedWorkers& workers_;
  std::vector<double> at_seconds_;
};

double all_busy_seconds(const Counts& counts, Clock::time_point submitted, int workers) {
  if (counts.first_renders.size() < static_cast<std::size_t>(workers)) return -1;
  return Seconds(*std::max_element(counts.first_renders.begin(), counts.first_renders.end()) - submitted)
      .count();
}

}  // namespace

std::uint32_t ScalingRun::spp() const {
  const double samples = workers * ideal_seconds * kSamplesPerCoreSecond / kPixels;
  return static_cast<std::uint32_t>(std::max(1.0, std::round(samples)));
}

int ScalingRun::dying() const {
  return static_cast<int>(std::round(dying_share * workers));
}

double unbalanced_cost(const core::PixelRect& tile) {
  constexpr double kShare = double{kExpensiveColumns} * kExpensiveRows / (kColumns * kRows);
  constexpr double kMean = 1 + kShare * (kExpensive - 1);
  const int column = tile.x0 / core::kTilePx - kFirstColumn, row = tile.y0 / core::kTilePx - kFirstRow;
  const bool is_expensive = column >= 0 && column < kExpensiveColumns && row >= 0 && row < kExpensiveRows;
  return (is_expensive ? kExpensive : 1) / kMean;
}

core::Result<ScalingFigures> measure(const ScalingRun& run,
                                     const std::filesystem::path& coordinator_program) {
  const TemporaryFolder folder;
  const auto coordinator = MeasuredCoordinator::start({coordinator_program, folder.path(), {}});
  if (!coordinator) return core::fail(coordinator.error());
  const auto channel = own_connection(coordinator->address());
  if (!channel) return core::fail(channel.error());
  v1::RenderService::Stub users(*channel);
  Tally tally;
  SimulatedWorkers workers(tally);
  Speed speed{.samples_per_second = kSamplesPerCoreSecond};
  if (!run.is_balanced) speed.cost = unbalanced_cost;
  if (auto started = workers.start(run.workers, speed, coordinator->address()); !started)
    return core::fail(started.error());
  wait_for_workers(users, run.workers);
  if (auto uploaded = upload_scene(users); !uploaded) return core::fail(uploaded.error());

  const Usage before = coordinator->usage();
  const double own_before = own_cpu_seconds();
  tally.start();
  const auto submitted = Clock::now();
  const auto job = submit_job(users, request_of_scene(kScalingWidthPx, kScalingHeightPx, run.spp()));
  if (!job) return core::fail(job.error());
  Deaths deaths(run, workers);
  while (!is_done(users, job->id())) {
    deaths.advance(seconds_since(submitted));
    std::this_thread::sleep_for(kPoll);
  }
  ScalingFigures figures;
  figures.seconds = seconds_since(submitted);
  figures.core_seconds = deaths.core_seconds(figures.seconds);
  const Counts counts = tally.stop();
  figures.useful_samples = kPixels * run.spp();
  figures.all_busy_seconds = all_busy_seconds(counts, submitted, run.workers);
  figures.duplicate_share = 1 - figures.useful_samples / kSamplesPerCoreSecond / counts.rendering_seconds;
  figures.coordinator_cpu_seconds = coordinator->usage().cpu_seconds - before.cpu_seconds;
  figures.workers_cpu_seconds = own_cpu_seconds() - own_before;
  return figures;
}

}  // namespace tessera::bench
