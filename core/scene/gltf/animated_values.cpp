// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/animated_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/keyframe_sampler.hpp"
#include "core/scene/gltf/selection.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

constexpr std::string_view kExtension = "KHR_animation_pointer";

// The reference tokens of a JSON pointer (RFC 6901).
std::vector<std::string> tokens_of(std::string_view pointer) {
  std::vector<std::string> tokens;
  for (std::size_t i = 0; i < pointer.size(); ++i) {
    if (pointer[i] == '/') {
      tokens.emplace_back();
    } else if (!tokens.empty()) {
      const bool is_escape = pointer[i] == '~' && i + 1 < pointer.size();
      tokens.back() += is_escape ? (pointer[++i] == '1' ? '/' : '~') : pointer[i];
    }
  }
  return tokens;
}

bool may_change(const std::vector<std::string>& tokens) {
  constexpr std::array<std::string_view, 4> kLists{"materials", "nodes", "meshes", "cameras"};
  if (tokens.size() < 3) return false;
  if (tokens[0] == "extensions") return tokens[1] == "KHR_lights_punctual";
  return std::find(kLists.begin(), kLists.end(), tokens[0]) != kLists.end();
}

// The member or element; null if there is none. A member that may have a default is added.
JsonValue* step(JsonValue& json, const std::string& token, bool may_add) {
  if (auto* list = std::get_if<JsonValue::Array>(&json.content)) {
    std::size_t index = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), index);
    const bool is_index = error == std::errc() && end == token.data() + token.size() && index < list->size();
    return is_index ? &(*list)[index] : nullptr;
  }
  auto* members = std::get_if<JsonValue::Object>(&json.content);
  if (members == nullptr) return nullptr;
  const auto found =
      std::find_if(members->begin(), members->end(), [&](const auto& member) { return member.key == token; });
  if (found != members->end()) return &found->value;
  if (!may_add) return nullptr;
  members->push_back({token, json.line, {{}, json.line}});
  return &members->back().value;
}

// nullptr if it points to nothing.
JsonValue* target_of(JsonValue& root, const std::vector<std::string>& tokens) {
  JsonValue* at = &root;
  for (std::size_t i = 0; i < tokens.size() && at != nullptr; ++i) {
    const bool is_last = i + 1 == tokens.size();
    at = step(*at, tokens[i], is_last || tokens[i] == "pbrMetallicRoughness");
    if (at != nullptr && !is_last && std::holds_alternative<JsonValue::Null>(at->content))
      at->content = JsonValue::Object();
  }
  return at;
}

JsonValue json_of(float number, int line) {
  return {JsonValue::Number{static_cast<double>(number), {}}, line};
}

// A boolean, a number or a list of numbers, as `before` is, or as the member of this name would be.
JsonValue json_of(const std::vector<float>& values, const JsonValue& before, std::string_view name,
                  int line) {
  if (std::holds_alternative<bool>(before.content) || name == "visible") return {values[0] != 0, line};
  const bool is_list = std::holds_alternative<JsonValue::Array>(before.content) || name == "weights";
  if (values.size() == 1 && !is_list) return json_of(values[0], line);
  JsonValue::Array list;
  for (const float value : values) list.push_back(json_of(value, line));
  return {std::move(list), line};
}

std::size_t components_of(const Document& document, const Value& sampler) {
  const Value accessor = document.element("accessors", sampler["output"]);
  constexpr std::array<std::string_view, 4> kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto type = std::find(kTypes.begin(), kTypes.end(), accessor.text("type"));
  if (type == kTypes.end()) accessor.refuse("the output of an animation is no number or vector");
  return static_cast<std::size_t>(type - kTypes.begin()) + 1;
}

// The channels of all animations together; more is a damaged or hostile file.
constexpr std::size_t kMaxNumbers = std::size_t{1} << 20;

class PointerAnimation {
 public:
  PointerAnimation(Document& document, float seconds) : document_(document), seconds_(seconds) {}

  void apply(const Value& animation) {
    const Value channels = animation["channels"];
    for (std::size_t i = 0; i < channels.size(); ++i)
      if (!pointer_of(channels.at(i)["target"]).empty())
        document_.try_to(channels.at(i), "animation pointer", "it is ignored",
                         [&] { apply(animation, channels.at(i)); });
  }

 private:
  void apply(const Value& animation, const Value& channel) {
    const Value target = channel["target"];
    const std::string pointer = pointer_of(target);
    const std::vector<std::string> tokens = tokens_of(pointer);
    if (!may_change(tokens))
      target.refuse(fmt::format("an animation of {} is not supported", in_quotes(pointer)));
    const auto values =
        values_at(Document::element(animation["samplers"], channel["sampler"]), tokens.back() == "rotation");
    JsonValue* json = target_of(document_.json(), tokens);
    if (json == nullptr) target.refuse(fmt::format("there is no {}", in_quotes(pointer)));
    json->content = json_of(values, *json, tokens.back(), target.line()).content;
  }

  std::vector<float> values_at(const Value& sampler, bool is_rotation) {
    const std::size_t components = components_of(document_, sampler);
    KeyframeSampler keyframes(sampler, accessors_, components);
    if (components == 1) keyframes.split_weights();
    if (keyframes.empty()) sampler.refuse("has no keyframes");
    numbers_ += keyframes.width();
    if (numbers_ > kMaxNumbers) sampler.refuse("there are too many animated numbers");
    std::vector<float> values = keyframes.at(seconds_, is_rotation && components == 4);
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
      sampler.refuse("has a value that is not finite");
    return values;
  }

  Document& document_;
  float seconds_;
  Buffers buffers_{document_};
  Accessors accessors_{document_, buffers_};
  std::size_t numbers_ = 0;
};

bool has_pointers(const Value& animation) {
  const Value channels = animation["channels"];
  for (std::size_t i = 0; i < channels.size(); ++i)
    if (!pointer_of(channels.at(i)["target"]).empty()) return true;
  return false;
}

}  // namespace

std::string pointer_of(const Value& target) {
  return target.extension(kExtension).text("pointer");
}

void apply_pointers(Document& document) {
  const Selection selection(document);
  std::optional<PointerAnimation> pointers;  // which reads buffers
  for (const Value& animation : selection.animations) {
    if (!has_pointers(animation)) continue;
    if (!pointers) pointers.emplace(document, selection.seconds.value_or(0));
    pointers->apply(animation);
  }
}

}  // namespace tessera::core::gltf
