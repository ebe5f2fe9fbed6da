// SPDX-License-Identifier: Apache-2.0
#include "server/coordinator.hpp"

#include <spdlog/spdlog.h>

#include <utility>

#include "server/jobs/restore.hpp"

namespace tessera::server {

namespace {

// The signer must outlive the farm.
farm::Options with_store(farm::Options options, const store::JobStore& store,
                         const dispatch::LeaseSigner& signer) {
  options.epoch = store.epoch();
  options.sign = [&signer](scheduler::LeaseId lease, const scheduler::WorkerId& holder,
                           const scheduler::JobId& job) { return signer.sign(lease, holder, job); };
  return options;
}

}  // namespace

Coordinator::Coordinator(const CoordinatorOptions& options, store::StateDirectory state,
                         jobs::SceneCheck check_scene)
    : state_(std::move(state)),
      files_(state_.blobs, {options.limits, options.keep_unused_blobs, options.farm.now,
                            [this](const blobs::TakeBundle& take) { return for_each_bundle(take); }}),
      film_memory_(options.limits.film_bytes()),
      fingerprinter_(state_.jobs.secret()),
      signer_(state_.jobs.secret()),
      farm_(with_store(options.farm, state_.jobs, signer_)),
      films_(state_.jobs, film_memory_, fingerprinter_, farm_.events().counter()),
      jobs_(farm_, state_, files_, films_, film_memory_, options.limits,
            jobs::counted(std::move(check_scene), validations_)),
      images_(farm_, state_.jobs, films_, state_.folder),
      checkpointer_(farm_, state_.jobs, files_, films_, film_memory_, fingerprinter_),
      dispatcher_(farm_, film_memory_, fingerprinter_, signer_),
      fleet_(farm_, state_.jobs),
      farm_feed_(farm_.events(), jobs_, dispatcher_),
      tile_feed_(farm_, films_, state_.jobs) {}

Coordinator::~Coordinator() {
  close();
}

core::Result<std::unique_ptr<Coordinator>> Coordinator::open(const CoordinatorOptions& options,
                                                             store::StateDirectory state,
                                                             jobs::SceneCheck check_scene) {
  std::unique_ptr<Coordinator> coordinator(
      new Coordinator(options, std::move(state), std::move(check_scene)));
  Coordinator& self = *coordinator;
  if (const auto& torn_end = self.state_.jobs.torn_end())
    spdlog::warn("{}: continuing with what was written before", *torn_end);
  jobs::Restoration restoration(self.farm_, self.state_, self.files_, self.films_, options.limits);
  if (auto restored = restoration.restore_all(); !restored) return core::fail(restored.error());
  if (auto restored = self.fleet_.restore(); !restored) return core::fail(restored.error());
  return coordinator;
}

// Also those of damaged rows, as far as they can be read: a later start may recover the jobs.
core::Status Coordinator::for_each_bundle(const blobs::TakeBundle& take) {
  return state_.jobs.for_each_job([&](const store::JobRow& row) {
    if (const auto spec = farm::spec_from_row(row)) take((*spec)->owner(), (*spec)->bundle());
  });
}

void Coordinator::close() {
  jobs_.close();
  dispatcher_.close();
}

}  // namespace tessera::server
