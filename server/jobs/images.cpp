// SPDX-License-Identifier: Apache-2.0
// Develops the image of a job, finished or not.
#include "server/jobs/images.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <utility>

#include "core/image/limits.hpp"
#include "proto/convert.hpp"
#include "proto/convert_display.hpp"
#include "server/jobs/find_job.hpp"
#include "server/jobs/image_choice.hpp"

namespace tessera::jobs {

using core::ErrorCode;

namespace {

core::Result<core::ImageFormat> format_of(v1::ImageFormat format) {
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
      return core::fail(ErrorCode::kInvalidArgument,
                        fmt::format("format: must be one of ImageFormat, got {}", static_cast<int>(format)));
  }
}

// The pixels of the file.
core::Result<core::PixelRect> region_of(const v1::GetImageRequest& request, const v1::Job& job) {
  const core::PixelRect window = proto::window_of(job.settings());
  if (!request.has_region()) return window;
  const v1::PixelRect& asked = request.region();
  constexpr std::uint32_t kMax = core::kMaxPictureSidePx;
  if (std::max({asked.x0(), asked.y0(), asked.x1(), asked.y1()}) <= kMax) {
    const core::PixelRect region{static_cast<int>(asked.x0()), static_cast<int>(asked.y0()),
                                 static_cast<int>(asked.x1()), static_cast<int>(asked.y1())};
    if (!region.empty() && window.contains(region)) return region;
  }
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("region: must lie within the job's pixels, columns {} to {} and rows {} to {}", window.x0,
                  window.x1, window.y0, window.y1));
}

core::Result<FoundJob> find_with_image(farm::Farm& farm, store::JobStore& store, const std::string& id) {
  auto found = find_job(farm, store, id);
  if (!found || found->snapshot.is_validated) return found;
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("job {} has no image, since its scene was not validated", id));
}

class ScratchSink final : public core::ByteSink {
 public:
  explicit ScratchSink(base::ScratchFile& file) : file_(file) {}
  core::Status write_at(std::uint64_t offset, std::string_view bytes) override {
    return file_.write_at(offset, bytes);
  }

 private:
  base::ScratchFile& file_;
};

core::RowSource source_of(ImageRows& rows, const v1::GetImageRequest& request) {
  core::RowSource source{rows.width(), rows.height(), [&](int y) { return rows.row(y); }};
  if (!request.has_region()) return source;
  const v1::RenderSettings& settings = rows.job().settings();
  source.position = {static_cast<int>(request.region().x0()), static_cast<int>(request.region().y0()),
                     static_cast<int>(settings.width_px()), static_cast<int>(settings.height_px())};
  return source;
}

}  // namespace

core::Result<ImageSource> Images::find(const std::string& id, std::uint32_t image) {
  const auto found = find_with_image(farm_, store_, id);
  if (!found) return core::fail(found.error());
  if (auto there = check_image(found->snapshot.view.shape, image); !there) return core::fail(there.error());
  if (found->film) found->film->apply();
  return ImageSource{summarise(found->snapshot), found->snapshot.view.shape, found->film,
                     static_cast<int>(image)};
}

template <typename Made>
core::Result<Made> Images::make_of_one_moment(const std::string& id,
                                              const std::function<core::Result<Made>()>& make) {
  while (true) {
    auto made = make();
    // A job that was extended meanwhile has another film.
    if (!made && made.error().code == ErrorCode::kUnavailable) made = make();
    if (!made || made->job.state() != v1::JOB_STATE_DONE) return made;
    // The image of a done job does not change, unless the job runs again.
    const auto now = find(id, 0);
    if (!now) return core::fail(now.error());
    if (now->job.finished_at() == made->job.finished_at()) return made;
  }
}

core::Result<JobImage> Images::get(const std::string& id, int image) {
  return make_of_one_moment<JobImage>(id, [&] { return develop(id, static_cast<std::uint32_t>(image)); });
}

core::Result<JobImage> Images::develop(const std::string& id, std::uint32_t index) {
  auto source = find(id, index);
  if (!source) return core::fail(source.error());
  ImageRows rows(films_, *source, source->shape.window);
  core::Image image(rows.width(), rows.height());
  for (int y = 0; y < rows.height(); ++y) {
    const auto row = rows.row(y);
    if (!row) return core::fail(row.error());
    std::copy_n(*row, rows.width(), &image.at(0, y));
  }
  return JobImage{std::move(source->job), std::move(image)};
}

core::Result<ImageFile> Images::write(const v1::GetImageRequest& request) {
  return make_of_one_moment<ImageFile>(request.job_id(), [&] { return write_once(request); });
}

core::Result<ImageFile> Images::write_once(const v1::GetImageRequest& request) {
  const auto format = format_of(request.format());
  if (!format) return core::fail(format.error());
  if (auto known = check_channels(request.channels()); !known) return core::fail(known.error());
  auto source = find(request.job_id(), request.image());
  if (!source) return core::fail(source.error());
  const auto region = region_of(request, source->job);
  if (!region) return core::fail(region.error());
  const auto display = proto::resolve_display(source->job.display(), request.display());
  if (!display) return core::fail(display.error());
  auto file = base::ScratchFile::make(folder_);
  if (!file) return core::fail(file.error());
  ScratchSink sink(*file);
  ImageRows rows(films_, *source, *region);
  const auto size = core::write_image(source_of(rows, request), *format, *display, sink);
  if (!size) return core::fail(size.error());
  return ImageFile{std::move(source->job), *std::move(file), *size};
}

core::Result<std::uint64_t> Images::bytes_to_write(const v1::GetImageRequest& request) {
  const auto format = format_of(request.format());
  if (!format) return core::fail(format.error());
  const auto found = find_with_image(farm_, store_, request.job_id());
  if (!found) return core::fail(found.error());
  if (auto known = check_channels(request.channels()); !known) return core::fail(known.error());
  if (auto there = check_image(found->snapshot.view.shape, request.image()); !there)
    return core::fail(there.error());
  const auto region = region_of(request, *found->snapshot.spec);
  if (!region) return core::fail(region.error());
  const auto width = static_cast<std::uint64_t>(region->width());
  return core::encoding_bytes(width) + ImageRows::bytes(width);
}

}  // namespace tessera::jobs
