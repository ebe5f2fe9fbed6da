// SPDX-License-Identifier: Apache-2.0
// What the job store reads.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "server/store/job_store_impl.hpp"
#include "server/store/row_codec.hpp"

namespace tessera::store {

using core::ErrorCode;

namespace {

constexpr int kTargetsColumn = 20, kBundleColumn = 21;

// One row, or none.
core::Result<std::optional<JobRow>> read_one(Statement& statement) {
  const ResetAtEnd at_end(statement);
  const auto row = statement.step();
  if (!row) return core::fail(row.error());
  if (!*row) return std::optional<JobRow>();
  return std::optional(read_job(statement));
}

core::Result<std::vector<JobRow>> read_all(Statement& statement) {
  std::vector<JobRow> rows;
  const auto read = for_each_row(statement, [&] { rows.push_back(read_job(statement)); });
  if (!read) return core::fail(read.error());
  return rows;
}

core::Result<std::vector<std::string>> read_ids(Statement& statement) {
  std::vector<std::string> ids;
  const auto read = for_each_row(statement, [&] { ids.emplace_back(statement.bytes(0)); });
  if (!read) return core::fail(read.error());
  return ids;
}

// The least text that is greater than every text with this prefix, which is a part of an id. Empty: there is
// none.
std::string end_of_prefix(std::string prefix) {
  while (!prefix.empty() && prefix.back() == '\xff') prefix.pop_back();
  if (!prefix.empty()) prefix.back() = static_cast<char>(prefix.back() + 1);
  return prefix;
}

}  // namespace

JobRow read_job(const Statement& row) {
  JobRow job;
  job.id = row.bytes(0);
  job.request_id = row.bytes(1);
  job.spec = row.bytes(2);
  job.revision = as_unsigned(row.integer(3));
  job.state = static_cast<int>(row.integer(4));
  job.failure = row.bytes(5);
  job.spp = static_cast<std::uint32_t>(row.integer(6));
  job.priority = static_cast<int>(row.integer(7));
  job.created_ms = row.integer(8);
  if (!row.is_null(9)) job.finished_ms = row.integer(9);
  job.counters = row.bytes(10);
  job.arithmetic = row.bytes(11);
  job.max_workers = static_cast<std::uint32_t>(row.integer(12));
  job.failure_details = row.bytes(14);
  job.submission = row.bytes(15);
  job.owner = row.bytes(16);
  job.producers = row.bytes(17);
  job.settled = row.integer(18) != 0;
  std::optional<std::uint64_t> bundle_sum;
  if (!row.is_null(19)) bundle_sum = as_unsigned(row.integer(19));
  job.targets = row.bytes(kTargetsColumn);
  const bool has_bundle = !row.is_null(kBundleColumn);
  if (has_bundle) job.bundle = row.bytes(kBundleColumn);
  // Rows of the first release have no sum.
  const bool is_row_intact = row.is_null(13) || as_unsigned(row.integer(13)) == row_checksum(job, bundle_sum);
  job.intact = is_row_intact && (!has_bundle || bundle_checksum(job.bundle) == bundle_sum);
  return job;
}

core::Result<std::vector<JobRow>> JobStore::jobs() {
  const core::MutexLock lock(impl_->reading);
  return read_all(impl_->reader.list_jobs);
}

core::Result<std::vector<std::string>> JobStore::unsettled_jobs() {
  const core::MutexLock lock(impl_->reading);
  return read_ids(impl_->reader.unsettled_jobs);
}

core::Result<std::optional<JobRow>> JobStore::job(const std::string& id) {
  const core::MutexLock lock(impl_->reading);
  return read_one(impl_->reader.job.bind_text(1, id));
}

core::Result<std::optional<JobRow>> JobStore::job_of_request(const std::string& request_id) {
  const core::MutexLock lock(impl_->reading);
  return read_one(impl_->reader.job_of_request.bind_text(1, request_id));
}

core::Status JobStore::list_jobs(const JobQuery& query, std::size_t limit,
                                 const std::function<void(JobRow, std::int64_t)>& take) {
  const core::MutexLock lock(impl_->reading);
  Statement& page = query.id_prefix.empty() ? impl_->reader.page : impl_->reader.page_of_prefix;
  constexpr auto kMax = std::numeric_limits<std::int64_t>::max();
  page.bind(1, query.before_number.value_or(kMax));
  page.bind(2, query.created_from_ms.value_or(std::numeric_limits<std::int64_t>::min()));
  page.bind(3, query.created_before_ms.value_or(kMax));
  query.owner ? page.bind_text(4, *query.owner) : page.bind_null(4);
  page.bind(5, query.states).bind(6, static_cast<std::int64_t>(limit));
  const std::string end = end_of_prefix(query.id_prefix);
  if (!query.id_prefix.empty()) page.bind_text(7, query.id_prefix).bind_text(8, end);
  return for_each_row(page, [&] { take(read_job(page), page.integer(kBundleColumn + 1)); });
}

core::Status JobStore::for_each_job(const std::function<void(const JobRow&)>& take) {
  for (std::int64_t last = 0;;) {
    std::optional<JobRow> row;
    {
      const core::MutexLock lock(impl_->reading);
      Statement& next = impl_->reader.next_job.bind(1, last);
      const ResetAtEnd at_end(next);
      const auto found = next.step();
      if (!found) return core::fail(found.error());
      if (!*found) return {};
      row = read_job(next);
      last = next.integer(kBundleColumn + 1);
    }
    take(*row);
  }
}

core::Result<std::uint64_t> JobStore::settled_count() {
  const core::MutexLock lock(impl_->reading);
  Statement& count = impl_->reader.settled_count;
  const ResetAtEnd at_end(count);
  const auto row = count.step();
  if (!row) return core::fail(row.error());
  return static_cast<std::uint64_t>(count.integer(0));
}

core::Result<std::vector<std::string>> JobStore::first_settled(std::optional<std::int64_t> finished_before_ms,
                                                               std::size_t limit) {
  const core::MutexLock lock(impl_->reading);
  Statement& first = impl_->reader.first_settled;
  first.bind(1, finished_before_ms.value_or(std::numeric_limits<std::int64_t>::max()));
  first.bind(2, static_cast<std::int64_t>(limit));
  return read_ids(first);
}

core::Result<std::map<int, std::vector<core::SampleRange>>> JobStore::tiles_done(const std::string& job_id) {
  const core::MutexLock lock(impl_->reading);
  std::map<int, std::vector<core::SampleRange>> tiles;
  Statement& list = impl_->reader.tiles_done.bind_text(1, job_id);
  const auto read =
      for_each_row(list, [&] { tiles[static_cast<int>(list.integer(0))] = decode_ranges(list.bytes(1)); });
  if (!read) return core::fail(read.error());
  return tiles;
}

core::Result<std::vector<TileChange>> JobStore::tile_changes(const std::string& job_id, std::uint64_t since,
                                                             std::size_t most, int first, int end) {
  const core::MutexLock lock(impl_->reading);
  std::vector<TileChange> changes;
  Statement& list = impl_->reader.tile_changes.bind_text(1, job_id).bind(2, as_signed(since));
  list.bind(3, static_cast<std::int64_t>(std::min<std::size_t>(most, std::numeric_limits<int>::max())));
  list.bind(4, first).bind(5, end);
  const auto read = for_each_row(list, [&] {
    changes.push_back({as_unsigned(list.integer(0)), static_cast<int>(list.integer(1))});
  });
  if (!read) return core::fail(read.error());
  return changes;
}

core::Result<std::optional<TileRow>> JobStore::tile(const std::string& job_id, int tile) {
  const core::MutexLock lock(impl_->reading);
  Statement& read = impl_->reader.read_tile.bind_text(1, job_id).bind(2, tile);
  const ResetAtEnd at_end(read);
  const auto row = read.step();
  if (!row) return core::fail(row.error());
  if (!*row) return std::optional<TileRow>();
  TileRow found{job_id, tile, decode_ranges(read.bytes(0)), std::string(read.bytes(1))};
  if (as_unsigned(read.integer(2)) == row_checksum(found, read.bytes(0)))
    return std::optional(std::move(found));
  return core::fail(ErrorCode::kDataLoss,
                    fmt::format("{}: tile {} of job {} is damaged", impl_->file.string(), tile, job_id));
}

}  // namespace tessera::store
