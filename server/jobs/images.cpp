// SPDX-License-Identifier: Apache-2.0
// Develops the image of a job, finished or not.
#include "server/jobs/images.hpp"

#include <fmt/format.h>
#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

#include "core/base/determinism_fingerprint.hpp"
#include "core/base/version.hpp"
#include "core/film/develop.hpp"
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
  constexpr std::uint32_t kMax = core::kMaxImageSidePx;
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

// Where a part of the image lies in the whole.
std::optional<core::ImagePosition> position_of(const core::PixelRect& region, const v1::Job& job) {
  const auto width = static_cast<int>(job.settings().width_px());
  const auto height = static_cast<int>(job.settings().height_px());
  if (region == core::PixelRect{0, 0, width, height}) return std::nullopt;
  return core::ImagePosition{region.x0, region.y0, width, height};
}

// That of the file that a local render writes.
std::optional<core::RenderRecord> record_of(const farm::JobSnapshot& snapshot, const v1::Job& job,
                                            int image) {
  const auto settings = proto::from_proto(job.settings());
  const v1::Job& spec = *snapshot.spec;
  if (!settings || image >= spec.scene_digests_size()) return std::nullopt;
  const std::string fingerprint =
      snapshot.arithmetic.empty() ? std::string(core::kDeterminismFingerprint) : snapshot.arithmetic;
  return core::RenderRecord{.version = std::string(core::version()),
                            .fingerprint = fingerprint,
                            .scene = spec.scene_digests(image),
                            .settings = *settings,
                            .frame = image < spec.images_size() ? spec.images(image).frame() : 0,
                            .complete = farm::has_all_samples(snapshot)};
}

// A part of the image is what a render of this crop window writes.
core::TextAttributes attributes_of(const ImageSource& source, const core::PixelRect& region) {
  if (!source.record) return {};
  core::RenderRecord record = *source.record;
  record.settings.crop = region;
  core::TextAttributes attributes = core::attributes_of(record);
  attributes.insert(attributes.end(), source.attributes.begin(), source.attributes.end());
  return attributes;
}

// What of an image is written: a layer, or the beauty with all layers, or channels. The file that a local
// render writes has a record of how it was made.
struct Content {
  view::ShownLayer layer;
  core::LayerSet layers;
  bool has_record = false;
};

core::Result<Content> content_of(const v1::GetImageRequest& request, const v1::Job& job) {
  if (auto known = check_channels(request.channels()); !known) return core::fail(known.error());
  const auto layer = view::parse_layer(request.layer());
  if (!layer) return core::fail(layer.error());
  const core::LayerSet layers = farm::layers_of(job);
  if (auto there = view::check_layer(layers, *layer); !there) return core::fail(there.error());
  const bool is_part = *layer || !request.channels().empty();
  return Content{*layer, is_part ? core::LayerSet() : layers, !is_part};
}

}  // namespace

core::Result<ImageSource> Images::find(const std::string& id, std::uint32_t image) {
  const auto found = find_with_image(farm_, store_, id);
  if (!found) return core::fail(found.error());
  if (auto there = check_image(found->snapshot.view.shape, image); !there) return core::fail(there.error());
  if (found->film) found->film->apply();
  v1::Job job = summarise(found->snapshot);
  auto record = record_of(found->snapshot, job, static_cast<int>(image));
  core::TextAttributes attributes;
  for (const v1::TextAttribute& each : found->snapshot.spec->attributes())
    attributes.emplace_back(each.name(), each.value());
  return ImageSource{std::move(job),          found->snapshot.view.shape, found->film,
                     static_cast<int>(image), std::move(record),          std::move(attributes)};
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
  auto source = find(request.job_id(), request.image());
  if (!source) return core::fail(source.error());
  const auto content = content_of(request, source->job);
  if (!content) return core::fail(content.error());
  const auto region = region_of(request, source->job);
  if (!region) return core::fail(region.error());
  const auto display = proto::resolve_display(source->job.display(), request.display());
  if (!display) return core::fail(display.error());
  auto file = base::ScratchFile::make(folder_);
  if (!file) return core::fail(file.error());
  ScratchSink sink(*file);
  const auto position = position_of(*region, source->job);
  const auto attributes = content->has_record ? attributes_of(*source, *region) : core::TextAttributes();
  core::Result<std::uint64_t> size = std::uint64_t{0};
  if (content->layers.empty()) {
    ImageRows rows(films_, *source, *region, content->layer);
    size = core::write_image(
        {rows.width(), rows.height(), [&](int y) { return rows.row(y); }, position, attributes}, *format,
        *display, sink);
  } else {
    LayeredImageRows rows(films_, *source, *region);
    size = core::write_channels({region->width(), region->height(), rows.channels(),
                                 [&](int y) { return rows.row(y); }, position, attributes},
                                *format, *display, sink);
  }
  if (!size) return core::fail(size.error());
  return ImageFile{std::move(source->job), *std::move(file), *size};
}

core::Result<std::uint64_t> Images::bytes_to_write(const v1::GetImageRequest& request) {
  const auto format = format_of(request.format());
  if (!format) return core::fail(format.error());
  const auto found = find_with_image(farm_, store_, request.job_id());
  if (!found) return core::fail(found.error());
  const auto content = content_of(request, *found->snapshot.spec);
  if (!content) return core::fail(content.error());
  if (auto there = check_image(found->snapshot.view.shape, request.image()); !there)
    return core::fail(there.error());
  const auto region = region_of(request, *found->snapshot.spec);
  if (!region) return core::fail(region.error());
  const auto width = static_cast<std::uint64_t>(region->width());
  if (content->layers.empty()) return core::encoding_bytes(width) + ImageRows::bytes(width);
  const std::size_t channels = core::image_channels(content->layers).size();
  return core::encoding_bytes(width * (channels + 2) / 3) + LayeredImageRows::bytes(width, channels);
}

}  // namespace tessera::jobs
