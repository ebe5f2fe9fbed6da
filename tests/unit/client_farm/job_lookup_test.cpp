// SPDX-License-Identifier: Apache-2.0
// How commands find a job by its id or name, with coordinators of this release and of earlier ones.
#include "client/farm/job_lookup.hpp"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace tessera::client {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

const std::string kFirst = "aaaa1111aaaa1111aaaa1111aaaa1111", kSecond = "aaaa2222aaaa2222aaaa2222aaaa2222",
                  kThird = "bbbb3333bbbb3333bbbb3333bbbb3333";

class ListingService final : public v1::RenderService::Service {
 public:
  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest* request,
                        v1::ListJobsResponse* response) override {
    for (const std::string& id : {kFirst, kSecond, kThird}) {
      if (!knows_prefixes || id.starts_with(request->id_prefix())) response->add_jobs()->set_id(id);
    }
    answered = static_cast<std::size_t>(response->jobs_size());
    most_wanted = request->max_jobs();
    return grpc::Status::OK;
  }

  bool knows_prefixes = true;
  std::size_t answered = 0, most_wanted = 0;
};

class JobLookup : public testing::TestWithParam<bool> {
 protected:
  JobLookup() {
    service_.knows_prefixes = GetParam();
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service_);
    server_ = builder.BuildAndStart();
    farm_ = std::move(*Farm::open({.address = "127.0.0.1:" + std::to_string(port), .security = {}}));
  }

  ListingService service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Farm> farm_;
};

TEST_P(JobLookup, FindsTheOnlyOneThatBeginsSo) {
  for (const std::string& typed : {kThird, kThird.substr(0, 1), kThird.substr(0, 6)}) {
    const auto job = find_job(*farm_, typed);
    ASSERT_TRUE(job) << job.error().message;
    EXPECT_EQ(job->id(), kThird);
  }
  EXPECT_EQ(find_job(*farm_, kSecond)->id(), kSecond);
}

TEST_P(JobLookup, NeedsEnoughDigits) {
  const auto job = find_job(*farm_, "aaaa");
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(job.error().message, HasSubstr("'aaaa' could be job aaaa1111aaaa or job aaaa2222aaaa"));
}

TEST_P(JobLookup, SaysThatThereIsNone) {
  for (const std::string typed : {"c", "", "aaaa1111aaaa1111aaaa1111aaaa11110"}) {
    const auto job = find_job(*farm_, typed);
    ASSERT_FALSE(job) << typed;
    EXPECT_EQ(job.error().code, ErrorCode::kNotFound);
  }
}

// The number of jobs does not matter.
TEST_P(JobLookup, AsksForNoMoreThanItNeeds) {
  EXPECT_TRUE(find_job(*farm_, kThird.substr(0, 4)));
  EXPECT_EQ(service_.most_wanted, 2u);
  EXPECT_EQ(service_.answered, GetParam() ? 1u : 3u);
}

INSTANTIATE_TEST_SUITE_P(Releases, JobLookup, testing::Bool(), [](const auto& knows_prefixes) {
  return std::string(knows_prefixes.param ? "This" : "Earlier");
});

}  // namespace
}  // namespace tessera::client
