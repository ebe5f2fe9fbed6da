// SPDX-License-Identifier: Apache-2.0
#include "server/admin/state_check.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/printable.hpp"
#include "proto/blob.hpp"
#include "server/admin/backup_list.hpp"
#include "server/farm/job_record.hpp"
#include "server/farm/validating_job.hpp"
#include "server/farm/wire.hpp"
#include "server/film/stored_tile.hpp"
#include "server/store/log_damage.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::admin {

namespace {

BlobStates check_blobs(const blobs::BlobStore& blobs) {
  BlobStates states;
  for (const proto::Digest& digest : blobs.list()) states[digest.hex()] = blobs.check(digest);
  return states;
}

bool is_unfinished(int state) {
  return !farm::is_finished(farm::from_wire(static_cast<v1::JobState>(state)));
}

// What happens to a damaged tile of a job in this state.
const char* advice_for_tile(int state) {
  if (is_unfinished(state)) return "it is rendered again at the next start";
  if (state == v1::JOB_STATE_DONE) return "--salvage has it rendered again";
  return "it is lost, since the job is not rendered any more: submit the scene again";
}

void check_assets(const v1::Bundle& bundle, const BlobStates& blobs, bool unfinished, JobFindings& findings) {
  const char* const advice = unfinished ? "submit the scene again: its files are sent again"
                                        : "the image is not affected, but cannot be extended";
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto digest = proto::from_proto(asset.digest());
    const auto known = digest ? blobs.find(digest->hex()) : blobs.end();
    if (known != blobs.end() && known->second) continue;
    const std::string how = known == blobs.end() ? "is missing" : known->second.error().message;
    findings.damage.push_back(fmt::format("its file {}: {}; {}", asset.path(), how, advice));
  }
}

void check_tiles(store::JobStore& jobs, const store::JobRow& row, const v1::Job& spec,
                 JobFindings& findings) {
  const auto done = jobs.tiles_done(row.id);
  if (!done) {
    findings.damage.push_back("its tiles cannot be listed: " + done.error().message);
    return;
  }
  const scheduler::JobGrid grid = farm::grid_of(spec);
  for (const auto& [tile, ranges] : *done) {
    const auto stored = film::read_stored_tile(jobs, row.id, grid, tile, farm::layers_of(spec));
    if (stored) {
      findings.samples_done += stored->content.sums.samples * grid.rect(tile).pixel_count();
    } else {
      findings.damage.push_back(fmt::format("{}: {}", stored.error().message, advice_for_tile(row.state)));
    }
  }
}

JobFindings check_job(store::JobStore& jobs, const store::JobRow& row, const BlobStates& blobs,
                      std::set<std::string>& files) {
  JobFindings findings;
  findings.id = row.id;
  const auto job = farm::spec_from_row(row);
  if (!job) {
    findings.name = "?";
    findings.state = "?";
    findings.damage.push_back(job.error().message);
    return findings;
  }
  const v1::Job& spec = **job;
  findings.name = spec.name();
  findings.state = row.state == v1::JOB_STATE_VALIDATING
                       ? "validating"
                       : scheduler::job_state_name(farm::from_wire(static_cast<v1::JobState>(row.state)));
  findings.samples_total = farm::shape_of(spec, row).pixel_samples();
  for (const v1::Bundle::Asset& asset : spec.bundle().assets()) {
    if (const auto digest = proto::from_proto(asset.digest())) files.insert(digest->hex());
  }
  check_tiles(jobs, row, spec, findings);
  check_assets(spec.bundle(), blobs, is_unfinished(row.state), findings);
  return findings;
}

// A start looks at jobs that are not settled.
void note_missing_samples(const store::JobRow& row, JobFindings& job, StateFindings& findings) {
  if (row.settled)
    job.damage.push_back("some of its tiles are missing: --salvage has them rendered again");
  else
    findings.notes.push_back(
        fmt::format("samples of job {} are missing: the next start renders them again", job.id));
}

