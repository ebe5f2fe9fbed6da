// SPDX-License-Identifier: Apache-2.0
#include "server/jobs/retirement.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <utility>

#include "server/base/wall_clock.hpp"
#include "server/jobs/job_service.hpp"

namespace tessera::jobs {

namespace {

// Deleted in one transaction.
constexpr std::uint64_t kRetiredAtOnce = 64;

std::optional<std::int64_t> seconds_of(const std::string& unit) {
  static const std::map<std::string, std::int64_t> kUnits{{"s", 1}, {"m", 60}, {"h", 3600}, {"d", 86400}};
  const auto found = kUnits.find(unit);
  return found == kUnits.end() ? std::nullopt : std::optional(found->second);
}

}  // namespace

core::Result<KeepFinished> read_keep_finished(const std::string& text) {
  constexpr std::uint64_t kMax = 1'000'000'000;
  std::uint64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  const std::string unit(rest, end);
  if (error == std::errc() && number <= kMax) {
    if (unit.empty()) return KeepFinished{{}, number};
    if (const auto seconds = seconds_of(unit))
      return KeepFinished{std::chrono::seconds(static_cast<std::int64_t>(number) * *seconds), {}};
  }
  return core::fail(
      core::ErrorCode::kInvalidArgument,
      fmt::format("'{}' is neither a number of jobs, such as 5000, nor a time, such as 90m, 12h "
                  "or 30d",
                  text));
}

core::Status JobService::retire(const KeepFinished& keep) {
  std::optional<std::int64_t> before_ms;
  std::uint64_t most = kRetiredAtOnce;
  if (keep.time) before_ms = base::wall_clock_ms() - std::chrono::milliseconds(*keep.time).count();
  if (keep.jobs) {
    const auto count = state_.jobs.settled_count();
    if (!count) return core::fail(count.error());
    most = std::min(most, *count - std::min(*count, *keep.jobs));
  }
  if ((!keep.time && !keep.jobs) || most == 0) return {};
  const core::MutexLock nobody_moves_them(moving_mutex_);
  auto ids = state_.jobs.first_settled(before_ms, static_cast<std::size_t>(most));
  if (!ids) return core::fail(ids.error());
  // A damaged row does not tell when its job finished.
  std::erase_if(*ids, [&](const std::string& id) {
    const auto row = state_.jobs.job(id);
    return !row || !*row || !(*row)->intact;
  });
  if (ids->empty()) return {};
  if (auto deleted = state_.jobs.delete_jobs(*ids); !deleted) return deleted;
  files_.note_deleted();
  for (const std::string& id : *ids) farm_.events().append_end(events::SubjectKind::kJob, id);
  spdlog::info("deleted {} finished jobs that are kept no longer", ids->size());
  return {};
}

}  // namespace tessera::jobs
