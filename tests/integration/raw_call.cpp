// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/raw_call.hpp"

#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/generic/generic_stub.h>

#include <chrono>

#include "proto/channel.hpp"
#include "proto/status.hpp"

namespace tessera::test {
namespace {

std::string bytes_of(const grpc::ByteBuffer& buffer) {
  std::vector<grpc::Slice> slices;
  if (!buffer.Dump(&slices).ok()) return "";
  std::string bytes;
  for (const grpc::Slice& slice : slices)
    bytes.append(reinterpret_cast<const char*>(slice.begin()), slice.size());
  return bytes;
}

}  // namespace

core::Result<std::string> raw_call(const std::string& address, const std::string& method,
                                   const std::string& message) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(20));
  grpc::GenericStub stub(*proto::open_channel(address));
  grpc::CompletionQueue queue;
  // A stream also serves a unary method: on the wire they are the same.
  const auto stream = stub.PrepareCall(&context, method, &queue);
  const auto finished = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  int tag = 0;
  grpc::Slice slice(message);
  grpc::ByteBuffer answer;
  stream->StartCall(&tag);
  bool ok = finished();
  stream->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), &tag);
  ok &= finished();
  stream->Read(&answer, &tag);
  ok &= finished();
  grpc::Status status;
  stream->Finish(&status, &tag);
  finished();
  if (!status.ok()) return core::fail(proto::error_from_grpc(status));
  if (!ok) return core::fail(core::ErrorCode::kInternal, "no answer");
  return bytes_of(answer);
}

}  // namespace tessera::test
