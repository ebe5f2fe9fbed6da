// SPDX-License-Identifier: Apache-2.0
#include "worker/blob_source.hpp"

#include <chrono>
#include <string_view>

#include "proto/blob.hpp"
#include "proto/status.hpp"
#include "worker/waiting.hpp"

namespace tessera::worker {

core::Status finish_download(grpc::ClientReaderInterface<v1::FetchBlobResponse>& stream,
                             grpc::ClientContext& context, const std::stop_token& stop) {
  const grpc::Status finished = stream.Finish();
  if (finished.ok()) return {};
  if (finished.error_code() == grpc::StatusCode::CANCELLED && !stop.stop_requested())
    return core::fail(
        core::ErrorCode::kUnavailable,
        "the coordinator ended the download: it is stopping, or for long too little was taken here");
  return core::fail(proto::error_from_grpc(finished, context));
}

core::Status CoordinatorSource::fetch(PartialBlob& into, const std::stop_token& stop) {
  std::uint64_t size = 0;
  proto::BlobReceiver receiver(into.digest(), [&](std::string_view bytes) -> core::Status {
    if (core::Status written = into.write(bytes, size); !written) return written;
    size += bytes.size();
    return {};
  });
  StoppableCall call(stop);
  StallGuard guard([&] { call.context()->TryCancel(); }, kMaxSilence);
  call.context()->set_wait_for_ready(true);
  v1::FetchBlobRequest request;
  *request.mutable_digest() = proto::to_proto(into.digest());
  const auto stream = coordinator_.FetchBlob(call.context(), request);
  v1::FetchBlobResponse response;
  core::Status taken;
  while (taken && stream->Read(&response)) {
    guard.progressed();
    taken = receiver.accept(response.chunk());
  }
  if (!taken) call.context()->TryCancel();
  const core::Status finished = finish_download(*stream, *call.context(), stop);
  if (!taken) return taken;
  if (!finished) return finished;
  const auto received = receiver.finish();
  return received ? core::Status{} : core::fail(received.error());
}

}  // namespace tessera::worker
