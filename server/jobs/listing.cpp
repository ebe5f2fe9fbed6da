// SPDX-License-Identifier: Apache-2.0
// Lists of jobs, in pages.
//
// The store has a row of every job, with what never changes of it: the order and most filters are its own. A
// job that is in memory is shown as it is there, so that a job that moves between the two is neither hidden
// nor shown twice.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>
#include <utility>

#include "proto/state_text.hpp"
#include "server/farm/pages.hpp"
#include "server/farm/wire.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/labels.hpp"

namespace tessera::jobs {

using farm::JobSnapshot;
using store::JobQuery;

namespace {

// Of a list with filters that the store does not have. Few of the jobs may match.
constexpr std::size_t kRowsAtOnce = 64;

core::Result<std::int64_t> from_token(const std::string& token) {
  std::int64_t number = 0;
  const char* const end = token.data() + token.size();
  const auto [rest, error] = std::from_chars(token.data(), end, number);
  if (error == std::errc() && rest == end) return number;
  return core::fail(core::ErrorCode::kInvalidArgument,
                    "page_token: is not from an earlier response: begin without one");
}

core::Result<JobQuery> to_query(const v1::ListJobsRequest& request) {
  JobQuery query;
  if (!request.page_token().empty()) {
    const auto number = from_token(request.page_token());
    if (!number) return core::fail(number.error());
    query.before_number = *number;
  }
  query.id_prefix = request.id_prefix();
  if (request.has_owner()) query.owner = request.owner();
  if (request.has_created_from()) query.created_from_ms = farm::ms_from_timestamp(request.created_from());
  if (request.has_created_before())
    query.created_before_ms = farm::ms_from_timestamp(request.created_before());
  for (const int state : request.states()) {
    if (state <= v1::JOB_STATE_UNSPECIFIED || !v1::JobState_IsValid(state))
      return core::fail(core::ErrorCode::kInvalidArgument,
                        fmt::format("states: must be of JobState, got {}", state));
    query.states |= std::uint32_t{1} << state;
  }
  return query;
}

core::Result<bool> has_rows(store::JobStore& jobs, const JobQuery& query) {
  bool has = false;
  const auto read = jobs.list_jobs(query, 1, [&](const store::JobRow&, std::int64_t) { has = true; });
  if (!read) return core::fail(read.error());
  return has;
}

// The rows that may match, by the index: queued jobs are not settled, and match any states.
JobQuery of_rows(JobQuery query, bool queued) {
  if (query.states == 0 && queued) query.states = std::uint32_t{1} << v1::JOB_STATE_RUNNING;
  return query;
}

// What the store cannot decide.
bool matches(const v1::Job& job, std::uint32_t states, bool queued, const Labels& labels) {
  const bool has_state = (states == 0 && !queued) || (states >> job.state() & 1) != 0;
  return (has_state || (queued && proto::is_queued(job))) && has_labels(job, labels);
}

}  // namespace

core::Result<v1::ListJobsResponse> JobService::list(const v1::ListJobsRequest& request) {
  auto query = to_query(request);
  if (!query) return core::fail(query.error());
  const int limit = farm::page_size(request.page_size());
  v1::ListJobsResponse response;
  while (response.jobs_size() < limit) {
    const auto last = list_some(*query, request, limit, response);
    if (!last) return core::fail(last.error());
    if (!*last) return response;
    query->before_number = *last;
  }
  const auto has_more = has_rows(state_.jobs, of_rows(*query, request.queued()));
  if (!has_more) return core::fail(has_more.error());
  if (*has_more) response.set_next_page_token(std::to_string(*query->before_number));
  return response;
}

// Adds the jobs of some more rows, until there are `limit`. Returns the number of the last row whose job was
// looked at; empty if there are no more.
core::Result<std::optional<std::int64_t>> JobService::list_some(const JobQuery& wanted_jobs,
                                                                const v1::ListJobsRequest& request, int limit,
                                                                v1::ListJobsResponse& response) {
  const JobQuery query = of_rows(wanted_jobs, request.queued());
  const auto missing = static_cast<std::size_t>(limit - response.jobs_size());
  const bool is_filtered = query.states != 0 || !request.labels().empty();
  const std::size_t wanted = is_filtered ? std::max(missing, kRowsAtOnce) : missing;
  std::vector<ListedJob> listed;
  std::size_t rows = 0;
  std::optional<std::int64_t> last;
  const auto read = state_.jobs.list_jobs(query, wanted, [&](const store::JobRow& row, std::int64_t number) {
    ++rows;
    last = number;
    // A job whose id is no text cannot be shown.
    if (!farm::is_text(row.id)) return;
    JobSnapshot job = farm::snapshot_of_row(row);
    // A page of specs could be large: they have the warnings of their scenes.
    job.spec = std::make_shared<const v1::Job>(farm::summarise_spec(*job.spec));
    listed.push_back({std::move(job), row.settled, number});
  });
  if (!read) return core::fail(read.error());
  for (ListedJob& each : listed) {
    const std::int64_t number = each.number;
    auto now = current(std::move(each));
    if (!now) return core::fail(now.error());
    if (!*now) continue;
    v1::Job job = summarise(**now);
    if (!matches(job, wanted_jobs.states, request.queued(), request.labels())) continue;
    *response.add_jobs() = std::move(job);
    if (response.jobs_size() == limit) return std::optional(number);
  }
  if (rows < wanted) last.reset();
  return last;
}

// The job as it is in memory. If it is not settled and not there, it has left the memory since its row was
// read, and has another row now, or none.
core::Result<std::optional<JobSnapshot>> JobService::current(ListedJob listed) {
  const std::string id = listed.job.spec->id();
  {
    const farm::StateLock lock(farm_);
    if (const farm::JobRecord* const record = lock->find_job(id))
      return std::optional(JobSnapshot(*record, *lock->scheduler.job({id}, lock.now())));
    if (const farm::ValidatingJob* const job = lock->find_validating(id))
      return std::optional(lock.snapshot_of(*job));
  }
  if (listed.is_settled) return std::optional(std::move(listed.job));
  const auto row = state_.jobs.job(id);
  if (!row) return core::fail(row.error());
  if (!*row) return std::optional<JobSnapshot>();
  return std::optional(farm::snapshot_of_row(**row));
}

std::size_t JobService::count_in_memory() {
  return farm::StateLock(farm_)->jobs.size();
}

}  // namespace tessera::jobs
