// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/farm_client.hpp"

#include <grpcpp/create_channel.h>
#include <stdlib.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>
#include <system_error>
#include <thread>

#include "proto/blob.hpp"
#include "proto/channel.hpp"
#include "proto/status.hpp"

namespace tessera::bench {
namespace {

using namespace std::chrono_literals;

// The coordinator validates this scene, but nobody renders it.
constexpr const char* kScene = R"({
  "camera": { "position": [0, 1.5, 6], "look_at": [0, 1, 0] },
  "materials": { "lamp": { "type": "lambert", "emission": 12 } },
  "shapes": [ { "type": "sphere", "center": [0, 1, 0], "radius": 1, "material": "lamp" } ]
})";

constexpr auto kRetryDelay = 200ms;

v1::ListJobsResponse page_of_jobs(v1::RenderService::Stub& users, const v1::ListJobsRequest& request) {
  while (true) {
    grpc::ClientContext context;
    v1::ListJobsResponse response;
    if (users.ListJobs(&context, request, &response).ok()) return response;
    std::this_thread::sleep_for(kRetryDelay);  // the coordinator is overloaded
  }
}

}  // namespace

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "tessera-scale-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) std::abort();
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

double own_cpu_seconds() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

core::Result<std::shared_ptr<grpc::Channel>> own_connection(const std::string& address) {
  const auto credentials = proto::channel_credentials(address, {});
  if (!credentials) return core::fail(credentials.error());
  grpc::ChannelArguments arguments;
  arguments.SetMaxSendMessageSize(proto::kMaxMessageBytes);
  arguments.SetMaxReceiveMessageSize(proto::kMaxMessageBytes);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  arguments.SetInt(GRPC_ARG_HTTP2_BDP_PROBE, 0);  // as in proto/channel.cpp
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  return grpc::CreateCustomChannel(address, *credentials, arguments);
}

core::Status upload_scene(v1::RenderService::Stub& users) {
  const proto::Digest digest = proto::digest_of(kScene);
  grpc::ClientContext context;
  v1::UploadBlobResponse response;
  const auto stream = users.UploadBlob(&context, &response);
  v1::UploadBlobRequest request;
  proto::for_each_chunk(digest, kScene, [&](const v1::BlobChunk& chunk) {
    *request.mutable_chunk() = chunk;
    return stream->Write(request);
  });
  stream->WritesDone();
  return proto::from_grpc(stream->Finish());
}

v1::SubmitJobRequest request_of_scene(int width_px, int height_px, std::uint32_t spp) {
  v1::SubmitJobRequest request;
  request.mutable_bundle()->set_scene_path("scene.json");
  v1::Bundle::Asset& asset = *request.mutable_bundle()->add_assets();
  asset.set_path("scene.json");
  *asset.mutable_digest() = proto::to_proto(proto::digest_of(kScene));
  request.mutable_overrides()->set_width_px(static_cast<std::uint32_t>(width_px));
  request.mutable_overrides()->set_height_px(static_cast<std::uint32_t>(height_px));
  request.mutable_overrides()->set_spp(spp);
  return request;
}

std::vector<v1::Job> list_jobs(v1::RenderService::Stub& users) {
  std::vector<v1::Job> jobs;
  v1::ListJobsRequest request;
  do {
    const v1::ListJobsResponse page = page_of_jobs(users, request);
    jobs.insert(jobs.end(), page.jobs().begin(), page.jobs().end());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return jobs;
}

bool any_is_validated(v1::RenderService::Stub& users) {
  v1::ListJobsRequest request;
  request.add_states(v1::JOB_STATE_VALIDATING);
  request.set_page_size(1);
  return page_of_jobs(users, request).jobs_size() > 0;
}

core::Result<v1::Job> submit_job(v1::RenderService::Stub& users, const v1::SubmitJobRequest& request) {
  while (true) {
    grpc::ClientContext context;
    v1::SubmitJobResponse response;
    const grpc::Status status = users.SubmitJob(&context, request, &response);
    if (status.ok()) return response.job();
    if (!proto::asked_wait(status, context)) return core::fail(proto::error_from_grpc(status));
    std::this_thread::sleep_for(10ms);
  }
}

std::size_t count_workers(v1::RenderService::Stub& users) {
  std::size_t count = 0;
  v1::ListWorkersRequest request;
  do {
    grpc::ClientContext context;
    v1::ListWorkersResponse page;
    if (!users.ListWorkers(&context, request, &page).ok()) return 0;
    count += static_cast<std::size_t>(page.workers_size());
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return count;
}

}  // namespace tessera::bench
