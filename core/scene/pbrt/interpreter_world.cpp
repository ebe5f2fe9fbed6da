// SPDX-License-Identifier: Apache-2.0
// The directives that describe the world: materials, textures, media, lights, shapes and objects.
#include <fmt/format.h>

#include <array>
#include <string>
#include <utility>

#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/interpreter.hpp"

namespace tessera::core::pbrt {

void Interpreter::tell_redefinition(const File& file, std::string_view what, const std::string& name) const {
  report_.warn(
      place(file), fmt::format("another {}", what),
      fmt::format("the {} {} exists already; this one replaces it from here on", what, in_quotes(name)));
}

// --- Materials, textures, media

Status Interpreter::material(File& file) {
  const auto type = text(file);
  if (!type) return fail(type.error());
  const auto given = parameters(file, AttributeTarget::kMaterial);
  if (!given) return fail(given.error());
  const auto index = materials_.add(*type, *given);
  if (!index) return fail(index.error());
  state_.material = *index;
  return {};
}

Status Interpreter::make_named_material(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  const auto given = parameters(file, AttributeTarget::kMaterial);
  if (!given) return fail(given.error());
  if (!given->has("type"))
    report_.warn(place(file), "material without type",
                 fmt::format("the material {} has no type; a diffuse one is used", in_quotes(*name)));
  const auto index = materials_.add(given->text("type", "diffuse"), *given, *name);
  if (!index) return fail(index.error());
  if (!materials_.set_name(*name, *index)) tell_redefinition(file, "material", *name);
  return {};
}

Status Interpreter::named_material(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  state_.material = materials_.find(*name, place(file));
  return {};
}

Status Interpreter::texture(File& file) {
  std::array<std::string, 3> words;  // name, type, kind
  for (std::string& word : words) {
    auto read = text(file);
    if (!read) return fail(read.error());
    word = std::move(*read);
  }
  const auto given = parameters(file, AttributeTarget::kTexture);
  if (!given) return fail(given.error());
  return textures_.define(words[0], words[1], words[2], *given, still_transform(place(file), "the texture"));
}

Status Interpreter::make_named_medium(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  const auto given = parameters(file, AttributeTarget::kMedium);
  if (!given) return fail(given.error());
  if (!media_.define(*name, *given, still_transform(place(file), "the medium")))
    tell_redefinition(file, "medium", *name);
  return {};
}

// One name stands for both sides.
Status Interpreter::medium_interface(File& file) {
  auto inside = text(file);
  if (!inside) return fail(inside.error());
  state_.inside_medium = *inside;
  state_.outside_medium = *inside;
  const auto second = file.tokens.peek();
  if (!second) return at(file, second.error());
  if (!second->is(Token::Kind::kString)) return {};
  auto outside = text(file);
  if (!outside) return fail(outside.error());
  state_.outside_medium = std::move(*outside);
  return {};
}

MediumInterface Interpreter::media_here(const Place& where) const {
  return {media_.find(state_.inside_medium, where), media_.find(state_.outside_medium, where)};
}

// --- Lights and shapes

Status Interpreter::light_source(File& file) {
  const auto kind = text(file);
  if (!kind) return fail(kind.error());
  const auto given = parameters(file, AttributeTarget::kLight);
  if (!given) return fail(given.error());
  return lights_.add(*kind, *given, still_transform(place(file), "the light"));
}

Status Interpreter::area_light_source(File& file) {
  const auto kind = text(file);
  if (!kind) return fail(kind.error());
  const auto given = parameters(file, AttributeTarget::kLight);
  if (!given) return fail(given.error());
  auto light = lights_.area_light(*kind, *given);
  if (!light) return fail(light.error());
  state_.area_light = std::move(*light);
  return {};
}

Status Interpreter::shape(File& file) {
  const auto kind = text(file);
  if (!kind) return fail(kind.error());
  const auto given = parameters(file, AttributeTarget::kShape);
  if (!given) return fail(given.error());
  if (!in_world_) return report_.error(place(file), "a shape comes before WorldBegin");
  ShapePlacement placement;
  placement.object = object_;
  placement.to_world = state_.transform.start;
  placement.reverse_orientation = state_.reverse_orientation;
  placement.surface.material = state_.material ? *state_.material : materials_.default_material();
  placement.surface.media = media_here(place(file));
  placement.surface.light = state_.area_light;
  if (object_ && state_.area_light) {
    report_.warn(place(file), "shapes of objects do not emit, as in pbrt; the area light is ignored");
    placement.surface.light = nullptr;
  }
  if (object_) placement.to_world = still_transform(place(file), "a shape of an object");
  auto motion = object_ ? std::nullopt : motion_here(place(file));
  if (!motion) return add_shape(*kind, *given, std::move(placement));
  const std::string name = fmt::format("shape in line {}", place(file).line);
  placement.object = builder_.add_object(name);
  placement.to_world = {};
  add_moving(*placement.object, *std::move(motion), name, place(file));
  return add_shape(*kind, *given, std::move(placement));
}

Status Interpreter::add_shape(const std::string& kind, const Parameters& given, ShapePlacement placement) {
  if (!materials_.is_made(placement.surface.material)) {
    waiting_shapes_.push_back({kind, given, std::move(placement)});
    return {};
  }
  placement.surface.material = materials_.resolved(placement.surface.material);
  return shapes_.add(kind, given, std::move(placement));
}

Status Interpreter::add_waiting_shapes() {
  if (auto finished = materials_.finish(); !finished) return finished;
  for (WaitingShape& shape : std::exchange(waiting_shapes_, {}))
    if (auto added = add_shape(shape.kind, shape.parameters, std::move(shape.placement)); !added)
      return added;
  return {};
}

Status Interpreter::object_begin(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  if (object_) return report_.error(place(file), "an object is defined inside of another one");
  if (auto pushed = push_state(file, "ObjectBegin"); !pushed) return pushed;
  object_ = builder_.add_object(*name);
  if (!objects_.insert_or_assign(*name, *object_).second) tell_redefinition(file, "object", *name);
  return {};
}

Status Interpreter::object_end(File& file) {
  if (!object_) return report_.error(place(file), "ObjectEnd has no ObjectBegin");
  object_.reset();
  return pop_state(file, true);
}

Status Interpreter::object_instance(File& file) {
  const auto name = text(file);
  if (!name) return fail(name.error());
  const auto object = objects_.find(*name);
  if (object_) {
    report_.warn(place(file), "an instance inside of an object is not supported, as in pbrt; it is left out");
  } else if (object == objects_.end()) {
    report_.warn(place(file), "unknown object " + *name,
                 fmt::format("there is no object {}; it is left out", in_quotes(*name)));
  } else {
    auto motion = motion_here(place(file));
    std::string shown = fmt::format("instance in line {}", place(file).line);
    if (motion) {
      add_moving(object->second, *std::move(motion), std::move(shown), place(file));
    } else {
      builder_.add_instance(object->second, state_.transform.start.transform(), std::move(shown),
                            file_place(place(file)));
    }
  }
  return {};
}

}  // namespace tessera::core::pbrt
