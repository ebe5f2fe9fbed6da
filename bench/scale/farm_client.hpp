// SPDX-License-Identifier: Apache-2.0
// What benchmarks ask of a coordinator as a user, and the job that they submit: a scene that nobody renders.
// Every function blocks. Thread-safe, as the stubs are.
#pragma once

#include <grpcpp/channel.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "tessera/v1/render_service.grpc.pb.h"

namespace tessera::bench {

// A new folder, which is removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The user and kernel time of this process.
double own_cpu_seconds();

// Each channel has its own connection, as workers on different machines have.
core::Result<std::shared_ptr<grpc::Channel>> own_connection(const std::string& address);

// Before the first job.
core::Status upload_scene(v1::RenderService::Stub& users);
v1::SubmitJobRequest request_of_scene(int width_px, int height_px, std::uint32_t spp);
// Waits while too many scenes wait to be validated.
core::Result<v1::Job> submit_job(v1::RenderService::Stub& users, const v1::SubmitJobRequest& request);

// These wait while the coordinator is overloaded.
std::vector<v1::Job> list_jobs(v1::RenderService::Stub& users);
bool any_is_validated(v1::RenderService::Stub& users);
// 0 if the coordinator does not answer.
std::size_t count_workers(v1::RenderService::Stub& users);

}  // namespace tessera::bench
