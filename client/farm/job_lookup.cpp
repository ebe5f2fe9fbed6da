// SPDX-License-Identifier: Apache-2.0
#include "client/farm/job_lookup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "client/farm/job_text.hpp"

namespace tessera::client {

namespace {

// The number of matches that shows that a prefix is ambiguous.
constexpr std::uint32_t kEnoughToTell = 2;

constexpr std::size_t kPageSize = 1000;

}  // namespace

void add_job_argument(CLI::App& command, std::string& id_or_prefix) {
  command.add_option("JOB", id_or_prefix, "Id of the job, or its first digits")->required();
}

core::Result<v1::Job> find_job(Farm& farm, const std::string& id_or_prefix) {
  v1::ListJobsRequest request;
  request.set_id_prefix(id_or_prefix);
  request.set_page_size(kEnoughToTell);
  const auto list = farm.call(&Farm::Stub::ListJobs, request);
  if (!list) return core::fail(list.error());
  std::vector<v1::Job> matches;  // coordinators of earlier releases return all jobs
  for (const v1::Job& job : list->jobs()) {
    if (job.id() == id_or_prefix) return job;
    if (!id_or_prefix.empty() && job.id().starts_with(id_or_prefix)) matches.push_back(job);
  }
  if (matches.empty())
    return core::fail(core::ErrorCode::kNotFound,
                      fmt::format("the farm at {} has no job '{}': tessera jobs lists those it has",
                                  farm.address(), id_or_prefix));
  if (matches.size() > 1)
    return core::fail(core::ErrorCode::kInvalidArgument,
                      fmt::format("'{}' could be job {} or job {}: give more of its digits", id_or_prefix,
                                  short_id(matches[0].id()), short_id(matches[1].id())));
  return matches[0];
}

core::Result<v1::ListJobsResponse> list_jobs(Farm& farm, v1::ListJobsRequest request, std::size_t limit) {
  v1::ListJobsResponse all;
  do {
    const std::size_t rest = limit - static_cast<std::size_t>(all.jobs_size());
    request.set_page_size(static_cast<std::uint32_t>(std::min<std::size_t>(rest, kPageSize)));
    auto page = farm.call(&Farm::Stub::ListJobs, request);
    if (!page) return core::fail(page.error());
    for (v1::Job& job : *page->mutable_jobs())
      if (static_cast<std::size_t>(all.jobs_size()) < limit) *all.add_jobs() = std::move(job);
    request.set_page_token(page->next_page_token());
  } while (!request.page_token().empty() && static_cast<std::size_t>(all.jobs_size()) < limit);
  return all;
}

}  // namespace tessera::client
