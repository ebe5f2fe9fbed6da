// SPDX-License-Identifier: Apache-2.0
#include "client/farm/picture_download.hpp"

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

struct DownloadedPicture {
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

core::Result<DownloadedPicture> download(Farm& farm, const v1::GetImageRequest& request, bool& progress) {
  grpc::ClientContext context;
  const std::jthread canceller = cancel_at_interrupt(context);
  const auto stream = farm.stub().GetImage(&context, request);
  DownloadedPicture picture;
  std::uint64_t size_bytes = 0;
  v1::GetImageResponse response;
  while (stream->Read(&response)) {
    if (response.has_header()) {
      size_bytes = response.header().size_bytes();
      picture.job = response.header().job();
    }
    picture.bytes += response.data();
    progress = true;
  }
  const grpc::Status status = stream->Finish();
  if (!status.ok()) return fail(farm.explain(status, context));
  if (picture.bytes.empty() || picture.bytes.size() != size_bytes)
    return fail(core::ErrorCode::kUnavailable,
                fmt::format("the image broke off after {} of {} bytes", picture.bytes.size(), size_bytes));
  return picture;
}

core::Result<v1::Job> download_to(Farm& farm, const std::string& job_id,
                                  const std::vector<std::string>& paths, const PictureView& view,
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
    auto picture =
        patiently<DownloadedPicture>(farm, [&](bool& progress) { return download(farm, request, progress); });
    if (!picture) return fail(picture.error().within(path));
    if (only_finished && picture->job.state() != v1::JOB_STATE_DONE) return std::move(picture->job);
    if (core::Status written = core::write_file_atomically(path, picture->bytes); !written)
      return fail(written.error());
    job = std::move(picture->job);
  }
  return job;
}

}  // namespace

core::Result<v1::Job> download_pictures(Farm& farm, const std::string& job_id,
                                        const std::vector<std::string>& paths, const PictureView& view) {
  return download_to(farm, job_id, paths, view, false);
}

core::Result<v1::Job> download_finished_pictures(Farm& farm, const std::string& job_id,
                                                 const std::vector<std::string>& paths, std::uint32_t image) {
  return download_to(farm, job_id, paths, {.image = image}, true);
}

}  // namespace tessera::client
