// SPDX-License-Identifier: Apache-2.0
#include "client/image_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/image/exr_header.hpp"
#include "core/image/file_io.hpp"

namespace tessera::client {
namespace {

using core::ErrorCode;
using core::fail;
using core::Result;

constexpr std::array kWholeNumbers{"width", "height", "spp", "seed", "max_depth", "frame"};

// The JSON library casts other numbers, however large.
bool has_whole_numbers(const nlohmann::json& object) {
  const auto is_whole = [](const nlohmann::json& number) { return number.is_number_integer(); };
  const nlohmann::json& crop = object.at("crop");
  return std::all_of(crop.begin(), crop.end(), is_whole) &&
         std::all_of(kWholeNumbers.begin(), kWholeNumbers.end(),
                     [&](const char* key) { return is_whole(object.at(key)); });
}

// Throws an exception of the JSON library if a member is missing or of another type.
core::RenderRecord with_settings(core::RenderRecord record, const nlohmann::json& object) {
  core::RenderSettings& settings = record.settings;
  object.at("width").get_to(settings.width_px);
  object.at("height").get_to(settings.height_px);
  const auto crop = object.at("crop").get<std::array<int, 4>>();
  settings.crop = core::PixelRect{crop[0], crop[1], crop[2], crop[3]};
  object.at("spp").get_to(settings.spp);
  object.at("seed").get_to(settings.seed);
  settings.integrator = core::integrator_from_name(object.at("integrator").get<std::string>()).value();
  settings.heuristic = core::heuristic_from_name(object.at("heuristic").get<std::string>()).value();
  object.at("max_depth").get_to(settings.max_depth);
  object.at("clamp_indirect").get_to(settings.clamp_indirect);
  settings.filter.kind = core::filter_from_name(object.at("filter").get<std::string>()).value();
  object.at("filter_radius").get_to(settings.filter.radius_px);
  settings.layers = core::parse_layers(object.at("layers").get<std::string>()).value();
  settings.layers.light_groups = false;  // an image with light groups names them
  object.at("frame").get_to(record.frame);
  object.at("complete").get_to(record.complete);
  // A window of the whole image is none.
  if (settings.crop == core::PixelRect{0, 0, settings.width_px, settings.height_px}) settings.crop.reset();
  return record;
}

tl::unexpected<core::Error> broken_record(const std::string& why) {
  return fail(ErrorCode::kInvalidArgument, fmt::format("has a broken record of its render: {}", why));
}

}  // namespace

Result<core::RenderRecord> image_record_of(std::string_view bytes) {
  const auto texts = core::exr_texts(bytes);
  if (!texts)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("is no OpenEXR image ({}); only those say how they were rendered",
                            texts.error().message));
  const auto text = [&](const char* name) {
    const auto found = texts->find(name);
    return found == texts->end() ? std::string() : found->second;
  };
  const std::string settings = text("tessera/settings");
  if (settings.empty())
    return fail(ErrorCode::kFailedPrecondition,
                "does not say how it was rendered: only OpenEXR images that Tessera has rendered do");
  core::RenderRecord record{text("tessera/version"), text("tessera/fingerprint"), text("tessera/scene"), {}};
  try {
    const nlohmann::json object = nlohmann::json::parse(settings);
    if (!has_whole_numbers(object)) return broken_record("a number in it must be whole");
    record = with_settings(std::move(record), object);
  } catch (const nlohmann::json::exception& e) {
    return broken_record(e.what());
  } catch (const std::bad_optional_access&) {
    return broken_record("it names a setting that this release does not know");
  } catch (const tl::bad_expected_access<core::Error>& e) {
    return broken_record(e.error().message);
  }
  if (auto possible = core::check_settings(record.settings); !possible)
    return broken_record(possible.error().message);
  return record;
}

Result<core::RenderRecord> read_image_record(const std::string& path) {
  const auto bytes = core::read_file(path);
  if (!bytes) return fail(bytes.error());
  auto record = image_record_of(*bytes);
  if (!record) return fail(record.error().code, fmt::format("'{}' {}", path, record.error().message));
  return record;
}

}  // namespace tessera::client
