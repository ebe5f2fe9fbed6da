// SPDX-License-Identifier: Apache-2.0
// Reads the jobs of a damaged file row by row.
#include <algorithm>
#include <set>
#include <utility>

#include "server/store/job_store_impl.hpp"

namespace tessera::store {

namespace {

// Scans the table itself and its indexes, which name its rows as well, each as far as it can be read.
constexpr const char* kTableScans[] = {"SELECT rowid FROM jobs NOT INDEXED ORDER BY rowid",
                                       "SELECT rowid FROM jobs NOT INDEXED ORDER BY rowid DESC"};
constexpr const char* kIndexScans[] = {
    "SELECT rowid FROM jobs INDEXED BY sqlite_autoindex_jobs_1 ORDER BY id",
    "SELECT rowid FROM jobs INDEXED BY sqlite_autoindex_jobs_1 ORDER BY id DESC"};
// Rows are numbered from 1. Numbers up to this that no scan found are tried, too.
constexpr std::int64_t kMaxTried = 1'000'000;

struct RowidScan {
  std::set<std::int64_t> rowids;
  core::Status complete;  // or why some may be missing
};

core::Status scan_rowids(Database& database, const char* sql, std::set<std::int64_t>& rowids) {
  auto statement = database.prepare(sql);
  if (!statement) return core::fail(statement.error());
  return for_each_row(*statement, [&] { rowids.insert(statement->integer(0)); });
}

ReadableJobs by_age(ReadableJobs jobs) {
  std::stable_sort(jobs.rows.begin(), jobs.rows.end(),
                   [](const JobRow& a, const JobRow& b) { return a.created_ms < b.created_ms; });
  return jobs;
}

RowidScan scan_jobs(Database& database) {
  RowidScan scan;
  for (const char* const sql : kTableScans) {
    scan.complete = scan_rowids(database, sql, scan.rowids);
    if (scan.complete) return scan;
  }
  for (const char* const sql : kIndexScans)
    [[maybe_unused]] const auto as_far_as_it_goes = scan_rowids(database, sql, scan.rowids);
  return scan;
}

}  // namespace

core::Result<ReadableJobs> JobStore::readable_jobs() {
  const core::MutexLock lock(impl_->reading);
  Reader& reader = impl_->reader;
  const RowidScan scan = scan_jobs(reader.database);
  core::Status complete = scan.complete;
  ReadableJobs jobs;
  const auto read = [&](std::int64_t rowid) TESSERA_REQUIRES(impl_->reading) {
    Statement& statement = reader.read_job.bind(1, rowid);
    const auto row = statement.step();
    if (!row) complete = core::fail(row.error());
    const bool is_here = row && *row;
    if (is_here) jobs.rows.push_back(read_job(statement));
    statement.reset();
    return is_here;
  };
  for (const std::int64_t rowid : scan.rowids) jobs.unreadable += read(rowid) ? 0 : 1;
  if (!scan.complete && !scan.rowids.empty()) {
    for (std::int64_t rowid = 1; rowid <= std::min(*scan.rowids.rbegin(), kMaxTried); ++rowid)
      if (!scan.rowids.contains(rowid)) read(rowid);
  }
  if (complete) return by_age(std::move(jobs));
  if (jobs.rows.empty()) return core::fail(complete.error());
  jobs.unreadable = std::max<std::size_t>(jobs.unreadable, 1);
  return by_age(std::move(jobs));
}

}  // namespace tessera::store
