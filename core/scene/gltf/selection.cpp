// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/selection.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "core/camera/camera_description.hpp"
#include "core/scene/import/selection.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

std::size_t selected(std::string_view what, std::string_view wanted, const std::vector<std::string>& names) {
  const auto index = find_selected(what, wanted, names);
  if (!index) throw Refusal{0, index.error(), false};
  return *index;
}

std::vector<std::string> names_in(const Value& list) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < list.size(); ++i) names.push_back(printable(list.at(i).text("name")));
  return names;
}

// Whether no animation is wanted, rather than one of this name.
bool is_none(std::string_view wanted, const std::vector<std::string>& names) {
  return wanted == kSelectNone && std::find(names.begin(), names.end(), wanted) == names.end();
}

std::optional<Value> chosen_of(const Value& list, std::string_view what, const Value& extension) {
  const std::string wanted = extension.text(what);
  if (wanted.empty()) return std::nullopt;
  return list.at(selected(what, wanted, names_in(list)));
}

std::optional<float> seconds_of(const Value& extension, std::string_view what, bool is_animated) {
  const Value time = extension[what];
  if (!time.exists()) return std::nullopt;
  if (!is_animated) {
    const bool left_out = extension.text(kSelectAnimation) == kSelectNone;
    throw Refusal{
        0,
        {ErrorCode::kInvalidArgument, left_out ? "without an animation, no time can be chosen"
                                               : "has no animation of which a time could be chosen"},
        false};
  }
  return time.number();
}

}  // namespace

Selection::Selection(const Document& document) {
  const Value root = document.root(), extension = root.extension(kGltfSelection);
  const Value animations = root["animations"];
  const Value variants = root.extension("KHR_materials_variants")["variants"];
  camera = extension.text(kSelectCamera);
  scene = chosen_of(root["scenes"], kSelectScene, extension);
  if (!is_none(extension.text(kSelectAnimation), names_in(animations))) {
    animation = chosen_of(animations, kSelectAnimation, extension);
    if (!animation && animations.size() > 0) animation = animations.at(0);
  }
  seconds = seconds_of(extension, kSelectTime, animation.has_value());
  shutter_seconds = seconds_of(extension, kSelectShutter, animation.has_value()).value_or(0);
  if (!(shutter_seconds >= 0 && shutter_seconds <= kMaxShutterFrames))
    extension[kSelectShutter].refuse(fmt::format("must be from 0 to {:g} seconds", kMaxShutterFrames));
  if (const std::string wanted = extension.text(kSelectVariant); !wanted.empty())
    variant = selected(kSelectVariant, wanted, names_in(variants));
  SceneContents& contents = document.builder().scene().contents;
  contents.scenes = names_in(root["scenes"]);
  contents.variants = names_in(variants);
}

std::vector<float> Selection::moments() const {
  constexpr int kParts = 8;
  std::vector<float> moments{0};
  for (int i = 1; i <= kParts && shutter_seconds > 0; ++i)
    moments.push_back(shutter_seconds * static_cast<float>(i) / kParts);
  return moments;
}

std::size_t selected_camera(const Selection& selection, const std::vector<std::string>& names) {
  return selection.camera.empty() ? 0 : selected(kSelectCamera, selection.camera, names);
}

}  // namespace tessera::core::gltf
