// SPDX-License-Identifier: Apache-2.0
// Files of images, which are written some rows at a time.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "proto/convert.hpp"
#include "tests/unit/server/scripted_farm.hpp"

namespace tessera::server {
namespace {

using core::ErrorCode;
using testing::HasSubstr;

const std::pair<v1::ImageFormat, core::ImageFormat> kFormats[] = {
    {v1::IMAGE_FORMAT_PNG, core::ImageFormat::kPng},
    {v1::IMAGE_FORMAT_EXR, core::ImageFormat::kExr},
    {v1::IMAGE_FORMAT_HDR, core::ImageFormat::kHdr},
    {v1::IMAGE_FORMAT_PFM, core::ImageFormat::kPfm}};

core::Image part_of(const core::Image& image, const core::PixelRect& region) {
  core::Image part(region.width(), region.height());
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) part.at(x, y) = image.at(region.x0 + x, region.y0 + y);
  return part;
}

class ImageFiles : public ScriptedFarm {
 protected:
  std::string finish(const v1::SubmitJobRequest& request = submission()) {
    const std::string id = submit(request);
    work('a');
    EXPECT_EQ(stored_job(id).state(), v1::JOB_STATE_DONE);
    return id;
  }
  static v1::GetImageRequest request_of(const std::string& id, v1::ImageFormat format) {
    v1::GetImageRequest request;
    request.set_job_id(id);
    request.set_format(format);
    return request;
  }
  std::string file_of(const v1::GetImageRequest& request) {
    const auto written = coordinator().images().write(request);
    EXPECT_TRUE(written) << written.error().message;
    if (!written) return "";
    const auto bytes = written->file.read_at(0, written->size_bytes + 1);
    EXPECT_TRUE(bytes && bytes->size() == written->size_bytes);
    return bytes.value_or("");
  }
};

TEST_F(ImageFiles, AreThoseOfTheImageWhereverTheFilmIs) {
  const core::Image image = ready_made_image(kWidthPx, kHeightPx, kSpp);
  const std::string running = submit();
  work('a');
  const std::string stored = finish();
  for (const auto& [wire, format] : kFormats) {
    const std::string expected = *core::encode_image(image, format);
    EXPECT_TRUE(file_of(request_of(running, wire)) == expected) << core::image_format_name(format);
    EXPECT_TRUE(file_of(request_of(stored, wire)) == expected) << core::image_format_name(format);
  }
}

TEST_F(ImageFiles, OfARegionHaveItsPixels) {
  const core::Image image = ready_made_image(kWidthPx, kHeightPx, kSpp);
  const std::string id = finish();
  for (const core::PixelRect& region :
       {core::PixelRect{0, 0, kWidthPx, kHeightPx}, core::PixelRect{10, 20, 130, 99},
        core::PixelRect{64, 64, 65, 65}, core::PixelRect{149, 99, 150, 100}}) {
    for (const auto& [wire, format] : kFormats) {
      v1::GetImageRequest request = request_of(id, wire);
      *request.mutable_region() = proto::to_proto(region);
      const core::Image expected = part_of(image, region);
      core::RowSource source{expected.width, expected.height,
                             [&](int y) -> core::Result<const core::Rgb*> { return &expected.at(0, y); },
                             core::RowSource::Position{region.x0, region.y0, kWidthPx, kHeightPx}};
      struct Sink final : core::ByteSink {
        core::Status write_at(std::uint64_t offset, std::string_view more) override {
          if (offset + more.size() > bytes.size()) bytes.resize(offset + more.size());
          bytes.replace(offset, more.size(), more);
          return {};
        }
        std::string bytes;
      } sink;
      ASSERT_TRUE(core::write_image(source, format, {}, sink));
      EXPECT_TRUE(file_of(request) == sink.bytes) << core::image_format_name(format) << " " << region.x0;
    }
  }
}

TEST_F(ImageFiles, OfARegionOutsideTheImageAreRefused) {
  v1::SubmitJobRequest submitted = submission();
  *submitted.mutable_overrides()->mutable_crop() = proto::to_proto(core::PixelRect{20, 10, 120, 90});
  const std::string id = finish(submitted);
  for (const core::PixelRect& region :
       {core::PixelRect{0, 0, 10, 10}, core::PixelRect{20, 10, 121, 90}, core::PixelRect{30, 30, 30, 40},
        core::PixelRect{40, 30, 30, 40}, core::PixelRect{-1, 10, 120, 90}}) {
    v1::GetImageRequest request = request_of(id, v1::IMAGE_FORMAT_EXR);
    request.mutable_region()->set_x0(static_cast<std::uint32_t>(region.x0));
    request.mutable_region()->set_y0(static_cast<std::uint32_t>(region.y0));
    request.mutable_region()->set_x1(static_cast<std::uint32_t>(region.x1));
    request.mutable_region()->set_y1(static_cast<std::uint32_t>(region.y1));
    const auto refused = coordinator().images().write(request);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
    EXPECT_THAT(refused.error().message, HasSubstr("columns 20 to 120 and rows 10 to 90"));
    EXPECT_FALSE(coordinator().images().bytes_to_write(request));
  }
  v1::GetImageRequest request = request_of(id, v1::IMAGE_FORMAT_PFM);
  *request.mutable_region() = proto::to_proto(core::PixelRect{30, 20, 40, 25});
  EXPECT_EQ(file_of(request).size(), std::string("PF\n10 5\n-1.0\n").size() + 10 * 5 * 12);
}

TEST_F(ImageFiles, TakeMemoryForSomeRows) {
  const std::string id = submit();
  const auto bytes = [&](v1::ImageFormat format) {
    return *coordinator().images().bytes_to_write(request_of(id, format));
  };
  constexpr std::uint64_t kTables = std::uint64_t{1} << 20;
  for (const v1::ImageFormat format : {v1::IMAGE_FORMAT_EXR, v1::IMAGE_FORMAT_PNG})
    EXPECT_EQ(bytes(format), kTables + std::uint64_t{2} * 64 * kWidthPx * 12);
  EXPECT_EQ(coordinator().images().bytes_to_write(request_of(id, v1::ImageFormat(77))).error().code,
            ErrorCode::kInvalidArgument);
}

TEST_F(ImageFiles, LeaveNoFileBehind) {
  const std::string id = submit();
  { file_of(request_of(id, v1::IMAGE_FORMAT_PFM)); }
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path() / "state"))
    EXPECT_THAT(entry.path().filename().string(), testing::Not(HasSubstr("scratch")));
}

}  // namespace
}  // namespace tessera::server