void check_jobs(const std::filesystem::path& database, const BlobStates& blobs, StateFindings& findings) {
  auto jobs = store::JobStore::open_read_only(database);
  if (!jobs) return findings.damage.push_back(jobs.error().message);
  const auto damage = jobs->structural_damage();
  if (!damage) findings.damage.push_back(damage.error().message);
  for (const std::string& each : damage.value_or(std::vector<std::string>{}))
    findings.damage.push_back(fmt::format("{}: {}: --salvage keeps what is whole", database.string(), each));
  if (jobs->epoch() == 0)
    findings.damage.push_back(fmt::format(
        "{} has lost the count of its starts: --salvage goes on from a greater one", database.string()));
  const auto readable = jobs->readable_jobs();
  if (!readable) return findings.damage.push_back(readable.error().message);
  if (readable->unreadable > 0)
    findings.damage.push_back(fmt::format("{}: {} or more jobs cannot be read: --salvage keeps the others",
                                          database.string(), readable->unreadable));
  for (const store::JobRow& row : readable->rows) {
    JobFindings& job = findings.jobs.emplace_back(check_job(*jobs, row, blobs, findings.files));
    if (row.state == v1::JOB_STATE_DONE && job.damage.empty() && job.samples_done < job.samples_total)
      note_missing_samples(row, job, findings);
  }
}

void note_leftovers(const std::filesystem::path& folder, const blobs::BlobStore& blobs,
                    StateFindings& findings) {
  std::error_code missing;
  const auto log = store::log_of(folder / store::kDatabaseName);
  if (std::filesystem::file_size(log, missing) > 0 && !missing)
    findings.notes.push_back(fmt::format("the coordinator did not end by itself: the next start takes in {}",
                                         log.filename().string()));
  if (const auto looked = store::look_at_log(log); looked && looked->torn_end)
    findings.notes.push_back(*looked->torn_end + ": the next start goes on from what was written before");
  if (const auto interrupted = blobs.interrupted(); !interrupted.empty())
    findings.notes.push_back(
        fmt::format("{} interrupted uploads: the next start removes them", interrupted.size()));
}

}  // namespace

bool StateFindings::whole() const {
  return damage.empty() &&
         std::all_of(jobs.begin(), jobs.end(), [](const JobFindings& job) { return job.damage.empty(); });
}

StateFindings check_database(const std::filesystem::path& database, const BlobStates& blobs) {
  StateFindings findings;
  findings.blobs = blobs.size();
  check_jobs(database, blobs, findings);
  return findings;
}

core::Result<StateFindings> check_state(const std::filesystem::path& folder) {
  const auto lock = store::lock_existing_state(folder);
  if (!lock) return core::fail(lock.error());
  const auto blobs = blobs::BlobStore::look_at(folder / store::kBlobsName);
  const BlobStates states = check_blobs(blobs);
  StateFindings findings = check_database(folder / store::kDatabaseName, states);
  for (const auto& [hex, state] : states) {
    if (state || findings.files.contains(hex)) continue;
    findings.damage.push_back(
        fmt::format("{}; no job that can be read needs it: remove the file", state.error().message));
  }
  note_leftovers(folder, blobs, findings);
  if (is_backup(folder))
    if (const auto files = read_whole_backup(folder); !files)
      findings.damage.push_back(files.error().message);
  return findings;
}

std::string to_text(const StateFindings& findings) {
  std::string text;
  for (const JobFindings& job : findings.jobs) {
    text += fmt::format("job {}  {}, {}, {} of {} samples: {}\n", core::printable(job.id),
                        core::printable(job.name), job.state, job.samples_done, job.samples_total,
                        job.damage.empty() ? "whole" : "DAMAGED");
    for (const std::string& damage : job.damage) text += "  " + core::printable(damage) + "\n";
  }
  for (const std::string& damage : findings.damage) text += "DAMAGED: " + core::printable(damage) + "\n";
  for (const std::string& note : findings.notes) text += "note: " + core::printable(note) + "\n";
  const auto damaged = std::count_if(findings.jobs.begin(), findings.jobs.end(),
                                     [](const JobFindings& job) { return !job.damage.empty(); });
  return text + (findings.whole() ? fmt::format("everything is whole: {} jobs, {} files\n",
                                                findings.jobs.size(), findings.blobs)
                                  : fmt::format("not everything is whole: {} of {} jobs are damaged\n",
                                                damaged, findings.jobs.size()));
}

}  // namespace tessera::admin
