// SPDX-License-Identifier: Apache-2.0
#include "client/farm/image_download.hpp"

#include <fmt/format.h>

#include <utility>

#include "client/farm/interruption.hpp"
#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"

namespace tessera::client {
namespace {

using core::fail;

struct DownloadedImage {
  v1::Job job;
  std::string bytes;
};

v1::ImageFormat to_proto(core::ImageFormat format) {
  switch (format) {
    case core::ImageFormat::kPng:
      return v1::IMAGE_FORMAT_PNG;
    case core::ImageFormat::kExr:
      return v1::IMAGE_FORMAT_EXR;
    case core::ImageFormat::kHdr:
      return v1::IMAGE_FORMAT_HDR;
    case core::ImageFormat::kPfm:
      return v1::IMAGE_FORMAT_PFM;
  }
  return v1::IMAGE_FORMAT_UNSPECIFIED;
}

core::Result<DownloadedImage> download(Farm& farm, const v1::GetImageRequest& request, bool& progress) {
  grpc::ClientContext context;
  const std::jthread canceller = cancel_at_interrupt(context);
  const auto stream = farm.stub().GetImage(&context, request);
  DownloadedImage image;
  std::uint64_t size_bytes = 0;
  v1::GetImageResponse response;
  while (stream->Read(&response)) {
    if (response.has_header()) {
      size_bytes = response.header().size_bytes();
      image.job = response.header().job();
    }
    image.bytes += response.data();
    progress = true;
  }
  const grpc::Status status = stream->Finish();
  if (!status.ok()) return fail(farm.explain(status, context));
  if (image.bytes.empty() || image.bytes.size() != size_bytes)
    return fail(core::ErrorCode::kUnavailable,
                fmt::format("the image broke off after {} of {} bytes", image.bytes.size(), size_bytes));
  return image;
}

core::Result<v1::Job> download_to(Farm& farm, const std::string& job_id,
                                  const std::vector<std::string>& paths, const ImageView& view,
                                  bool only_finished) {
  v1::Job job;
  for (const std::string& path : paths) {
    const auto format = core::image_format_from_path(path);
    if (!format) return fail(format.error());
    v1::GetImageRequest request;
    request.set_job_id(job_id);
    request.set_format(to_proto(*format));
    request.set_image(view.image);
    request.set_layer(view.layer);
    *request.mutable_display() = proto::to_proto(view.display);
    if (view.region) *request.mutable_region() = proto::to_proto(*view.region);
    auto image =
        patiently<DownloadedImage>(farm, [&](bool& progress) { return download(farm, request, progress); });
    if (!image) return fail(image.error().within(path));
    if (only_finished && image->job.state() != v1::JOB_STATE_DONE) return std::move(image->job);
    if (core::Status written = core::write_file_atomically(path, image->bytes); !written)
      return fail(written.error());
    job = std::move(image->job);
  }
  return job;
}

}  // namespace

core::Result<v1::Job> download_images(Farm& farm, const std::string& job_id,
                                      const std::vector<std::string>& paths, const ImageView& view) {
  return download_to(farm, job_id, paths, view, false);
}

core::Result<v1::Job> download_finished_images(Farm& farm, const std::string& job_id,
                                               const std::vector<std::string>& paths, std::uint32_t image) {
  return download_to(farm, job_id, paths, {.image = image}, true);
}

}  // namespace tessera::client
