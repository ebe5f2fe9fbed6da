#include "server/rpc/worker_service.hpp"

#include "server/rpc/blob_streams.hpp"
#include "server/rpc/reactors.hpp"
#include "server/rpc/synchronize_call.hpp"

namespace tessera::rpc {

grpc::ServerUnaryReactor* WorkerService::Synchronize(grpc::CallbackServerContext* context,
                                                     const v1::SynchronizeRequest* request,
                                                     v1::SynchronizeResponse* response) {
  return new SynchronizeCall(*context, coordinator_, pool_, request, response);
}

grpc::ServerUnaryReactor* WorkerService::SubmitResult(grpc::CallbackServerContext* context,
                                                      const v1::SubmitResultRequest* request,
                                                      v1::SubmitResultResponse* response) {
  return run_unary(context, pool_, [=, this]() -> core::Status {
    auto counted = coordinator_.submit_result(*request);
    if (!counted) return core::fail(counted.error());
    *response = *counted;
    return {};
  });
}

grpc::ServerWriteReactor<v1::FetchBlobResponse>* WorkerService::FetchBlob(
    grpc::CallbackServerContext*, const v1::FetchBlobRequest* request) {
  return new FetchStream(coordinator_, pool_, request->digest());
}

}  // namespace tessera::rpc
