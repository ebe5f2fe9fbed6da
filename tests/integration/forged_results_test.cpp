// SPDX-License-Identifier: Apache-2.0
// A worker that renders correctly, flips a bit, and delivers the result with a valid checksum.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>

#include <algorithm>

#include "core/integrators/fingerprint.hpp"
#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"
#include "proto/channel.hpp"
#include "proto/convert.hpp"
#include "proto/tile_codec.hpp"
#include "proto/worker_key.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

class Liar {
 public:
  explicit Liar(const std::string& address, std::string name = "liar")
      : name_(std::move(name)),
        scene_(*core::Scene::build(*core::load_scene_file(kCornell), 1)),
        coordinator_(v1::WorkerService::NewStub(*proto::open_channel(address))) {}

  // Takes a lease and delivers all of it, with a bit flipped in each range. Returns whether there was a
  // lease.
  bool lie() {
    v1::SynchronizeResponse given;
    if (!synchronize(given).ok() || given.leases().empty()) return false;
    for (const v1::JobSpec& job : given.jobs()) settings_ = *proto::from_proto(job.settings());
    v1::SubmitResultRequest result = message();
    lease_ = given.leases(0);
    result.set_job_id(lease_.job_id());
    result.set_lease_id(lease_.id());
    result.set_lease_token(lease_.token());
    result.set_lease_finished(true);
    result.mutable_render_time()->set_nanos(100'000'000);
    for (const v1::WorkItem& item : given.leases(0).items()) *result.add_items() = render_wrongly(item);
    return submit(result).ok();
  }

  // Delivers an invalid message.
  grpc::Status send_garbage() {
    v1::SubmitResultRequest garbage = message();
    garbage.set_job_id(lease_.job_id());
    garbage.set_lease_id(lease_.id());
    garbage.set_lease_token(lease_.token());
    garbage.add_items()->set_planes_zstd("sums");
    return submit(garbage);
  }

  // Delivers a sample of the first tile under another worker's id, with invented sums.
  grpc::Status forge(const std::string& worker_id, const std::string& job_id, std::uint64_t lease) {
    v1::SubmitResultRequest result = message();
    result.set_worker_id(worker_id);
    result.set_job_id(job_id);
    result.set_lease_id(lease);
    core::FilmTile tile({0, 0, 64, 64}, {0, 1});
    tile.sums.assign(tile.sums.size(), 1u << 20);
    tile.counters.samples = 64 * 64;
    *result.add_items() = proto::encode_tile(tile);
    return submit(result);
  }
  grpc::Status synchronize_as(const std::string& worker_id) {
    v1::SynchronizeRequest request = greeting();
    request.set_worker_id(worker_id);
    v1::SynchronizeResponse response;
    return synchronize(request, response);
  }
  // Takes the first lease of the answer. Returns whether there was one.
  bool take(const v1::SynchronizeResponse& given) {
    if (given.leases().empty()) return false;
    lease_ = given.leases(0);
    return true;
  }

  grpc::Status synchronize(v1::SynchronizeResponse& response) { return synchronize(greeting(), response); }

 private:
  v1::SynchronizeRequest greeting() const {
    v1::SynchronizeRequest request;
    request.set_worker_id(id_);
    request.set_worker_key(key_);
    request.set_name(name_);
    request.set_determinism_fingerprint(core::integrators::determinism_fingerprint());
    request.set_threads(1);
    request.set_wanted_leases(1);
    return request;
  }

  grpc::Status synchronize(const v1::SynchronizeRequest& request, v1::SynchronizeResponse& response) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 30s);
    return coordinator_->Synchronize(&context, request, &response);
  }

  v1::SubmitResultRequest message() const {
    v1::SubmitResultRequest request;
    request.set_worker_id(id_);
    request.set_determinism_fingerprint(core::integrators::determinism_fingerprint());
    return request;
  }

  grpc::Status submit(const v1::SubmitResultRequest& request) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + 30s);
    v1::SubmitResultResponse response;
    return coordinator_->SubmitResult(&context, request, &response);
  }

  v1::RenderedItem render_wrongly(const v1::WorkItem& message) const {
    const auto item = *proto::from_proto(message);
    core::FilmTile tile =
        core::integrators::render(core::integrators::prepare(scene_, settings_, 1), item.rect, item.range, 1);
    const std::size_t middle = tile.sums.size() / 2;
    const std::uint64_t flipped = std::uint64_t{1} << 30;
    // Flips a bit of an even sample if there is one. An odd sample counts in both sums.
    if (item.range.odd_count() == item.range.count()) tile.odd_sums[middle] += flipped;
    tile.sums[middle] += flipped;
    return proto::encode_tile(tile);
  }

  const std::string name_;
  const std::string key_ = std::string(proto::kWorkerKeyBytes, '1');
  const std::string id_ = proto::worker_id_of(key_);
  v1::Lease lease_;  // the last
  core::Scene scene_;
  core::RenderSettings settings_;
  std::unique_ptr<v1::WorkerService::StubInterface> coordinator_;
};

