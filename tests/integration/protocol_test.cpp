// SPDX-License-Identifier: Apache-2.0
// Guarantees to any client of a coordinator: health, reflection, and one determinism fingerprint in a farm.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>

#include "proto/channel.hpp"
#include "proto/worker_key.hpp"
#include "tessera/v1/worker_service.grpc.pb.h"
#include "tests/integration/farm_processes.hpp"
#include "tests/integration/raw_call.hpp"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

TEST_F(FarmTest, HealthIsServed) {
  start_coordinator();
  // HealthCheckResponse{status: SERVING}
  EXPECT_EQ(raw_call(address(), "/grpc.health.v1.Health/Check", "").value_or("failed"), "\x08\x01");
}

TEST_F(FarmTest, ReflectionListsTheServices) {
  start_coordinator();
  // ServerReflectionRequest{list_services: "*"}
  const auto services =
      raw_call(address(), "/grpc.reflection.v1alpha.ServerReflection/ServerReflectionInfo", "\x3a\x01*");
  ASSERT_TRUE(services.has_value()) << services.error().message;
  EXPECT_THAT(*services, HasSubstr("tessera.v1.RenderService"));
  EXPECT_THAT(*services, HasSubstr("tessera.v1.WorkerService"));
}

TEST_F(FarmTest, AWorkerWithAnotherFingerprintIsRejected) {
  start_coordinator();
  start_worker("worker", 1);
  ASSERT_TRUE(wait_for_workers(1));
  submit({"--size", "64x64", "--spp", "100000"});
  const auto other = v1::WorkerService::NewStub(*proto::open_channel(address()));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + 20s);
  v1::SynchronizeRequest request;
  request.set_worker_key(std::string(proto::kWorkerKeyBytes, 'k'));
  request.set_worker_id(proto::worker_id_of(request.worker_key()));
  request.set_name("stranger");
  request.set_determinism_fingerprint("0000000000000000");
  request.set_threads(1);
  request.set_wanted_leases(1);
  v1::SynchronizeResponse response;
  const grpc::Status status = other->Synchronize(&context, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_THAT(status.error_message(), HasSubstr("0000000000000000"));
}

}  // namespace
}  // namespace tessera::test
