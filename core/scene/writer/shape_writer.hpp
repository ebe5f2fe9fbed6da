// SPDX-License-Identifier: Apache-2.0
// Shapes as JSON of a scene file, with the files of meshes and curves that they name. Not thread-safe.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/description.hpp"
#include "core/scene/writer/json_text.hpp"
#include "core/scene/writer/table_text.hpp"

namespace tessera::core {

class ShapeWriter {
 public:
  // Writes a file, called by its kind, number and ending, and returns its path.
  using WriteFile = std::function<Result<std::string>(std::string_view kind, std::size_t number,
                                                      std::string_view ending, std::string_view bytes)>;
  // The names must outlive this object.
  ShapeWriter(const SceneNames& names, WriteFile write_file)
      : names_(names), write_file_(std::move(write_file)) {}

  // One line for each shape. `motions` are those of instances, by the index of the shape.
  Result<std::vector<std::string>> texts(const std::vector<ShapeDescription>& shapes,
                                         const std::vector<std::string>& names,
                                         const std::map<std::uint32_t, const InstanceMotion*>& motions);

 private:
  using Object = json_text::Object;

  Result<Object> mesh_object(const MeshDescription& mesh);
  Object instance_object(const InstanceDescription& instance, const InstanceMotion* motion) const;
  template <typename Shape>
  Object plain_object(std::string_view type, const Shape& shape) const;
  Object disk_object(const DiskDescription& disk) const;
  Object cylinder_object(const CylinderDescription& cylinder) const;
  Result<Object> curves_object(const CurvesDescription& curves);
  Result<std::string> mesh_file_text(const MeshDescription& mesh,
                                     const std::vector<std::uint32_t>& materials);
  std::string material_name(std::uint32_t material) const {
    return json_text::text(names_.materials[material]);
  }

  const SceneNames& names_;
  WriteFile write_file_;
  std::size_t meshes_ = 0, curves_ = 0;
};

}  // namespace tessera::core
