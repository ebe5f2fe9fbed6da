// SPDX-License-Identifier: Apache-2.0
// Routes of the files of scenes.
#include <charconv>
#include <utility>

#include "proto/blob.hpp"
#include "proto/text.hpp"
#include "server/blobs/admission.hpp"
#include "server/http/answers.hpp"
#include "server/http/dispatch.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"
#include "server/rpc/blob_calls.hpp"

namespace tessera::http_api {

namespace {

// One upload in progress.
struct Upload {
  CallPtr call;
  base::FairShare::Held place;
  blobs::BlobWriter writer;
};

Json blob_json(const proto::Digest& digest) {
  return {{"sha256", digest.hex()}, {"bytes", digest.size_bytes}};
}

// The digest is known when the last byte is here.
Answer store(Upload& upload) {
  const auto digest = upload.writer.name_by_content();
  if (!digest) return core::fail(digest.error());
  server::Coordinator& coordinator = upload.call->coordinator();
  const auto use = coordinator.files().use(upload.call->caller().key, *digest);
  if (!use) return core::fail(server::temporary(use.error(), auth::kTryAgainAfter));
  if (!coordinator.blobs().contains(*digest))
    if (const auto committed = upload.writer.commit(); !committed) return core::fail(committed.error());
  return json_response(blob_json(*digest));
}

class BlobSink final : public http::BodySink {
 public:
  explicit BlobSink(std::shared_ptr<Upload> upload) : upload_(std::move(upload)) {}

  core::Status write(std::string_view bytes) override {
    upload_->call->services().streams.calls.traffic.blobs_received += bytes.size();
    return upload_->writer.append(bytes);
  }
  http::Response finish(const core::Status& status) override {
    if (!status) return finish_call(upload_->call, core::fail(status.error()));
    return answer_later(upload_->call, Where::kSlow, [upload = upload_] { return store(*upload); });
  }

 private:
  const std::shared_ptr<Upload> upload_;
};

core::Result<std::uint64_t> body_bytes(const http::Request& request) {
  const std::string text = request.header("content-length");
  std::uint64_t bytes = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bytes);
  if (error == std::errc() && end == text.data() + text.size()) return bytes;
  return core::fail(proto::invalid_field("Content-Length", "must be the size of the file"));
}

// Removing files to make room blocks, and is rare.
core::Result<blobs::BlobWriter> open_writer(const Call& call, std::uint64_t bytes) {
  blobs::SceneFiles& files = call.coordinator().files();
  const proto::Digest unnamed{{}, bytes};
  auto writer = files.write(call.caller().key, unnamed);
  if (writer || writer.error().code != core::ErrorCode::kResourceExhausted) return writer;
  return files.write_making_room(call.caller().key, unnamed);
}

}  // namespace

core::Result<std::unique_ptr<http::BodySink>> receive_blob(const CallPtr& call) {
  rpc::StreamLimits& streams = call->services().streams;
  const std::string& caller = call->caller().key;
  const auto bytes = body_bytes(call->request);
  if (!bytes) return core::fail(bytes.error());
  if (auto fits = blobs::check_blob_size(*bytes, streams.limits); !fits) return core::fail(fits.error());
  auto place = streams.uploads.take(caller);
  if (!place)
    return core::fail(
        server::temporary(server::over_share(streams.uploads.held_by(caller), "uploads", "are in progress",
                                             streams.limits.uploads, "--max-uploads"),
                          auth::kTryAgainAfter));
  auto writer = open_writer(*call, *bytes);
  if (!writer) return core::fail(writer.error());
  auto upload = std::shared_ptr<Upload>(new Upload{call, *std::move(place), *std::move(writer)});
  return std::unique_ptr<http::BodySink>(std::make_unique<BlobSink>(std::move(upload)));
}

Answer find_missing(const CallPtr& call) {
  const auto body = read_body(call->request.body);
  if (!body) return core::fail(body.error());
  const auto request = read_files(*body);
  if (!request) return core::fail(request.error());
  v1::FindMissingBlobsResponse response;
  const core::Status found = rpc::find_missing(call->coordinator(), call->caller().key, *request, response);
  if (!found) return core::fail(found.error());
  Json missing = Json::array();
  for (const v1::Digest& digest : response.missing()) missing.push_back(proto::from_proto(digest)->hex());
  return json_response({{"missing", std::move(missing)}});
}

}  // namespace tessera::http_api
