// SPDX-License-Identifier: Apache-2.0
#include "server/farm/farm.hpp"

#include <utility>

#include "server/base/random.hpp"

namespace tessera::farm {

namespace {

scheduler::Options scheduler_options(const Options& options) {
  scheduler::Options result;
  result.epoch = options.epoch;
  result.lease_duration = options.lease_duration;
  result.forget_after = options.forget_after();
  result.audit_share = options.audit_share;
  result.audit_secret = base::random_number();
  if (options.sign) result.sign = options.sign;
  return result;
}

}  // namespace

std::vector<std::chrono::nanoseconds> Farm::hold_bounds() {
  using std::chrono::microseconds;
  using std::chrono::milliseconds;
  return {microseconds(10),  microseconds(25),  microseconds(50),  microseconds(100),
          microseconds(250), microseconds(500), milliseconds(1),   microseconds(2500),
          milliseconds(5),   milliseconds(10),  milliseconds(25),  milliseconds(50),
          milliseconds(100), milliseconds(250), milliseconds(500), milliseconds(1000)};
}

std::vector<std::chrono::nanoseconds> Farm::first_samples_bounds() {
  using std::chrono::milliseconds;
  using std::chrono::seconds;
  return {milliseconds(100), milliseconds(250), milliseconds(500), seconds(1),
          seconds(2),        seconds(5),        seconds(10),       seconds(30),
          seconds(60),       seconds(300),      seconds(1800),     seconds(7200)};
}

State::State(const Options& options) : scheduler(scheduler_options(options)) {}

JobRecord* State::find_job(const std::string& id) {
  const auto found = jobs.find(id);
  return found == jobs.end() ? nullptr : &found->second;
}

const JobRecord* State::find_job(const std::string& id) const {
  const auto found = jobs.find(id);
  return found == jobs.end() ? nullptr : &found->second;
}

void State::add_job(JobRecord record) noexcept {
  const std::string id = record.spec->id();
  if (!record.request_id.empty()) job_of_request[record.request_id] = id;
  JobRecord& added = jobs.emplace(id, std::move(record)).first->second;
  set_open(added, !is_finished(scheduler.job({id}, {})->state));
}

std::map<std::string, JobRecord>::node_type State::remove_job(const std::string& id) {
  auto removed = jobs.extract(id);
  JobRecord& record = removed.mapped();
  job_of_request.erase(record.request_id);
  set_open(record, false);
  return removed;
}

ValidatingJob* State::find_validating(const std::string& id) {
  const auto found = validating.find(id);
  return found == validating.end() ? nullptr : &found->second;
}

const ValidatingJob* State::find_validating(const std::string& id) const {
  const auto found = validating.find(id);
  return found == validating.end() ? nullptr : &found->second;
}

ValidatingJob& State::add_validating(ValidatingJob job) noexcept {
  const std::string id = job.spec->id();
  if (!job.request_id.empty()) job_of_request[job.request_id] = id;
  count_open_job(job.spec->owner(), 1);
  validating_order.insert(job.revision);
  return validating.emplace(id, std::move(job)).first->second;
}

std::map<std::string, ValidatingJob>::node_type State::remove_validating(const std::string& id) {
  auto removed = validating.extract(id);
  job_of_request.erase(removed.mapped().request_id);
  count_open_job(removed.mapped().spec->owner(), -1);
  validating_order.erase(removed.mapped().revision);
  return removed;
}

void State::set_open(JobRecord& record, bool is_open) {
  if (record.is_open == is_open) return;
  record.is_open = is_open;
  count_open_job(record.spec->owner(), is_open ? 1 : -1);
}

void State::count_open_job(const std::string& owner, int change) {
  const auto count = open_jobs.try_emplace(owner).first;
  count->second += change;
  if (count->second == 0) open_jobs.erase(count);
}

}  // namespace tessera::farm
