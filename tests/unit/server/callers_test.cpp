// SPDX-License-Identifier: Apache-2.0
// Workers of one caller, whatever they call themselves.
#include <gtest/gtest.h>

#include <string>

#include "tests/unit/server/limited_service.hpp"

namespace tessera::rpc {
namespace {

class Callers : public LimitedService {
 protected:
  void start_with_workers_of_ada_and_ben() {
    write_file(folder_.path() / "ada", std::string(16, 'a'));
    write_file(folder_.path() / "ben", std::string(16, 'b'));
    write_file(folder_.path() / "tokens",
               "work ada " + std::string(16, 'a') + "\nwork ben " + std::string(16, 'b') + "\n");
    access_ = *auth::Access::read(folder_.path() / "tokens");
    start({});
  }
  std::unique_ptr<v1::WorkerService::Stub> worker_of(const std::string& name) {
    proto::ClientSecurity security;
    security.token = folder_.path() / name;
    return v1::WorkerService::NewStub(*proto::open_channel(server_->address(), security));
  }
  v1::Lease lease_to(v1::WorkerService::Stub& caller, char worker) {
    grpc::ClientContext context;
    v1::SynchronizeResponse response;
    const grpc::Status status = caller.Synchronize(&context, greeting_with_key(worker), &response);
    EXPECT_TRUE(status.ok() && response.leases_size() == 1) << status.error_message();
    return response.leases_size() == 1 ? response.leases(0) : v1::Lease();
  }
  void decline(v1::WorkerService::Stub& caller, char worker, const v1::Lease& lease) {
    v1::SubmitResultRequest given_back = server::delivery_with_key(worker, lease);
    given_back.clear_items();
    given_back.set_decline_reason("out of memory");
    grpc::ClientContext context;
    v1::SubmitResultResponse response;
    const grpc::Status status = caller.SubmitResult(&context, given_back, &response);
    EXPECT_TRUE(status.ok()) << status.error_message();
  }
};

TEST_F(Callers, CannotFailAJobByWorkersOfManyNames) {
  start_with_workers_of_ada_and_ben();
  const std::string job = coordinator_->jobs().submit(submission(), "root")->id();
  coordinator_->jobs().validate(job);
  const auto ada = worker_of("ada"), ben = worker_of("ben");
  const v1::Lease of_ben = lease_to(*ben, 'a');
  for (const char worker : {'b', 'c', 'd', 'e'}) decline(*ada, worker, lease_to(*ada, worker));
  EXPECT_EQ(coordinator_->jobs().get(job)->state(), v1::JOB_STATE_RUNNING);
  decline(*ben, 'a', of_ben);
  ASSERT_TRUE(coordinator_->checkpointer().checkpoint());
  EXPECT_EQ(coordinator_->jobs().get(job)->state(), v1::JOB_STATE_FAILED);
}

}  // namespace
}  // namespace tessera::rpc
