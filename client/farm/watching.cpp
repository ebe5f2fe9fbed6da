// SPDX-License-Identifier: Apache-2.0
#include "client/farm/watching.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "client/console.hpp"
#include "client/farm/interruption.hpp"
#include "client/farm/job_text.hpp"
#include "client/interrupt.hpp"
#include "client/progress.hpp"
#include "core/base/printable.hpp"
#include "proto/status.hpp"
#include "proto/unreachable.hpp"

namespace tessera::client {
namespace {

// A coordinator that is back is found within this time.
constexpr std::chrono::seconds kLongestPause{2};
// Of a job that one wait tells of, each once.
constexpr std::size_t kMaxTroubles = 100;

class TroubleNotices {
 public:
  explicit TroubleNotices(std::function<void(const std::string&)> notify) : notify_(std::move(notify)) {}
  void take(const v1::Job& job) {
    for (const std::string& trouble : job.troubles())
      if (told_.size() < kMaxTroubles && told_.insert(trouble).second) notify_(core::printable(trouble));
  }

 private:
  const std::function<void(const std::string&)> notify_;
  std::set<std::string> told_;
};

tl::unexpected<core::Error> interruption() {
  return core::fail(core::ErrorCode::kCancelled, "interrupted");
}

using IsEnough = bool (*)(v1::JobState);

bool is_validated(v1::JobState state) {
  return state != v1::JOB_STATE_VALIDATING;
}

// Follows one stream to its end, or until the state of the job is enough. The last job it told of; an error
// if the stream ended before. `asked`: to wait for so long, by a coordinator that is there.
core::Result<v1::Job> follow_stream(Farm& farm, const std::string& job_id, IsEnough is_enough,
                                    const std::function<void(const v1::Job&)>& on_update,
                                    std::optional<std::chrono::milliseconds>& asked) {
  grpc::ClientContext context;
  const std::jthread canceller = cancel_at_interrupt(context);
  v1::WatchJobRequest request;
  request.set_job_id(job_id);
  const auto stream = farm.stub().WatchJob(&context, request);
  v1::WatchJobResponse response;
  std::optional<v1::Job> over;
  while (stream->Read(&response)) {
    on_update(response.job());
    if (!is_enough(response.job().state())) continue;
    over = response.job();
    if (!is_over(over->state())) context.TryCancel();
  }
  const grpc::Status status = stream->Finish();
  asked = proto::asked_wait(status, context);
  if (over) return *over;
  if (interrupted()) return interruption();
  if (status.ok()) return core::fail(core::ErrorCode::kUnavailable, "the coordinator ended the conversation");
  return core::fail(farm.explain(status, context));
}

// watch_job() until the state is enough.
core::Result<v1::Job> watch_until(Farm& farm, const std::string& job_id, IsEnough is_enough,
                                  const std::function<void(const v1::Job&)>& on_update,
                                  const std::function<void(const std::string&)>& on_notice) {
  const auto policy = proto::transient_only(proto::exponential_backoff({.longest = kLongestPause}));
  const std::string lost = proto::lost_coordinator(farm.address());
  int failures = 0;
  std::string told;  // of these failures
  std::optional<std::chrono::milliseconds> asked;
  for (;;) {
    const auto note = [&](const v1::Job& update) {
      failures = 0;
      if (std::exchange(told, "").starts_with(lost)) on_notice("the coordinator is back");
      on_update(update);
    };
    auto job = follow_stream(farm, job_id, is_enough, note, asked);
    if (job) return job;
    if (interrupted()) return interruption();
    const auto wait = policy({.last_code = job.error().code, .count = ++failures});
    if (!wait) return job;
    const std::string& error = job.error().message;
    const std::string why = asked
                                ? error + "; trying again"
                                : (error.starts_with(lost) ? error : lost) + "; waiting for it to come back";
    if (std::exchange(told, why) != why) on_notice(why);
    const auto pause = std::max<proto::Duration>(*wait, asked.value_or(std::chrono::milliseconds(0)));
    if (!sleep_unless_interrupted(pause)) return interruption();
  }
}

}  // namespace

core::Result<v1::Job> watch_job(Farm& farm, const std::string& job_id,
                                const std::function<void(const v1::Job&)>& on_update,
                                const std::function<void(const std::string&)>& on_notice) {
  return watch_until(farm, job_id, is_over, on_update, on_notice);
}

core::Result<v1::Job> wait_until_validated(Farm& farm, const v1::Job& submitted,
                                           const std::function<void(const std::string&)>& on_notice) {
  if (is_validated(submitted.state())) return submitted;
  TroubleNotices troubles(on_notice);
  return watch_until(
      farm, submitted.id(), is_validated, [&](const v1::Job& update) { troubles.take(update); }, on_notice);
}

core::Result<v1::Job> watch_with_progress(Farm& farm, const std::string& job_id) {
  Notices none;
  return watch_with_progress(farm, job_id, none);
}

core::Result<v1::Job> watch_with_progress(Farm& farm, const std::string& job_id, Notices& notices) {
  ProgressLine progress(stderr_progress_output(), steady_seconds());
  const auto notify = [&](const std::string& notice) {
    progress.erase();
    print_warning(notice);
  };
  TroubleNotices troubles(notify);
  auto job = watch_job(
      farm, job_id,
      [&](const v1::Job& update) {
        troubles.take(update);
        for (const std::string& notice : notices.take()) notify(notice);
        progress.update(progress_of(update), steady_seconds());
      },
      notify);
  progress.erase();
  return job;
}

core::Result<v1::Job> watch_with_lines(Farm& farm, const std::string& job_id, Notices& notices) {
  return watch_job(
      farm, job_id,
      [&](const v1::Job& job) {
        print_warnings(notices.take());
        print_result(to_json_line(job));
        if (results_are_lost()) interrupt();
      },
      [](const std::string&) {});
}

int report_end(const v1::Job& job) {
  const v1::Counters& counters = job.counters();
  if (counters.non_finite_samples() > 0)
    print_warning(fmt::format("{} samples were not finite numbers and count as black; please report it",
                              counters.non_finite_samples()));
  if (counters.saturated_samples() > 0)
    print_warning(
        fmt::format("{} samples were too bright for the film and were cut off: scale the scene's lights down",
                    counters.saturated_samples()));
  if (job.state() == v1::JOB_STATE_FAILED)
    return print_error(fmt::format("job {} failed: {}", short_id(job.id()), job.failure()));
  if (job.state() == v1::JOB_STATE_CANCELLED)
    return print_error(
        fmt::format("job {} was cancelled; tessera image {} -o FILE fetches what there is of it",
                    short_id(job.id()), short_id(job.id())));
  return kExitOk;
}

}  // namespace tessera::client
