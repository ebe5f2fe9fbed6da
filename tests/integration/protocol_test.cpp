// SPDX-License-Identifier: Apache-2.0
// Guarantees to any client of a coordinator: health, reflection, and one determinism fingerprint in a farm.
#include <gmock/gmock.h>
#include <grpcpp/client_context.h>

#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "proto/blob.hpp"
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
  // HealthCheckRequest{service: "…"}; an empty one asks about the whole server.
  for (const std::string service : {"", "tessera.v1.RenderService", "tessera.v1.WorkerService"}) {
    const std::string request =
        service.empty() ? "" : "\n" + std::string(1, static_cast<char>(service.size())) + service;
    EXPECT_EQ(raw_call(address(), "/grpc.health.v1.Health/Check", request).value_or("failed"), "\x08\x01");
  }
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

// What clients in other languages read, byte by byte.
TEST_F(FarmTest, ErrorsHaveDetailsForPrograms) {
  start_coordinator();
  v1::SubmitJobRequest request;
  request.mutable_bundle()->set_scene_path("scene.json");
  v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
  asset.set_path("scene.json");
  const proto::Digest digest = proto::digest_of("never sent");
  *asset.mutable_digest() = proto::to_proto(digest);
  grpc::ClientContext context;
  v1::SubmitJobResponse response;
  const grpc::Status status = api().SubmitJob(&context, request, &response);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  const auto& trailing = context.GetServerTrailingMetadata();
  ASSERT_TRUE(trailing.contains("grpc-status-details-bin"));
  google::rpc::Status details;
  ASSERT_TRUE(details.ParseFromString(status.error_details()));
  EXPECT_EQ(details.code(), status.error_code());
  EXPECT_EQ(details.message(), status.error_message());
  google::rpc::ErrorInfo info;
  google::rpc::PreconditionFailure failure;
  ASSERT_EQ(details.details_size(), 2);
  ASSERT_TRUE(details.details(0).UnpackTo(&info) && details.details(1).UnpackTo(&failure));
  EXPECT_EQ(details.details(1).type_url(), "type.googleapis.com/google.rpc.PreconditionFailure");
  EXPECT_EQ(info.domain(), "tessera");
  EXPECT_EQ(info.reason(), "MISSING_BLOBS");
  EXPECT_EQ(info.metadata().at("missing_count"), "1");
  ASSERT_EQ(failure.violations_size(), 1);
  EXPECT_EQ(failure.violations(0).type(), "MISSING");
  EXPECT_EQ(failure.violations(0).subject(), "blobs/" + digest.hex() + "/10");
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