class ForgedResultsTest : public FarmTest {
 protected:
  // A worker is listed for ten times as long after its last heartbeat.
  static constexpr double kLeaseSeconds = 20;
  const std::vector<std::string> options_{"--size", "192x128", "--spp", "16"};

  v1::Worker liar() {
    for (const auto& worker : workers()) {
      if (worker.name() == "liar") return worker;
    }
    return {};
  }
  void expect_local_bytes(const std::string& id) {
    EXPECT_TRUE(image(id, ".png") == render_here(options_, ".png"));
    EXPECT_TRUE(image(id, ".exr") == render_here(options_, ".exr"));
  }
};

TEST_F(ForgedResultsTest, AuditsDetectForgedResultsAndTheImageIsThatOfALocalRender) {
  coordinator_options_ = {"--audit", "1"};
  start_coordinator(kLeaseSeconds);
  const std::string id = submit(options_);
  Liar liar_worker(address());
  ASSERT_TRUE(liar_worker.lie());
  ASSERT_TRUE(liar_worker.lie());
  EXPECT_GT(job(id).samples_to_verify(), 0u);
  EXPECT_THAT(tessera({"job", id}).out, HasSubstr("to verify"));
  start_worker("one", 1);
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  expect_local_bytes(id);

  EXPECT_TRUE(liar().quarantined());
  EXPECT_GT(liar().disproved_ranges(), 0u);
  EXPECT_THAT(liar().quarantine_reason(), HasSubstr("it rendered different bits of samples"));
  EXPECT_THAT(tessera({"workers"}).out, HasSubstr("is quarantined: it rendered different bits of samples"));
  v1::SynchronizeResponse none;
  const grpc::Status refused = liar_worker.synchronize(none);
  EXPECT_EQ(refused.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(refused.error_message(), HasSubstr("worker liar is quarantined: it rendered different bits"));
  for (const auto& worker : workers()) {
    if (worker.name() == "liar") continue;
    EXPECT_FALSE(worker.quarantined()) << worker.name();
    EXPECT_EQ(worker.disproved_ranges(), 0u) << worker.name();
  }
}

// Without audits, its wrong samples are in a done image until it is detected.
TEST_F(ForgedResultsTest, SamplesOfAQuarantinedWorkerAreRenderedAgain) {
  start_coordinator(kLeaseSeconds);
  const std::string id = submit(options_);
  Liar liar_worker(address());
  ASSERT_TRUE(liar_worker.lie());
  start_worker("one", 1);
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_FALSE(image(id, ".exr") == render_here(options_, ".exr"));

  v1::SynchronizeResponse nothing;
  EXPECT_TRUE(liar_worker.synchronize(nothing).ok());
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(liar_worker.send_garbage().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  const auto is_mended = [&] {
    return liar().disproved_ranges() > 0 && job(id).state() == v1::JOB_STATE_DONE;
  };
  ASSERT_TRUE(poll_until(60s, is_mended));
  expect_local_bytes(id);
}

// Any caller that reaches the port could try this against another worker.
TEST_F(ForgedResultsTest, ForgedIdsLeasesAndNamesAffectNoOther) {
  coordinator_options_ = {"--audit", "0.02"};
  start_coordinator(kLeaseSeconds);
  Process& one = start_worker("one", 1);
  start_worker("two", 1);
  ASSERT_TRUE(wait_for_workers(2));
  const std::string id = submit({"--size", "192x128", "--spp", "64"});
  ASSERT_TRUE(wait_for_samples(id, 1));

  // Results under the ids of others, and under an unknown id.
  const auto known = workers();
  std::vector<std::string> ids{std::string(32, '7')};
  for (const auto& worker : known) ids.push_back(worker.id());
  Liar liar_worker(address(), "one");  // with an honest worker's name
  for (const std::string& worker_id : ids) {
    for (std::uint64_t lease = 0; lease < 4; ++lease) {
      const grpc::Status status = liar_worker.forge(worker_id, id, (std::uint64_t{1} << 40) + lease);
      EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
    }
  }
  // It cannot call under their ids either, and its own rejections count only against itself.
  for (const auto& worker : known)
    EXPECT_EQ(liar_worker.synchronize_as(worker.id()).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  v1::SynchronizeResponse given;
  EXPECT_TRUE(liar_worker.synchronize(given).ok());
  if (liar_worker.take(given)) {
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(liar_worker.send_garbage().ok());
    EXPECT_EQ(liar_worker.synchronize(given).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  }
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE));
  EXPECT_TRUE(image(id, ".exr") == render_here({"--size", "192x128", "--spp", "64"}, ".exr"));
  for (const auto& worker : workers()) {
    const bool honest =
        std::any_of(known.begin(), known.end(), [&](const auto& k) { return k.id() == worker.id(); });
    if (!honest) continue;
    EXPECT_FALSE(worker.quarantined()) << worker.name();
    EXPECT_EQ(worker.rejected_results(), 0u) << worker.name();
  }
  EXPECT_EQ(one.wait(0s), std::nullopt);
  EXPECT_THAT(coordinator().err(), HasSubstr("rejected a result of job"));
}

}  // namespace
}  // namespace tessera::test
