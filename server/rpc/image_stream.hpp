// SPDX-License-Identifier: Apache-2.0
// Sends one image to a client.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/mutex.hpp"
#include "server/base/scratch_file.hpp"
#include "server/coordinator.hpp"
#include "server/rpc/call.hpp"
#include "server/rpc/pools.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone. At most one operation is in progress, so its members need no lock, except for
// those that record what it waits for.
//
//   constructed ──► waiting for memory ──► encoding ──► sending
//                        │ timeout, cancelled              │ not read
//                        ▼                                 ▼
//                      ended                             ended
class ImageStream final : public RequestCall {
 public:
  // Waits for the memory that encoding the image takes. It is given back when the image is sent: that bounds
  // the temporary files as well.
  ImageStream(grpc::CallbackServerContext& context, server::Coordinator& coordinator, const Pools& pools,
              StreamLimits& streams, auth::Admission admission)
      : RequestCall(context, streams, std::move(admission)), coordinator_(coordinator), pools_(pools) {}

 private:
  google::protobuf::Message& message() override { return request_; }
  void begin() override;
  void OnWriteDone(bool ok) override;
  void on_cancel() override;
  void OnDone() override;
  void end_own_wait_since(Clock::time_point time) override;

  void wait_for_memory();
  void make_image(base::FairShare::Held memory);
  core::Status take_image();
  void write_next();
  // RESOURCE_EXHAUSTED, with the delay before a retry.
  grpc::Status no_memory();

  server::Coordinator& coordinator_;
  const Pools pools_;
  v1::GetImageRequest request_;
  std::uint64_t need_mib_ = 0;
  std::optional<base::FairShare::Held> memory_;
  std::optional<base::ScratchFile> file_;
  std::uint64_t size_bytes_ = 0, sent_bytes_ = 0;
  v1::GetImageResponse response_;
  grpc::ByteBuffer bytes_;

  core::Mutex mutex_;
  bool cancelled_ TESSERA_GUARDED_BY(mutex_) = false;                         // before the wait for memory
  std::optional<Clock::time_point> queued_since_ TESSERA_GUARDED_BY(mutex_);  // kept after the wait
  // Set while a write is in progress.
  std::optional<Clock::time_point> waiting_since_ TESSERA_GUARDED_BY(mutex_);
};

}  // namespace tessera::rpc
