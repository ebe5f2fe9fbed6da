// SPDX-License-Identifier: Apache-2.0
// The route of whole images. As for GetImage, encoding waits for memory, which is given back when the file is
// sent.
#include <fmt/format.h>

#include <algorithm>
#include <mutex>
#include <utility>

#include "core/base/printable.hpp"
#include "proto/json.hpp"
#include "server/http/answers.hpp"
#include "server/http/dispatch.hpp"
#include "server/http/handlers.hpp"
#include "server/http/read_json.hpp"

namespace tessera::http_api {

namespace {

// Sends a file from disk.
class FileBody final : public http::BodySource {
 public:
  FileBody(CallPtr call, jobs::ImageFile image, base::FairShare::Held memory)
      : call_(std::move(call)), image_(std::move(image)), memory_(std::move(memory)) {}

  State read(std::string& out, std::size_t max_bytes) override {
    const auto bytes = image_.file.read_at(sent_bytes_, max_bytes);
    if (!bytes) return State::kFailed;
    out += *bytes;
    sent_bytes_ += bytes->size();
    call_->services().streams.calls.traffic.images_sent += bytes->size();
    return sent_bytes_ == image_.size_bytes ? State::kEnd : State::kMore;
  }

 private:
  const CallPtr call_;
  const jobs::ImageFile image_;
  const base::FairShare::Held memory_;
  std::uint64_t sent_bytes_ = 0;
};

// A name for a file that cannot be taken for a path or for another header.
std::string file_name(const v1::Job& job, std::uint32_t image, const std::string& format) {
  std::string name;
  for (const char c : job.name().substr(0, 80)) {
    const bool is_plain =
        (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_';
    name += is_plain ? c : '_';
  }
  const std::string suffix = job.image_count() > 1 ? fmt::format("-image{}", image) : "";
  return fmt::format("{}-{:.8}{}.{}", name, job.id(), suffix, format);
}

const char* content_type(v1::ImageFormat format) {
  switch (format) {
    case v1::IMAGE_FORMAT_PNG:
      return "image/png";
    case v1::IMAGE_FORMAT_EXR:
      return "image/x-exr";
    case v1::IMAGE_FORMAT_HDR:
      return "image/vnd.radiance";
    default:
      return "application/octet-stream";
  }
}

// A download from its first wait to its response.
struct Download : std::enable_shared_from_this<Download> {
  Download(CallPtr c, v1::GetImageRequest r, std::uint64_t mib)
      : call(std::move(c)), request(std::move(r)), need_mib(mib) {}

  void begin(http::Respond to);
  // If it still waits.
  void give_up();
  Answer make(base::FairShare::Held& memory) const;
  Answer no_memory() const;

  const CallPtr call;
  const v1::GetImageRequest request;
  const std::uint64_t need_mib;
  http::Respond respond;
};

// The requested memory is granted at most once, and never after give_up() has ended the wait.
void Download::begin(http::Respond to) {
  respond = std::move(to);
  base::FairQueue& queue = call->services().streams.image_mib;
  const auto granted = [self = shared_from_this()](base::FairShare::Held held) {
    auto memory = std::make_shared<base::FairShare::Held>(std::move(held));
    const http::Response made =
        answer_later(self->call, Where::kSlow, [self, memory] { return self->make(*memory); });
    made.later(self->respond);
  };
  if (!queue.wait(this, call->caller().key, need_mib, granted))
    return respond(finish_call(call, no_memory()));
  call->context.delayed.after(call->services().streams.stalls.patience(), [weak = weak_from_this()] {
    if (const auto self = weak.lock()) self->give_up();
  });
}

void Download::give_up() {
  if (call->services().streams.image_mib.leave(this)) respond(finish_call(call, no_memory()));
}

Answer Download::no_memory() const {
  const rpc::StreamLimits& streams = call->services().streams;
  core::Error error = server::over_limit(
      fmt::format("this image takes {} MiB of memory, and others that are being fetched {} MiB", need_mib,
                  streams.image_mib.held()),
      fmt::format("{} MiB", streams.limits.image_mib), "--max-image-mib");
  error.message += ", some of which it keeps for other callers";
  return core::fail(server::temporary(error, auth::kTryAgainAfter));
}

Answer Download::make(base::FairShare::Held& memory) const {
  auto image = call->coordinator().images().write(request);
  if (!image) return core::fail(image.error());
  const std::string format = call->request.parameter("format").value_or("png");
  http::Response response{
      .headers = {{"Content-Type", content_type(request.format())},
                  {"Content-Disposition", fmt::format("attachment; filename=\"{}\"",
                                                      file_name(image->job, request.image(), format))},
                  {"X-Tessera-State", proto::to_json(image->job).at("state").get<std::string>()},
                  {"Cache-Control", "no-store"}},
      .size_bytes = image->size_bytes};
  response.source = std::make_unique<FileBody>(call, *std::move(image), std::move(memory));
  return response;
}

}  // namespace

Answer get_image(const CallPtr& call) {
  auto request = read_image(call->request);
  if (!request) return core::fail(request.error());
  request->set_job_id(call->id());
  const auto bytes = call->coordinator().images().bytes_to_write(*request);
  if (!bytes) return core::fail(bytes.error());
  auto download = std::make_shared<Download>(call, *std::move(request), 1 + *bytes / server::kMib);
  http::Response response;
  response.later = [download](http::Respond respond) { download->begin(std::move(respond)); };
  return response;
}

}  // namespace tessera::http_api
