// SPDX-License-Identifier: Apache-2.0
#include "core/scene/scene_ids.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

namespace tessera::core {
namespace {

std::string name_or(const std::string& name, const char* list, std::size_t index) {
  return name.empty() ? fmt::format("{}[{}]", list, index) : name;
}

std::string object_name(const SceneDescription& description, std::size_t shape) {
  return name_or(shape < description.shape_names.size() ? description.shape_names[shape] : "", "shapes",
                 shape);
}

// The name of the shape's object, if it is an instance.
std::string asset_name(const SceneDescription& description, std::size_t shape) {
  const auto* instance = std::get_if<InstanceDescription>(&description.shapes[shape]);
  if (instance == nullptr) return object_name(description, shape);
  return name_or(description.objects[instance->object].name, "objects", instance->object);
}

std::string material_name(const SceneDescription& description, std::size_t material) {
  return name_or(description.materials[material].name, "materials", material);
}

}  // namespace

CryptoNames crypto_names(const SceneDescription& description) {
  CryptoNames names;
  for (std::size_t i = 0; i < description.shapes.size(); ++i) {
    names.objects.push_back(object_name(description, i));
    names.assets.push_back(asset_name(description, i));
  }
  for (std::size_t i = 0; i < description.materials.size(); ++i)
    names.materials.push_back(material_name(description, i));
  return names;
}

SceneIds::SceneIds(const SceneDescription& description) {
  shape_ids_.reserve(description.shapes.size());
  asset_ids_.reserve(description.shapes.size());
  for (std::uint32_t i = 0; i < description.shapes.size(); ++i) {
    shape_ids_.push_back(crypto_id(object_name(description, i)));
    asset_ids_.push_back(crypto_id(asset_name(description, i)));
    if (std::holds_alternative<InstanceDescription>(description.shapes[i])) instance_shapes_.push_back(i);
  }
  for (std::size_t i = 0; i < description.materials.size(); ++i)
    material_ids_.push_back(crypto_id(material_name(description, i)));
}

std::uint32_t SceneIds::shape_of(const Hit& hit) const {
  if (hit.in_instance()) return instance_shapes_[hit.instance];
  const auto behind =
      std::upper_bound(starts_.begin(), starts_.end(), hit.primitive,
                       [](std::uint32_t id, const ShapeStart& start) { return id < start.first_primitive; });
  return std::prev(behind)->shape;
}

}  // namespace tessera::core
