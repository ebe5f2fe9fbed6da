// SPDX-License-Identifier: Apache-2.0
// Converts Mitsuba's shapes with their materials. Not thread-safe.
#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <string>

#include "core/scene/mitsuba/materials.hpp"
#include "core/scene/mitsuba/media.hpp"
#include "core/scene/mitsuba/meshes.hpp"
#include "core/scene/mitsuba/plugin.hpp"

namespace tessera::core::mitsuba {

class ShapeConverter {
 public:
  ShapeConverter(Conversion& conversion, MaterialConverter& materials, MediumConverter& media)
      : conversion_(conversion), materials_(materials), media_(media) {}

  // Adds the shape to the scene, or to an object.
  void add(const Plugin& shape, std::optional<std::uint32_t> object = {});

 private:
  // The textures that a shape's materials look up.
  struct TextureNeeds {
    bool attributes = false, images = false;
  };

  void add_mesh(const Plugin& shape, std::optional<std::uint32_t> object);
  void add_finished_mesh(const Plugin& shape, ShapeMesh mesh, std::optional<std::uint32_t> object);
  void add_sphere(const Plugin& shape, std::optional<std::uint32_t> object);
  void add_disk(const Plugin& shape, std::optional<std::uint32_t> object);
  void add_cylinder(const Plugin& shape, std::optional<std::uint32_t> object);
  void add_curves(const Plugin& shape, CurveBasis basis, std::optional<std::uint32_t> object);
  void add_instance(const Plugin& shape, std::optional<std::uint32_t> object);
  std::optional<std::vector<MotionStep>> motion_of(const Plugin& shape, const KeyedTransforms& keys);
  // The object of a shape group.
  std::uint32_t group(const Plugin& shape);
  MaterialIndex material(const Plugin& shape, const TextureSite& site);
  TextureNeeds needs(const Plugin& shape) const;
  void collect_needs(NodeId id, std::map<NodeId, bool>& seen, TextureNeeds& needs) const;
  std::string name_of(const Plugin& shape) const;

  Conversion& conversion_;
  MaterialConverter& materials_;
  MediumConverter& media_;
  std::uint64_t merged_ = 0;  // the parts of merges, which can share parts
  std::map<NodeId, std::uint32_t> groups_;
  std::list<AttributeTextures> attributes_;  // whose addresses materials are known by
};

}  // namespace tessera::core::mitsuba
