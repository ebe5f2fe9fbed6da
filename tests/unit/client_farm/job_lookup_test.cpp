// SPDX-License-Identifier: Apache-2.0
// How commands find a job by its id or name, with coordinators of this release and of earlier ones.
#include "client/farm/job_lookup.hpp"

#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <algorithm>
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
    most_wanted = request->page_size();
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

// Lists 2500 jobs in pages of at most 1000.
class PagingService final : public v1::RenderService::Service {
 public:
  static constexpr int kJobs = 2500;

  grpc::Status ListJobs(grpc::ServerContext*, const v1::ListJobsRequest* request,
                        v1::ListJobsResponse* response) override {
    EXPECT_EQ(request->owner(), "ann");
    ++calls;
    int next = request->page_token().empty() ? 0 : std::stoi(request->page_token());
    const int end = std::min(kJobs, next + std::min(1000, static_cast<int>(request->page_size())));
    for (; next < end; ++next) response->add_jobs()->set_id(std::to_string(next));
    if (next < kJobs) response->set_next_page_token(std::to_string(next));
    return grpc::Status::OK;
  }

  int calls = 0;
};

TEST(ListJobs, FollowsThePagesUpToTheLimit) {
  PagingService service;
  int port = 0;
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
  builder.RegisterService(&service);
  const auto server = builder.BuildAndStart();
  const auto farm = std::move(*Farm::open({.address = "127.0.0.1:" + std::to_string(port), .security = {}}));
  v1::ListJobsRequest request;
  request.set_owner("ann");
  const auto all = list_jobs(*farm, request, 10'000);
  ASSERT_TRUE(all) << all.error().message;
  ASSERT_EQ(all->jobs_size(), PagingService::kJobs);
  EXPECT_EQ(all->jobs(1000).id(), "1000");
  EXPECT_EQ(service.calls, 3);
  EXPECT_EQ(list_jobs(*farm, request, 1001)->jobs_size(), 1001);
  EXPECT_EQ(service.calls, 5);
}

}  // namespace
}  // namespace tessera::client
