// SPDX-License-Identifier: Apache-2.0
// A coordinator on a fake clock without threads or sockets, and a worker that answers with ready-made tiles.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "server/coordinator.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::server {

// Sums that depend only on image, pixel and sample, like those of a render.
core::FilmTile ready_made_tile(const core::PixelRect& rect, core::SampleRange range, std::uint32_t image = 0);
v1::RenderedItem ready_made_item(const v1::WorkItem& item);
// The image that the farm must produce.
core::Image ready_made_image(const core::PixelRect& window, std::uint32_t spp, std::uint32_t image = 0);
core::Image ready_made_image(int width_px, int height_px, std::uint32_t spp);

// Accepts any scene: 150 x 100 pixels, 6 samples per pixel, overrides applied. 3 x 2 tiles, of which 4 are
// cropped.
core::Result<jobs::CheckedScene> accept_scene(const v1::Bundle& bundle, const v1::RenderOverrides& overrides,
                                              const std::vector<std::int32_t>& frames = {},
                                              const std::stop_token& stop = {});
inline constexpr int kWidthPx = 150, kHeightPx = 100;
inline constexpr std::uint32_t kSpp = 6;
inline constexpr std::uint64_t kSamples = std::uint64_t{kWidthPx} * kHeightPx * kSpp;

// The determinism fingerprint of the workers in these farms.
inline const std::string kFingerprint = "f00d";

inline const std::string kSceneBytes = "{}";
v1::SubmitJobRequest submission();
v1::SynchronizeRequest greeting(char worker);
v1::SubmitResultRequest delivery(char worker, const v1::Lease& lease);

// With the worker's key, and the id that follows from it, as the network service requires.
v1::SynchronizeRequest greeting_with_key(char worker);
v1::SubmitResultRequest delivery_with_key(char worker, const v1::Lease& lease);

class ScriptedFarm : public testing::Test {
 protected:
  ScriptedFarm();

  // Closes the coordinator, if there is one, and opens one on `folder`.
  void open(const std::filesystem::path& folder);
  void open() { open(folder_.path() / "state"); }
  // Stores the file of the jobs that are submitted.
  void store_scene();
  Coordinator& coordinator() { return *coordinator_; }

  // Submits a job and validates its scene. Returns the job's id.
  std::string submit(const v1::SubmitJobRequest& request = submission(), const std::string& owner = {});
  // Why a job is refused: the error of its submission, or the failure of its validation with the code of the
  // error.
  core::Error refusal(const v1::SubmitJobRequest& request = submission(), const std::string& owner = {});
  v1::Job job(const std::string& id);
  // The same after a checkpoint, which publishes the job's completion.
  v1::Job stored_job(const std::string& id);
  // One page of jobs.
  std::vector<v1::Job> listed(const v1::ListJobsRequest& request = {});
  // Returns the answer, which must be immediate.
  v1::SynchronizeResponse synchronize(const v1::SynchronizeRequest& request,
                                      farm::WorkerPrincipal principal = {});
  v1::SubmitResultResponse deliver(const v1::SubmitResultRequest& request);
  // Renders and delivers leases until there are none; at most `leases` of them.
  void work(char worker, int leases = 1'000'000);

  TemporaryFolder folder_;
  scheduler::Time now_{std::chrono::hours(1)};
  jobs::SceneCheck check_scene_ = accept_scene;
  server::Limits limits_;
  double audit_share_ = 0;  // of the next coordinator
  // By which the next coordinator measures how long the state lock is held.
  std::function<std::chrono::nanoseconds()> hold_clock_ = farm::Options().hold_clock;
  std::set<std::string> fingerprints_{kFingerprint};  // of the next coordinator
  std::unique_ptr<Coordinator> coordinator_;
};

// A call of Synchronize that may wait.
class WaitingCall {
 public:
  WaitingCall(Coordinator& coordinator, const v1::SynchronizeRequest& request,
              farm::WorkerPrincipal principal = {});

  // The caller disconnects.
  void leave() { *gone_ = true; }
  bool answered() const { return answer_->has_value(); }
  const core::Result<v1::SynchronizeResponse>& answer() const { return **answer_; }

 private:
  std::shared_ptr<std::optional<core::Result<v1::SynchronizeResponse>>> answer_;
  std::shared_ptr<bool> gone_ = std::make_shared<bool>(false);
};

}  // namespace tessera::server
