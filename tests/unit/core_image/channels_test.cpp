// SPDX-License-Identifier: Apache-2.0
// Images of any channels in files, and reading them by name.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spng.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "core/image/codecs.hpp"
#include "core/image/decode.hpp"
#include "core/image/encode.hpp"
#include "core/image/exr_header.hpp"
#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

using testing::HasSubstr;

// 3 x 2 pixels in which channel c of pixel i is 10 i + c, and A of the first pixel is 0.5.
class Channels : public testing::Test {
 protected:
  Channels() {
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t c = 0; c < source_.channels.size(); ++c)
        values_.push_back(static_cast<float>(10 * i + c));
    std::copy_n(std::array{0.25f, 0.125f, 0.0f, 0.5f}.begin(), 4, values_.begin());
    source_.row = [this](int y) -> Result<const float*> {
      return values_.data() + static_cast<std::size_t>(y) * 3 * source_.channels.size();
    };
  }

  std::string encoded(ImageFormat format) const {
    const auto bytes = encode_channels(source_, format, {});
    EXPECT_TRUE(bytes) << bytes.error().message;
    return bytes.value_or("");
  }

  ChannelRows source_{
      3, 2, {"R", "G", "B", "A", "Normal.X", "Normal.Y", "Normal.Z", "Depth.Z", "UV.U", "UV.V"}, {}, {}, {}};
  std::vector<float> values_;
};

TEST_F(Channels, AreReadFromOpenExrByTheirNames) {
  const std::string bytes = encoded(ImageFormat::kExr);
  const auto pixel = [&](const std::string& layer) { return decode_image(bytes, layer).value().at(1, 1); };
  EXPECT_EQ(pixel(""), (Rgb{40, 41, 42}));
  EXPECT_EQ(pixel("Normal"), (Rgb{44, 45, 46}));
  EXPECT_EQ(pixel("Depth.Z"), Rgb::gray(47));
  EXPECT_EQ(pixel("Depth"), Rgb::gray(47));
  EXPECT_EQ(pixel("A"), Rgb::gray(43));
  EXPECT_EQ(pixel("UV"), (Rgb{48, 49, 0}));
}

TEST_F(Channels, InLowerCaseAreColours) {
  source_.channels = {"r", "g", "b", "a", "n.x", "n.y", "n.z", "z", "uv.u", "uv.v"};
  const auto image = decode_image(encoded(ImageFormat::kExr));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(1, 1), (Rgb{40, 41, 42}));
}

TEST_F(Channels, ThatAreUnknownAreToldWithThoseThatThereAre) {
  const std::string bytes = encoded(ImageFormat::kExr);
  EXPECT_EQ(
      decode_image(bytes, "Norml").error().message,
      "has no layer or channel 'Norml'; did you mean 'Normal'? Its layers are 'A', 'Depth', 'Normal', 'UV'");
  EXPECT_THAT(decode_image(bytes, "depht").error().message, HasSubstr("did you mean 'Depth'?"));
  EXPECT_THAT(decode_image(bytes, "Normal.x").error().message, HasSubstr("did you mean 'Normal.X'?"));
  EXPECT_EQ(decode_image(bytes, "Mist").error().message,
            "has no layer or channel 'Mist'; its layers are 'A', 'Depth', 'Normal', 'UV'");
  EXPECT_THAT(decode_image(bytes, "a\nb").error().message, HasSubstr("'a\\x0ab'"));
}

TEST_F(Channels, OfALayerAreListedTogetherAndAllOthersAlone) {
  source_.channels = {"R", "G", "B", "A", "C0.r", "C0.g", "C0.b", "C0.a", "Odd.Q", "Z"};
  EXPECT_THAT(image_layers(encoded(ImageFormat::kExr)).value(),
              testing::UnorderedElementsAre("", "A", "C0", "C0.a", "Odd.Q", "Z"));
  EXPECT_THAT(image_layers(encoded(ImageFormat::kPfm)).value(), testing::ElementsAre(""));
  EXPECT_FALSE(image_layers("no image"));
}

TEST_F(Channels, OfOtherFormatsCannotBeChosen) {
  EXPECT_EQ(decode_image(encoded(ImageFormat::kPfm), "Normal").error().message,
            "has the format PFM, and only OpenEXR files have layers");
}

TEST_F(Channels, BeginWithTheColoursOfFormatsWithoutOthers) {
  EXPECT_EQ(decode_image(encoded(ImageFormat::kPfm)).value().at(2, 0), (Rgb{20, 21, 22}));
  EXPECT_NEAR(decode_image(encoded(ImageFormat::kHdr)).value().at(2, 0).r, 20, 0.2);
}

TEST_F(Channels, OfAnOpenExrFileAreWrittenAsAnImageOfThemselves) {
  source_.channels = {"R", "G", "B"};
  Image image(3, 2);
  for (std::size_t i = 0; i < 6; ++i)
    image.pixels[i] = {values_[3 * i], values_[3 * i + 1], values_[3 * i + 2]};
  EXPECT_TRUE(encoded(ImageFormat::kExr) == encode_image(image, ImageFormat::kExr).value());
}

TEST_F(Channels, ComeWithTextsInTheHeader) {
  source_.attributes = {{"tessera/version", "1.2"}, {"manifest", "{\"a\":\"b\"}"}};
  const auto texts = exr_texts(encoded(ImageFormat::kExr));
  ASSERT_TRUE(texts) << texts.error().message;
  EXPECT_EQ(texts->at("tessera/version"), "1.2");
  EXPECT_EQ(texts->at("manifest"), "{\"a\":\"b\"}");
  EXPECT_TRUE(decode_image(encoded(ImageFormat::kExr), "Normal"));
}

TEST_F(Channels, OfBrokenHeadersAreRefused) {
  const std::string bytes = encoded(ImageFormat::kExr);
  EXPECT_FALSE(exr_texts("PNG"));
  for (const std::size_t length : {8u, 9u, 20u, 40u, 100u}) EXPECT_FALSE(exr_texts(bytes.substr(0, length)));
}

// PNG wants colours that alpha has not multiplied.
TEST_F(Channels, OfAPngAreStraightColoursAndAlpha) {
  const std::string bytes = encoded(ImageFormat::kPng);
  const std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)> png(spng_ctx_new(0), &spng_ctx_free);
  ASSERT_EQ(spng_set_png_buffer(png.get(), bytes.data(), bytes.size()), 0);
  spng_ihdr header{};
  ASSERT_EQ(spng_get_ihdr(png.get(), &header), 0);
  EXPECT_EQ(header.color_type, SPNG_COLOR_TYPE_TRUECOLOR_ALPHA);
  std::array<std::uint8_t, 4 * 6> codes{};
  ASSERT_EQ(spng_decode_image(png.get(), codes.data(), codes.size(), SPNG_FMT_RGBA8, 0), 0);
  EXPECT_EQ(codes[0], srgb_encode(0.5f));
  EXPECT_EQ(codes[1], srgb_encode(0.25f));
  EXPECT_EQ(codes[2], 0);
  EXPECT_EQ(codes[3], 128);
  EXPECT_EQ(codes[7], 255);
}

}  // namespace
}  // namespace tessera::core
