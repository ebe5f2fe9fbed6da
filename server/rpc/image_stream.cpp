#include "server/rpc/image_stream.hpp"

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/image/encode.hpp"
#include "proto/blob.hpp"
#include "proto/convert_display.hpp"
#include "server/rpc/reactors.hpp"

namespace tessera::rpc {

namespace {

std::optional<core::ImageFormat> format_of(v1::ImageFormat format) {
  switch (format) {
    case v1::IMAGE_FORMAT_PNG:
      return core::ImageFormat::kPng;
    case v1::IMAGE_FORMAT_EXR:
      return core::ImageFormat::kExr;
    case v1::IMAGE_FORMAT_HDR:
      return core::ImageFormat::kHdr;
    case v1::IMAGE_FORMAT_PFM:
      return core::ImageFormat::kPfm;
    default:
      return std::nullopt;
  }
}

}  // namespace

ImageStream::ImageStream(coordinator::Coordinator& coordinator, coordinator::ThreadPool& pool,
                         const v1::GetImageRequest& request)
    : coordinator_(coordinator) {
  const bool posted = pool.post([this, &pool, request] {
    if (pool.is_closed()) return Finish(stopping());
    if (auto taken = guarded([&] { return take_picture(request); }); !taken)
      return Finish(proto::to_grpc(taken));
    write_next();
  });
  if (!posted) Finish(busy());
}

core::Status ImageStream::take_picture(const v1::GetImageRequest& request) {
  const auto format = format_of(request.format());
  if (!format) {
    return core::fail(
        core::ErrorCode::kInvalidArgument,
        fmt::format("format: must be one of ImageFormat, got {}", static_cast<int>(request.format())));
  }
  auto picture = coordinator_.picture(request.job_id());
  if (!picture) return core::fail(picture.error());
  const auto display = proto::resolve_display(picture->job.display(), request.display());
  if (!display) return core::fail(display.error());
  auto encoded = core::encode_image(picture->image, *format, *display);
  if (!encoded) return core::fail(encoded.error());
  file_ = std::move(*encoded);
  response_.mutable_header()->set_size_bytes(file_.size());
  *response_.mutable_header()->mutable_job() = std::move(picture->job);
  return {};
}

void ImageStream::OnWriteDone(bool ok) {
  if (!ok) return Finish(grpc::Status::CANCELLED);
  if (sent_bytes_ == file_.size()) return Finish(grpc::Status::OK);
  response_.clear_header();
  write_next();
}

void ImageStream::write_next() {
  response_.set_data(file_.substr(sent_bytes_, proto::kMaxChunkBytes));
  sent_bytes_ += response_.data().size();
  StartWrite(&response_);
}

}  // namespace tessera::rpc
