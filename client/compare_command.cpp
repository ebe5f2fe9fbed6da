// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/commands.hpp"
#include "client/console.hpp"
#include "client/image_layers.hpp"
#include "client/scene_flags.hpp"
#include "core/base/printable.hpp"
#include "core/image/compare.hpp"
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
                      {kExitCannotCompare, "cannot be compared, or wrong command line"},
                      {kExitInterrupted, "interrupted"}},
    .examples = {"tessera compare a.exr b.exr", "tessera compare a.exr b.exr --json --region 100,40,64x32",
                 "tessera compare a.exr b.exr --layer all"}};

struct CompareOptions {
  std::string path_a, path_b;
  std::optional<core::ImageRegion> region;  // the whole images if absent
  std::string layer;                        // of both images, or "all"; empty: the images themselves
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
        parse_whole_number("--region", text.substr(begin, end - begin), least, core::kMaxImageSidePx));
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
nlohmann::ordered_json to_json(const core::Comparison& c) {
  return {
      {"identical", c.identical},
      {"largest_difference", c.largest_difference},
      {"largest_difference_x", c.largest_x},
      {"largest_difference_y", c.largest_y},
      {"mse", c.mse},
      {"relative_mse", c.relative_mse},
      {"psnr_db", c.psnr_db},
      {"reference_mean_square", c.reference_mean_square},
  };
}

nlohmann::ordered_json to_json(const core::ImageRegion& region) {
  return {{"x", region.x}, {"y", region.y}, {"width", region.width}, {"height", region.height}};
}

// Names of files and layers need not be UTF-8.
std::string to_line(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', true, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

std::string to_json(const core::Comparison& c, const std::optional<core::ImageRegion>& region) {
  nlohmann::ordered_json json = to_json(c);
  if (region) json["region"] = to_json(*region);
  return to_line(json);
}

int cannot_compare(const core::Error& error) {
  print_error(error);
  return kExitCannotCompare;
}

core::Result<core::Comparison> compare_layer(const ImageFile& file_a, const ImageFile& file_b,
                                             const std::string& layer,
                                             const std::optional<core::ImageRegion>& region) {
  const core::Result<core::Image> a = file_a.decode(layer);
  if (!a) return core::fail(a.error());
  const core::Result<core::Image> b = file_b.decode(layer);
  if (!b) return core::fail(b.error());
  return region ? core::compare(*a, *b, *region) : core::compare(*a, *b);
}

// A layer of either file, and its comparison if both have it.
struct ComparedLayer {
  std::string name;
  std::optional<core::Comparison> result;
  std::string only_in{};  // the path of the file that alone has it

  bool is_identical() const { return result && result->identical; }
};

core::Result<std::vector<ComparedLayer>> compare_layers(const ImageFile& a, const ImageFile& b,
                                                        const std::optional<core::ImageRegion>& region) {
  const auto has = [](const ImageFile& file, const std::string& layer) {
    return std::ranges::count(file.layers(), layer) > 0;
  };
  std::vector<ComparedLayer> layers;
  for (const std::string& layer : a.layers()) {
    if (!has(b, layer)) {
      layers.push_back({layer, std::nullopt, a.path()});
      continue;
    }
    const auto result = compare_layer(a, b, layer, region);
    if (!result) return core::fail(result.error());
    layers.push_back({layer, *result});
  }
  for (const std::string& layer : b.layers())
    if (!has(a, layer)) layers.push_back({layer, std::nullopt, b.path()});
  return layers;
}

std::string describe(const ComparedLayer& layer) {
  if (!layer.result) return "only in " + core::printable(layer.only_in);
  if (layer.result->identical) return "identical";
  const core::Comparison& c = *layer.result;
  return fmt::format("largest difference {:.9g} at pixel ({}, {}), relative MSE {:.9g}", c.largest_difference,
                     c.largest_x, c.largest_y, c.relative_mse);
}

std::string describe(const std::vector<ComparedLayer>& layers, bool identical) {
  const auto shown = [](const ComparedLayer& layer) {
    return layer.name.empty() ? std::string("(beauty)") : core::printable(layer.name);
  };
  std::size_t width = 0;
  for (const ComparedLayer& layer : layers) width = std::max(width, shown(layer).size());
  std::string text = identical ? "identical\n" : "different\n";
  for (const ComparedLayer& layer : layers)
    text += fmt::format("{:<{}}  {}\n", shown(layer), width, describe(layer));
  return text;
}

std::string to_json(const std::vector<ComparedLayer>& layers, bool identical,
                    const std::optional<core::ImageRegion>& region) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ComparedLayer& layer : layers) {
    nlohmann::ordered_json entry = {{"layer", layer.name}};
    if (layer.result) entry.update(to_json(*layer.result));
    if (!layer.only_in.empty()) entry["only_in"] = layer.only_in;
    list.push_back(std::move(entry));
  }
  nlohmann::ordered_json json = {{"identical", identical}, {"layers", std::move(list)}};
  if (region) json["region"] = to_json(*region);
  return to_line(json);
}

int compare_all_layers(const ImageFile& a, const ImageFile& b, const CompareOptions& options) {
  const auto layers = compare_layers(a, b, options.region);
  if (!layers) return cannot_compare(layers.error());
  const bool identical = std::ranges::all_of(*layers, &ComparedLayer::is_identical);
  print_result(options.json ? to_json(*layers, identical, options.region) : describe(*layers, identical));
  return identical ? kExitOk : kExitDifferent;
}

int run_compare(const CompareOptions& options) {
  const auto a = ImageFile::read(options.path_a);
  if (!a) return cannot_compare(a.error());
  const auto b = ImageFile::read(options.path_b);
  if (!b) return cannot_compare(b.error());
  if (options.layer == "all") return compare_all_layers(*a, *b, options);
  const auto result = compare_layer(*a, *b, options.layer, options.region);
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
      ->add_option("--layer", options->layer,
                   "Compare this layer of .exr files, such as normal, or by the name in the files, such as "
                   "DiffCol, or "
                   "one channel, such as Normal.X; all: the image and every layer, one by one")
      ->type_name("NAME|all");
  command->add_flag("--json", options->json, "Print one line of JSON");
  cli::set_help(*command, kCompareHelp);
  command->callback([options, &exit_code] { exit_code = run_compare(*options); });
}

}  // namespace tessera::client
