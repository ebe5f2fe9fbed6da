// SPDX-License-Identifier: Apache-2.0
#include "core/image/decode.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfRgbaFile.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <half.h>

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/image/codecs.hpp"
#include "core/image/encode.hpp"
#include "core/image/file_io.hpp"
#include "core/image/limits.hpp"
#include "tests/unit/core_image/test_image.hpp"

namespace tessera::core {
namespace {

using namespace std::string_literals;
using testing::HasSubstr;

std::string temporary_path(const std::string& name) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  return testing::TempDir() + test.test_suite_name() + "." + test.name() + "." + name;
}

// What must never be more than an error: any exception or crash fails the test.
void expect_survived(const std::string& bytes) {
  const Result<Image> image = decode_image(bytes);
  if (image) {
    EXPECT_GT(image->pixels.size(), 0u);
  } else {
    EXPECT_NE(image.error().message, "");
  }
}

class HostileFile : public testing::TestWithParam<ImageFormat> {
 protected:
  std::string valid_bytes() const { return encode_image(random_image(24, 18, 7), GetParam()).value(); }
};
INSTANTIATE_TEST_SUITE_P(All, HostileFile,
                         testing::Values(ImageFormat::kPng, ImageFormat::kExr, ImageFormat::kHdr,
                                         ImageFormat::kPfm),
                         [](const auto& format) { return std::string(image_format_name(format.param)); });

TEST_P(HostileFile, EveryTruncationIsAnError) {
  const std::string bytes = valid_bytes();
  // PNG ends with 12 bytes that tell a reader nothing but that the file ends, and 8 of checksums.
  const std::size_t shortest_whole = bytes.size() - (GetParam() == ImageFormat::kPng ? 20 : 0);
  for (std::size_t size = 0; size < shortest_whole; ++size) {
    ASSERT_FALSE(decode_image(std::string_view(bytes).substr(0, size))) << size << " of " << bytes.size();
  }
}

TEST_P(HostileFile, MutationsAreSurvived) {
  const std::string bytes = valid_bytes();
  for (std::uint64_t seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937_64 random(seed);
    std::string mutated = bytes;
    // Headers, which promise sizes, are where harm is done: half of the changes go there.
    for (std::uint64_t i = 0; i <= random() % 4; ++i) {
      const std::size_t span = random() % 2 == 0 ? std::min<std::size_t>(400, bytes.size()) : bytes.size();
      mutated[random() % span] = static_cast<char>(random());
    }
    expect_survived(mutated);
  }
}

TEST(DecodeImage, NoiseIsAnError) {
  for (const std::string& bytes :
       {""s, "\0"s, "hello"s, "\x76\x2f\x31\x01"s, "\x89PNG\r\n\x1a\n"s, "#?RADIANCE\n"s}) {
    ASSERT_FALSE(decode_image(bytes));
  }
}

TEST(DecodeImage, ASmallFileThatClaimsAHugeImageIsAnError) {
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  EXPECT_FALSE(decode_image(header + "-Y 10000 +X 10000\n" + std::string(100, '\1')));
  EXPECT_THAT(decode_image("PF\n60000 60000\n-1.0\n").error().message,
              HasSubstr("60000 x 60000 = 3600000000 pixels"));
  std::string exr = encode_image(Image(16, 16), ImageFormat::kExr).value();
  const std::size_t window = exr.find("dataWindow") + std::string("dataWindow\0box2i\0????"s).size() + 8;
  ASSERT_EQ(exr[window], 15);
  exr.replace(window, 8, "\xff\x7f\0\0\xff\x7f\0\0"s);
  exr += std::string(32768 / 16 * 8, '\0');  // room for the table of where the rows are
  EXPECT_THAT(decode_image(exr).error().message, HasSubstr("32768x32768"));
}

TEST(DecodeExr, FilesThatAreNotFlatAreNotBroken) {
  std::string exr = encode_image(Image(2, 2), ImageFormat::kExr).value();
  exr[5] = 0x10;
  EXPECT_EQ(decode_image(exr).error().message,
            "is an OpenEXR image of several parts, which is not supported; save it as one flat part");
  exr[5] = 0x08;
  EXPECT_EQ(decode_image(exr).error().message,
            "is a deep OpenEXR image, which is not supported; save it as one flat part");
}

// OpenEXR would take the memory first.
TEST(DecodeExr, AttributesBeyondTheFileAreErrors) {
  std::string exr = encode_image(Image(2, 2), ImageFormat::kExr).value();
  const std::size_t size = exr.find("lineOrder\0lineOrder\0"s) + 20;
  ASSERT_EQ(exr[size], 1);
  exr[size + 3] = 0x66;
  EXPECT_THAT(decode_image(exr).error().message, HasSubstr("OpenEXR image (the file ends too early)"));
}

// OpenEXR would go on at another byte than the one behind the attribute.
TEST(DecodeExr, AttributesThatAreNotOfTheirTypeAreErrors) {
  const std::string exr = encode_image(Image(2, 2), ImageFormat::kExr).value();
  const std::size_t first_channel = exr.find("chlist") + 7 + 4;
  ASSERT_EQ(exr.substr(first_channel, 2), "B\0"s);
  std::string longer_name = exr;
  longer_name[first_channel + 1] = 'B';
  EXPECT_THAT(decode_image(longer_name).error().message,
              HasSubstr("OpenEXR image (its attribute channels is damaged)"));
  std::string other_type = exr;
  other_type.replace(other_type.find("box2i"), 5, "box2f");
  EXPECT_THAT(decode_image(other_type).error().message, HasSubstr("its attribute dataWindow is damaged"));
  std::string shorter = exr;
  const std::size_t size = shorter.find("\0v2f\0"s) + 5;
  ASSERT_EQ(shorter[size], 8);
  shorter[size] = 7;
  EXPECT_THAT(decode_image(shorter).error().message,
              HasSubstr("its attribute screenWindowCenter is damaged"));
}

TEST(DecodeExr, AttributesOfNoUseAreNotLookedAt) {
  Image image(2, 2);
  image.pixels[3] = {1, 2, 3};
  std::string exr = encode_image(image, ImageFormat::kExr).value();
  const std::string preview =
      "preview\0preview\0\x08\0\0\0\xff\xff\0\0\xff\xff\0\0"s;  // of 65535 x 65535 pixels
  exr.insert(8, preview);
  // The table of where the chunk is, behind the header.
  const std::size_t table = exr.find("screenWindowWidth\0float\0"s) + 24 + 4 + 4 + 1;
  exr[table] = static_cast<char>(exr[table] + static_cast<char>(preview.size()));
  const auto read = decode_image(exr);
  ASSERT_TRUE(read.has_value()) << read.error().message;
  EXPECT_EQ(read->pixels, image.pixels);
}

TEST(DecodePfm, ReadsBigEndianAndGray) {
  const Result<Image> image = decode_image("Pf\n2 1\n1.0\n\x3f\x80\0\0\x40\0\0\0"s);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->pixels, (std::vector<Rgb>{Rgb::gray(1), Rgb::gray(2)}));
}

