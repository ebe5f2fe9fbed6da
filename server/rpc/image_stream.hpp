// One picture on its way to a client.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <string>

#include "server/coordinator/coordinator.hpp"
#include "server/coordinator/thread_pool.hpp"

namespace tessera::rpc {

// Owned by gRPC until OnDone. There is never more than one operation under way, so that its members need no
// lock.
class ImageStream final : public grpc::ServerWriteReactor<v1::GetImageResponse> {
 public:
  // Develops and encodes the picture on `pool`.
  ImageStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool,
              const v1::GetImageRequest& request);

 private:
  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

  core::Status take_picture(const v1::GetImageRequest& request);
  void write_next();

  coordinator::Coordinator& coordinator_;
  std::string file_;
  std::size_t sent_bytes_ = 0;
  v1::GetImageResponse response_;
};

}  // namespace tessera::rpc
