// SPDX-License-Identifier: Apache-2.0
// The images of the documentation are what the commands beside them render, without visible noise.
// scripts/render_docs_images.sh renders them.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "core/film/region.hpp"
#include "core/image/decode.hpp"
#include "core/image/srgb.hpp"
#include "tests/documentation/render_command.hpp"
#include "tests/support/temporary_folder.hpp"

namespace tessera::test {
namespace {

namespace fs = std::filesystem;

constexpr int kShrink = 4;      // a small render has a quarter of the width and of the height
constexpr int kCellPx = 8;      // of a small render: images are compared by the means of cells
constexpr int kSmallSpp = 192;  // leaves the mean of a cell little noise
// Between images that differ in noise alone it is below 0.02; a tenth of a stop is 0.07.
constexpr double kMaxDifference = 0.035;
// Standard deviation of a pixel in 8-bit codes. Noise of two codes can be seen on even surfaces.
constexpr double kMaxGrain = 1.5;

const fs::path kSource = TESSERA_SOURCE_DIR;

core::Image documented_image(const std::string& name) {
  return core::read_image((kSource / "docs/images" / name).string()).value();
}

core::Rgb mean(const core::Image& image, core::PixelRect rect) {
  core::Rgb sum{};
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) sum += image.at(x, y);
  return sum * (1 / static_cast<float>(rect.pixel_count()));
}

core::Image shrunk(const core::Image& image, int factor) {
  core::Image small(image.width / factor, image.height / factor);
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x)
      small.at(x, y) = mean(image, {x * factor, y * factor, (x + 1) * factor, (y + 1) * factor});
  return small;
}

// What is brighter than white is cut off in pixels of either size, and differently.
bool is_clipped(const core::Image& image, core::PixelRect rect, int channel) {
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x)
      if (image.at(x, y)[channel] >= 1) return true;
  return false;
}

// Root mean square of the differences between cells of a small render and of `image`, relative to that of the
// image's cells, in linear light and without channels that are clipped in a pixel of the cell. Infinite if
// less than half are left.
double difference(const core::Image& small, const core::Image& image) {
  double squares = 0, reference_squares = 0;
  const core::TileGrid cells(image.width, image.height, kShrink * kCellPx);
  int compared = 0;
  for (int cell = 0; cell < cells.tile_count(); ++cell) {
    const core::PixelRect rect = cells.rect(cell);
    const core::Rgb a =
        mean(small, {rect.x0 / kShrink, rect.y0 / kShrink, rect.x1 / kShrink, rect.y1 / kShrink});
    const core::Rgb b = mean(image, rect);
    for (int c = 0; c < 3; ++c) {
      if (is_clipped(image, rect, c)) continue;
      ++compared;
      squares += static_cast<double>((a[c] - b[c]) * (a[c] - b[c]));
      reference_squares += static_cast<double>(b[c] * b[c]);
    }
  }
  if (2 * compared < 3 * cells.tile_count()) return std::numeric_limits<double>::infinity();
  return std::sqrt(squares / reference_squares);
}

// Standard deviation of a pixel's noise, in 8-bit codes, of two images with independent noise.
double grain(const core::Image& a, const core::Image& b) {
  double squares = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    for (int c = 0; c < 3; ++c) {
      const double step = core::srgb_encode(a.pixels[i][c]) - core::srgb_encode(b.pixels[i][c]);
      squares += step * step;
    }
  return std::sqrt(squares / (2 * 3 * static_cast<double>(a.pixels.size())));
}

core::Image row_of(const core::Image& image, int y) {
  core::Image row(image.width, 1);
  for (int x = 0; x < image.width; ++x) row.at(x, 0) = image.at(x, y);
  return row;
}

class DocumentedImage : public testing::TestWithParam<RenderCommand> {};

TEST_P(DocumentedImage, IsWhatItsCommandRenders) {
  const core::Image image = documented_image(GetParam().image_name);
  const std::string size = fmt::format("{}x{}", image.width, image.height);
  const std::string wanted = option_value(GetParam(), "--size");
  EXPECT_TRUE(wanted.empty() || wanted == size) << size;
  ASSERT_EQ(image.width % kShrink, 0);
  ASSERT_EQ(image.height % kShrink, 0);
  const core::Image small =
      render(GetParam(), {"--size", fmt::format("{}x{}", image.width / kShrink, image.height / kShrink),
                          "--spp", fmt::to_string(kSmallSpp)});
  EXPECT_LT(difference(small, image), kMaxDifference);
}

TEST_P(DocumentedImage, HasNoGrain) {
  const core::Image image = documented_image(GetParam().image_name);
  // Rows through what stands in the foreground, and below, where caustics fall.
  for (const int y : {image.height * 10 / 16, image.height * 13 / 16}) {
    const core::Image row =
        render(GetParam(), {"--seed", "1", "--crop", fmt::format("0,{},{},{}", y, image.width, y + 1)});
    EXPECT_LT(grain(row, row_of(image, y)), kMaxGrain) << "row " << y;
  }
}

INSTANTIATE_TEST_SUITE_P(Images, DocumentedImage, testing::ValuesIn(documented_commands()),
                         [](const auto& test_case) {
                           return fs::path(test_case.param.image_name).stem().string();
                         });

TEST(DocumentedImages, HaveCommands) {
  const std::vector<RenderCommand> commands = documented_commands();
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "docs"))
    // (Those of the page are screenshots: tests/browser/screenshots.mjs takes them.)
    if (entry.path().extension() == ".png" && entry.path().parent_path().filename() != "page") {
      EXPECT_TRUE(std::any_of(commands.begin(), commands.end(), [&](const RenderCommand& command) {
        return command.image_name == entry.path().filename();
      })) << entry.path();
    }
}

TEST(DocumentedImages, StandBesideTheirCommands) {
  const std::vector<RenderCommand> commands = documented_commands();
  std::size_t shown = 0;
  const auto check_page = [&](const fs::path& path) {
    const std::string page = read_file(path);
    for (const RenderCommand& command : commands) {
      if (page.find("images/" + command.image_name + ")") == std::string::npos) continue;
      ++shown;
      EXPECT_NE(page.find(command.text), std::string::npos)
          << path << " shows " << command.image_name << " without: " << command.text;
    }
  };
  check_page(kSource / "README.md");
  for (const char* folder : {"docs", "scenes"})
    for (const auto& entry : fs::recursive_directory_iterator(kSource / folder))
      if (entry.path().extension() == ".md") check_page(entry.path());
  EXPECT_GE(shown, commands.size());
}

// The comparison finds another exposure, an image that is moved, and one of another scene.
TEST(DocumentedImages, AreComparedStrictly) {
  const core::Image image = documented_image("cornell.png");
  core::Image brighter = image, moved = image, mirrored = image;
  for (core::Rgb& pixel : brighter.pixels) pixel *= 1.07f;
  std::rotate(moved.pixels.begin(), moved.pixels.begin() + kShrink, moved.pixels.end());
  std::reverse(mirrored.pixels.begin(), mirrored.pixels.end());
  EXPECT_LT(difference(shrunk(image, kShrink), image), kMaxDifference / 100);
  for (const core::Image& other : {brighter, moved, mirrored})
    EXPECT_GT(difference(shrunk(other, kShrink), image), kMaxDifference);
}

}  // namespace
}  // namespace tessera::test
