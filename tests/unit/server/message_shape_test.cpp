// SPDX-License-Identifier: Apache-2.0
// Checks of messages before they are parsed, and the table of methods.
#include "server/auth/message_shape.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/auth/methods.hpp"
#include "tessera/v1/admin_service.pb.h"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::rpc {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

grpc::ByteBuffer buffer_of(const std::string& bytes) {
  // Slices as received: fields may cross their boundaries.
  std::vector<grpc::Slice> slices;
  for (std::size_t at = 0; at < bytes.size(); at += 7) slices.emplace_back(bytes.substr(at, 7));
  return {slices.data(), slices.size()};
}

core::Status check(const std::string& bytes, const google::protobuf::Descriptor& type,
                   const auth::ShapeLimits& limits) {
  grpc::ByteBuffer buffer = buffer_of(bytes);
  return auth::check_shape(buffer, type, limits);
}

v1::SynchronizeRequest request_of(int leases, int items) {
  v1::SynchronizeRequest request;
  request.set_worker_id("0123456789abcdef0123456789abcdef");
  request.set_threads(300);
  for (int i = 0; i < leases; ++i) {
    v1::Lease& lease = *request.add_held();
    lease.set_id(std::uint64_t{1} << 40);
    for (int j = 0; j < items; ++j) lease.add_items()->mutable_rect()->set_x1(64);
  }
  return request;
}

core::Status check_request(const v1::SynchronizeRequest& request, const auth::ShapeLimits& limits) {
  return check(request.SerializeAsString(), *v1::SynchronizeRequest::descriptor(), limits);
}

TEST(MessageShape, ElementsCountInTheMessageThatHoldsThem) {
  const auth::ShapeLimits limits{1000,
                                 {{"tessera.v1.SynchronizeRequest.held", 4}, {"tessera.v1.Lease.items", 8}}};
  EXPECT_TRUE(check_request(request_of(4, 8), limits));
  const auto leases = check_request(request_of(5, 1), limits);
  EXPECT_EQ(leases.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(leases.error().message, "held: there are more than 4");
  EXPECT_EQ(check_request(request_of(1, 9), limits).error().message, "items: there are more than 8");
}

TEST(MessageShape, OptionsAreNamed) {
  v1::SubmitJobRequest request;
  for (int i = 0; i < 3; ++i) request.mutable_bundle()->add_assets()->set_path("a");
  const auto refused = check(request.SerializeAsString(), *v1::SubmitJobRequest::descriptor(),
                             {100, {{"tessera.v1.Bundle.assets", 2, "--max-bundle-files"}}});
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_THAT(refused.error().message, HasSubstr("(tessera-coordinator --max-bundle-files)"));
}

TEST(MessageShape, AllFieldsCountTogetherAlsoUnknownAndPackedOnes) {
  const auth::ShapeLimits limits{64};
  v1::SubmitResultRequest packed;
  for (int i = 0; i < 65; ++i) packed.add_held_lease_ids(1);
  EXPECT_FALSE(check(packed.SerializeAsString(), *v1::SubmitResultRequest::descriptor(), limits));
  std::string unknown;
  for (int i = 0; i < 65; ++i) unknown += std::string("\xf8\x07\x01", 3);  // field 127
  EXPECT_FALSE(check(unknown, *v1::GetJobRequest::descriptor(), limits));
  EXPECT_TRUE(check(unknown.substr(0, 3 * 64), *v1::GetJobRequest::descriptor(), limits));
}

TEST(MessageShape, WhatIsDamagedIsRefused) {
  const auth::ShapeLimits limits{1000};
  const std::string whole = request_of(2, 2).SerializeAsString();
  ASSERT_TRUE(check(whole, *v1::SynchronizeRequest::descriptor(), limits));
  for (std::size_t size = 1; size < whole.size(); ++size) {
    const std::string part = whole.substr(0, size);
    v1::SynchronizeRequest parsed;
    EXPECT_EQ(check(part, *v1::SynchronizeRequest::descriptor(), limits).has_value(),
              parsed.ParseFromString(part))
        << size;
  }
  EXPECT_FALSE(check("\x0b\x0c", *v1::GetJobRequest::descriptor(), limits)) << "a group";
  EXPECT_FALSE(check(std::string(1, '\0'), *v1::GetJobRequest::descriptor(), limits)) << "field 0";
}

// The role that a method of the contract needs.
auth::Role role_of(const google::protobuf::MethodDescriptor& method) {
  if (method.service()->name() == "WorkerService") return auth::Role::kWork;
  if (method.service()->name() == "AdminService") return auth::Role::kAdmin;
  const std::string& name = method.name();
  const bool reads = name.starts_with("List") || name.starts_with("Watch") ||
                     (name.starts_with("Get") && name != "GetUpload");
  return reads ? auth::Role::kWatch : auth::Role::kSubmit;
}

TEST(Methods, AreThoseOfTheContract) {
  const auth::Methods methods{server::Limits()};
  std::size_t count = 0;
  for (const auto* file :
       {v1::GetJobRequest::descriptor()->file(), v1::SynchronizeRequest::descriptor()->file(),
        v1::DrainWorkerRequest::descriptor()->file()}) {
    const auto* const service = file->service(0);
    for (int i = 0; i < service->method_count(); ++i, ++count) {
      const std::string path = "/" + service->full_name() + "/" + service->method(i)->name();
      ASSERT_TRUE(methods.all().contains(path)) << path;
      EXPECT_EQ(methods.at(path).role, role_of(*service->method(i))) << path;
    }
  }
  EXPECT_EQ(methods.all().size(), count);
}

// A limit on a renamed field would have no effect.
TEST(Methods, LimitFieldsThatThereAre) {
  const auth::Methods methods{server::Limits()};
  for (const auto& [path, method] : methods.all())
    for (const auth::FieldLimit& limit : method.shape.fields) {
      const auto* const field =
          google::protobuf::DescriptorPool::generated_pool()->FindFieldByName(std::string(limit.field));
      ASSERT_NE(field, nullptr) << limit.field;
      EXPECT_TRUE(field->is_repeated());
    }
}

}  // namespace
}  // namespace tessera::rpc
