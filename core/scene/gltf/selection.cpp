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

std::optional<Value> chosen_of(const Value& list, std::string_view what, const Value& extension) {
  const std::string wanted = extension.text(what);
  if (wanted.empty()) return std::nullopt;
  return list.at(selected(what, wanted, names_in(list)));
}

// The first one if nothing is said. Animations may be named "none" and "all".
std::vector<Value> animations_of(const Value& list, const Value& extension) {
  const std::string wanted = extension.text(kSelectAnimation);
  const std::vector<std::string> names = names_in(list);
  const bool is_name = std::find(names.begin(), names.end(), wanted) != names.end();
  if (wanted == kSelectNone && !is_name) return {};
  std::vector<Value> chosen;
  if (wanted == kSelectAll && !is_name) {
    for (std::size_t i = 0; i < list.size(); ++i) chosen.push_back(list.at(i));
  } else if (!wanted.empty()) {
    chosen.push_back(list.at(selected(kSelectAnimation, wanted, names)));
  } else if (list.size() > 0) {
    chosen.push_back(list.at(0));
  }
  return chosen;
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
  const Value variants = root.extension("KHR_materials_variants")["variants"];
  camera = extension.text(kSelectCamera);
  scene = chosen_of(root["scenes"], kSelectScene, extension);
  animations = animations_of(root["animations"], extension);
  names_animations = !extension.text(kSelectAnimation).empty();
  seconds = seconds_of(extension, kSelectTime, !animations.empty());
  shutter_seconds = seconds_of(extension, kSelectShutter, !animations.empty()).value_or(0);
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