TEST(DecodePfm, BrokenHeadersAreErrors) {
  for (const char* header :
       {"PF\n", "PF\n1\n", "PF\n1 1\n", "PF\n1 1\n0\n", "PF\n-1 -1\n-1\n", "PF\n0 0\n-1\n", "PF\n1 1 1\n-1\n",
        "PF\n1 x\n-1\n", "PF\n99999999999 1\n-1\n"}) {
    EXPECT_FALSE(decode_image(header + "\0\0\0\0\0\0\0\0\0\0\0\0"s)) << header;
  }
}

TEST(DecodePfm, BytesAfterThePixelsAreAnError) {
  std::string bytes = encode_image(Image(2, 2), ImageFormat::kPfm).value();
  EXPECT_TRUE(decode_image(bytes));
  EXPECT_FALSE(decode_image(bytes + "x"));
}

// Files of other programs: half floats, a data window that does not begin at 0, a channel nobody asked for.
class ForeignExr : public testing::Test {
 protected:
  std::string write(const std::vector<std::string>& channels,
                    Imf::Compression compression = Imf::ZIP_COMPRESSION) {
    planes_.clear();
    const Imath::Box2i window({-3, 5}, {-3 + kWidth - 1, 5 + kHeight - 1});
    Imf::Header header(window, window);
    header.compression() = compression;
    Imf::FrameBuffer frame;
    for (const std::string& name : channels) {
      std::vector<half>& texels = planes_.emplace_back(kWidth * kHeight);
      for (std::size_t i = 0; i < texels.size(); ++i) texels[i] = static_cast<float>(i + planes_.size());
      header.channels().insert(name, Imf::Channel(Imf::HALF));
      frame.insert(name, Imf::Slice::Make(Imf::HALF, texels.data(), window));
    }
    const std::string path = temporary_path("exr");
    {
      Imf::OutputFile file(path.c_str(), header);
      file.setFrameBuffer(frame);
      file.writePixels(kHeight);
    }
    return path;
  }

