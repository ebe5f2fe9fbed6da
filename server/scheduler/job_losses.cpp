// SPDX-License-Identifier: Apache-2.0
// Losses of workers in a job's samples, and refusals of its scene: when these fail the job.
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "server/scheduler/item_text.hpp"
#include "server/scheduler/job.hpp"

namespace tessera::scheduler {
namespace {

constexpr int kRefusalsUntilFailure = 3;
constexpr std::size_t kRefusersUntilFailure = 3;
constexpr std::size_t kPrincipalsUntilFailure = 3;

constexpr const char* kWhatToDoAboutStuck =
    "Render the pixels here to see what keeps them (tessera render SCENE --crop), lower what the scene asks "
    "for there, such as max_depth, or look at how busy the machines are; then submit it again";

std::string names_of(const std::vector<Loss>& losses) {
  std::vector<std::string> names;
  for (const Loss& each : losses) names.push_back(fmt::format("{} ({:.8})", each.name, each.worker.value));
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string sentence_on(const WorkItem& item, const JobGrid& grid, const std::vector<Loss>& losses) {
  const auto is = [](LossKind kind) { return [kind](const Loss& loss) { return loss.kind == kind; }; };
  const bool any_died = std::any_of(losses.begin(), losses.end(), is(LossKind::kDied));
  const bool any_stuck = std::any_of(losses.begin(), losses.end(), is(LossKind::kStuck));
  const char* const what = !any_stuck  ? "died one after the other while they rendered"
                           : !any_died ? "hung one after the other in"
                                       : "died or hung one after the other while they rendered";
  return fmt::format(
      "{} workers {} {}: {}. {}", losses.size(), what, describe_item_with_pixels(grid, item),
      names_of(losses),
      any_stuck ? kWhatToDoAboutStuck
                : "Look into their logs, and whether they have the memory that the scene needs; then submit "
                  "it again");
}

template <typename Names>
std::vector<std::string> first_few(const Names& names) {
  std::vector<std::string> few;
  for (const std::string& name : names)
    if (few.size() < kMaxFailureWorkers) few.push_back(name);
  return few;
}

FailureDetails lost(std::optional<WorkItem> item, const std::vector<Loss>& losses) {
  std::vector<std::string> names;
  for (const Loss& loss : losses) names.push_back(loss.name);
  return {FailureReason::kWorkersLost, item, first_few(names)};
}

// Of three principals, or of all.
bool are_enough(const std::set<std::string>& principals, const AreAll& are_all) {
  return principals.size() >= kPrincipalsUntilFailure || are_all(principals);
}

std::set<std::string> principals_of(const std::vector<Loss>& losses) {
  std::set<std::string> principals;
  for (const Loss& loss : losses) principals.insert(loss.principal);
  return principals;
}

}  // namespace

std::optional<Failure> Job::strike(const Lease& lease, const Loss& loss, const AreAll& principals) {
  for (const WorkItem& item : lease.items) poison_.strike(item, loss, lease.alone);
  // With several items, the cause is unknown.
  return lease.alone ? verdict_on(lease.items.front(), principals) : std::nullopt;
}

std::optional<Failure> Job::strike(const std::vector<WorkItem>& items, const Loss& loss,
                                   const AreAll& principals) {
  std::vector<WorkItem> missing;
  for (const WorkItem& item : items) {
    IntervalSet samples{item.samples};
    // Samples that were rendered do not run for ever.
    samples.remove(done(item.tile));
    for (const core::SampleRange& range : samples.ranges()) missing.push_back({item.tile, range});
  }
  if (missing.empty()) return std::nullopt;
  for (const WorkItem& item : missing) poison_.strike(item, loss, true);
  const auto is_of_name = [&](const Loss& other) {
    return other.name == loss.name && other.principal == loss.principal;
  };
  if (std::none_of(stuck_before_any_.begin(), stuck_before_any_.end(), is_of_name))
    stuck_before_any_.push_back(loss);
  for (const WorkItem& item : missing) {
    if (auto verdict = verdict_on(item, principals)) return verdict;
  }
  return std::nullopt;
}

std::optional<Failure> Job::verdict_on(const WorkItem& item, const AreAll& principals) const {
  PoisonTracker::Part part;
  for (WorkItem rest = item; !rest.samples.empty(); rest.samples.begin = part.samples.end) {
    part = poison_.first_part(rest);
    if (part.losses.size() < kLossesUntilFailure) continue;
    // Another worker that holds the samples may still render them.
    if (leases_.leased(item.tile).intersects(part.samples)) continue;
    if (audit_leases_.leased(item.tile).intersects(part.samples)) continue;
    if (!are_enough(principals_of(part.losses), principals)) continue;
    const WorkItem told{item.tile, poison_.to_be_told(rest)};
    return Failure{sentence_on(told, grid_, part.losses), lost(told, part.losses)};
  }
  return std::nullopt;
}

std::optional<Failure> Job::nobody_gets_on(const AreAll& principals) const {
  if (done_count_ > 0 || lease_count() > 0 || stuck_before_any_.size() < kLossesUntilFailure)
    return std::nullopt;
  if (!are_enough(principals_of(stuck_before_any_), principals)) return std::nullopt;
  return Failure{
      fmt::format("{} workers hung in all samples of it that they held, and none has been rendered: {}. {}",
                  stuck_before_any_.size(), names_of(stuck_before_any_), kWhatToDoAboutStuck),
      lost(std::nullopt, stuck_before_any_)};
}

void Job::withdraw_strikes(const WorkerId& worker, LossKind kind) {
  poison_.withdraw_strikes(worker, kind);
  if (kind == LossKind::kStuck)
    std::erase_if(stuck_before_any_, [&](const Loss& loss) { return loss.worker == worker; });
}

std::optional<Failure> Job::decline_reason(const Refuser& refuser, const std::string& why,
                                           const AreAll& names, const AreAll& principals) {
  ++refusals_;
  refusers_.insert(refuser.name);
  refusing_principals_.insert(refuser.principal);
  refusing_workers_.insert(refuser.worker);
  if (refusals_ < kRefusalsUntilFailure) return std::nullopt;
  const auto nobody_else = [&] {
    return names(refusers_) &&
           std::all_of(lease_counts_.begin(), lease_counts_.end(),
                       [&](const auto& entry) { return refusing_workers_.contains(entry.first); });
  };
  if (refusers_.size() < kRefusersUntilFailure && !nobody_else()) return std::nullopt;
  if (!are_enough(refusing_principals_, principals)) return std::nullopt;
  return Failure{
      fmt::format(
          "{} times in a row a worker could not build the scene, the last of them {}, which says: \"{}\". "
          "Mend "
          "that, or give the workers the release and the memory that the scene needs; then submit it again",
          refusals_, refuser.name, why),
      {FailureReason::kDeclined, std::nullopt, first_few(refusers_)}};
}

}  // namespace tessera::scheduler
