// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/scene_flags.hpp"
#include "core/image/compare.hpp"
#include "core/image/decode.hpp"
#include "core/image/limits.hpp"

namespace tessera::client {
namespace {

constexpr int kExitDifferent = 1;
constexpr int kExitCannotCompare = 2;

const cli::HelpText kCompareHelp{
    .notes = R"(Images are compared in linear light. PNG files are decoded with the sRGB transfer function.

The relative MSE is the mean of (a-b)^2 / (b^2 + 0.01) over pixels and channels, with B as the reference. PSNR
takes 1 as the peak.)",
    .exit_statuses = {{kExitOk, "identical"},
                      {kExitDifferent, "different"},
                      {kExitCannotCompare, "cannot be compared, or wrong command line"}},
    .examples = {"tessera compare a.exr b.exr", "tessera compare a.exr b.exr --json --region 100,40,64x32"}};

struct CompareOptions {
  std::string path_a, path_b;
  std::optional<core::ImageRegion> region;  // the whole images if absent
  std::string layer;                        // of both images; empty: the images themselves
  bool json = false;
};

// "X,Y,WxH".
core::ImageRegion parse_region(const std::string& text) {
  const std::size_t first = text.find(','), second = text.find(',', first + 1),
                    cross = text.find('x', second + 1);
  if (first == std::string::npos || second == std::string::npos || cross == std::string::npos) {
    throw CLI::ValidationError(
        "--region", fmt::format("must be X,Y,WxH in pixels, such as 100,40,64x32; got '{}'", text));
  }
  const auto number = [&](std::size_t begin, std::size_t end, std::uint64_t least) {
    return static_cast<int>(
        parse_whole_number("--region", text.substr(begin, end - begin), least, core::kMaxPictureSidePx));
  };
  return {.x = number(0, first, 0),
          .y = number(first + 1, second, 0),
          .width = number(second + 1, cross, 1),
          .height = number(cross + 1, text.size(), 1)};
}

std::string describe(const core::Comparison& c, const std::optional<core::ImageRegion>& region) {
  std::string text = c.identical ? "identical" : "different";
  if (region)
    text +=
        fmt::format(" in {}x{} pixels from ({}, {})", region->width, region->height, region->x, region->y);
  text += '\n';
  text += fmt::format("largest difference  {:.9g}", c.largest_difference);
  if (c.largest_difference > 0) text += fmt::format(" at pixel ({}, {})", c.largest_x, c.largest_y);
  text += fmt::format("\nMSE                 {:.9g}\nrelative MSE        {:.9g}\n", c.mse, c.relative_mse);
  return text + fmt::format("PSNR                {:.2f} dB\n", c.psnr_db);
}

// Infinite values become null, because JSON cannot represent them.
std::string to_json(const core::Comparison& c, const std::optional<core::ImageRegion>& region) {
  nlohmann::ordered_json json = {
      {"identical", c.identical},
      {"largest_difference", c.largest_difference},
      {"largest_difference_x", c.largest_x},
      {"largest_difference_y", c.largest_y},
      {"mse", c.mse},
      {"relative_mse", c.relative_mse},
      {"psnr_db", c.psnr_db},
      {"reference_mean_square", c.reference_mean_square},
  };
  if (region) {
    json["region"] = {
        {"x", region->x}, {"y", region->y}, {"width", region->width}, {"height", region->height}};
  }
  return json.dump() + "\n";
}

int cannot_compare(const core::Error& error) {
  print_error(error);
  return kExitCannotCompare;
}

int run_compare(const CompareOptions& options) {
  const core::Result<core::Image> a = core::read_image(options.path_a, options.layer);
  if (!a) return cannot_compare(a.error());
  const core::Result<core::Image> b = core::read_image(options.path_b, options.layer);
  if (!b) return cannot_compare(b.error());
  const auto result = options.region ? core::compare(*a, *b, *options.region) : core::compare(*a, *b);
  if (!result) return cannot_compare(result.error());
  print_result(options.json ? to_json(*result, options.region) : describe(*result, options.region));
  return result->identical ? kExitOk : kExitDifferent;
}

}  // namespace

void add_compare_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("compare", "Compare two images");
  const auto options = std::make_shared<CompareOptions>();
  command->add_option("A", options->path_a, "Image file: .png, .exr, .hdr or .pfm")->required();
  command->add_option("B", options->path_b, "Reference image file")->required();
  command
      ->add_option_function<std::string>(
          "--region", [options](const std::string& text) { options->region = parse_region(text); },
          "Compare only W x H pixels whose top left is (X, Y); B can be an image of just these "
          "(render --crop)")
      ->type_name("X,Y,WxH");
  command
      ->add_option(
          "--layer", options->layer,
          "Compare this layer of .exr files, such as Normal or Direct, or one channel, such as Depth.Z")
      ->type_name("NAME");
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, kCompareHelp);
  command->callback([options, &exit_code] { exit_code = run_compare(*options); });
}

}  // namespace tessera::client