  static constexpr int kWidth = 5, kHeight = 4;
  std::vector<std::vector<half>> planes_;
};

TEST_F(ForeignExr, HalfChannelsAndAnOffsetWindow) {
  const Result<Image> image = read_image(write({"R", "G", "B", "A"}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(0, 0), (Rgb{1, 2, 3}));
  EXPECT_EQ(image->at(4, 3), (Rgb{20, 21, 22}));
}

TEST_F(ForeignExr, LuminanceBecomesGray) {
  const Result<Image> image = read_image(write({"Y"}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(1, 0), Rgb::gray(2));
}

TEST_F(ForeignExr, AlphaIsKeptOnRequest) {
  const std::string file = read_file(write({"R", "G", "B", "A"})).value();
  const auto image = decode_pixels(file, {.max_pixels = 100, .keep_alpha = true});
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->channels, 4u);
  const auto& values = std::get<DecodedImage::Floats>(image->values);
  EXPECT_EQ(std::vector<float>(values.begin(), values.begin() + 4), (std::vector<float>{1, 2, 3, 4}));
}

TEST_F(ForeignExr, TheFirstLayerWithColoursIsTaken) {
  const Result<Image> image =
      read_image(write({"depth.Z", "view.combined.R", "view.combined.G", "view.combined.B"}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(0, 0), (Rgb{2, 3, 4}));
}

TEST_F(ForeignExr, AnyCompressionIsRead) {
  for (const auto compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION,
                                 Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION, Imf::B44_COMPRESSION,
                                 Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
    const Result<Image> image = read_image(write({"R", "G", "B"}, compression));
    ASSERT_TRUE(image) << compression << ": " << image.error().message;
    EXPECT_NEAR(image->at(4, 3).g, 21, 1) << compression;
  }
}

TEST(DecodeExr, LuminanceAndChromaBecomeColours) {
  const std::string path = temporary_path("exr");
  const std::vector<Imf::Rgba> pixels(32 * 32, Imf::Rgba(0.5f, 0.25f, 0.125f, 1));
  {
    Imf::RgbaOutputFile file(path.c_str(), 32, 32, Imf::WRITE_YC);
    file.setFrameBuffer(pixels.data(), 1, 32);
    file.writePixels(32);
  }
  const Result<Image> image = read_image(path);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_NEAR(image->at(16, 16).r, 0.5f, 0.01f);
  EXPECT_NEAR(image->at(16, 16).b, 0.125f, 0.01f);
}

TEST_F(ForeignExr, WithoutColourIsReadByItsFirstLayer) {
  const std::string path = write({"Z", "R"});
  const Result<Image> image = read_image(path);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(4, 3), read_image(path, "R")->at(4, 3));
  EXPECT_EQ(image->at(4, 3).r, image->at(4, 3).b);
  const auto decoded = decode_pixels(*read_file(path), {.max_pixels = kMaxImagePixels});
  ASSERT_TRUE(decoded);
  EXPECT_THAT(decoded->warnings, testing::ElementsAre("has no colours; its first layer is read, 'R'"));
}

TEST(ReadImage, ErrorsNameTheFile) {
  EXPECT_THAT(read_image("/no/such.png").error().message, HasSubstr("'/no/such.png': No such file"));
  EXPECT_THAT(read_image(testing::TempDir()).error().message, HasSubstr("Is a directory"));
  const std::string path = temporary_path("png");
  ASSERT_TRUE(write_file_atomically(path, "text"));
  EXPECT_EQ(
      read_image(path).error().message,
      "'" + path +
          "' is not an image of a known format (PNG, JPEG, HDR, EXR, PFM, TIFF, WebP, BMP, QOI or TGA)");
}

}  // namespace
}  // namespace tessera::core
