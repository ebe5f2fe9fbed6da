// SPDX-License-Identifier: Apache-2.0
// Meshes of a glTF file as triangles, with their morph targets and skin applied. Not thread-safe; functions
// throw Refusals.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/math/transform.hpp"
#include "core/scene/description.hpp"
#include "core/scene/gltf/accessor.hpp"
#include "core/scene/gltf/buffers.hpp"
#include "core/scene/gltf/document.hpp"
#include "core/scene/gltf/draco.hpp"
#include "core/scene/gltf/nodes.hpp"

namespace tessera::core::gltf {

// One primitive of a mesh.
struct Part {
  Value primitive;
  // Without materials. In the space of the mesh, or of the world if a skin has placed it. With steps if it is
  // read at several moments and deforms.
  MeshDescription mesh;
  std::vector<float> alphas{};  // of the vertex colours, if one is below 1; else empty
};

// Where a skin's joints move vertices: one map for each joint, from the mesh at rest to the world.
using JointMaps = std::vector<Transform>;
// Of a skin at one of the moments of the nodes.
JointMaps read_skin(const Value& skin, const Document& document, Accessors& accessors,
                    const std::vector<Node>& nodes, std::size_t moment);

// How a mesh is shaped at a moment.
struct MeshPose {
  float moment = 0;                   // its frame
  std::vector<float> weights{};       // of morph targets, may be empty
  std::optional<JointMaps> joints{};  // nullopt without a skin
};

// The joints and weights of vertices: JOINTS_n and WEIGHTS_n.
struct Influences {
  Accessor joints, weights;
};

// Those that the material of a primitive uses.
struct UsedAttributes {
  std::vector<std::uint32_t> uv_sets;  // of its textures, at most two
  bool tangents = false;
};

class MeshReader {
 public:
  MeshReader(const Document& document, Buffers& buffers, Accessors& accessors)
      : document_(document), buffers_(buffers), accessors_(accessors) {}

  // A primitive's triangles; nullopt if it has none, with a warning. There is at least one pose.
  std::optional<Part> read(const Value& primitive, const UsedAttributes& used,
                           const std::vector<MeshPose>& poses);

 private:
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  // What the parts of a primitive are read from.
  struct Source {
    Value primitive;
    std::optional<DracoMesh> draco;
    std::size_t vertices = 0;         // of every attribute
    std::vector<std::uint32_t> used;  // the vertices that triangles use
  };

  // Warns if not.
  bool has_area(const Value& primitive) const;
  Source open(const Value& primitive) const;
  // With at least `components` of each of the vertices; nullopt if there is no such attribute.
  std::optional<Accessor> attribute(const Source& source, const std::string& name, std::size_t components,
                                    bool or_four = false) const;
  // The same; nullopt, after a warning, of an attribute that is broken.
  std::optional<Accessor> optional_attribute(const Source& source, const std::string& name,
                                             std::size_t components, bool or_four = false) const;
  Triangles triangles_of(Source& source) const;
  Triangles stored_triangles(const Source& source) const;
  void check_triangles(const Value& primitive, std::uint64_t count) const;
  void read_attributes(Part& part, const Source& source, const UsedAttributes& used) const;
  void read_tangents(MeshDescription& mesh, const Source& source) const;
  void read_colors(Part& part, const Source& source) const;
  std::vector<Vec2> read_uvs(const Source& source, std::uint32_t set) const;
  // The second of two sets, if the primitive has both; the one that it has counts as both.
  void read_second_uvs(MeshDescription& mesh, const Source& source, std::uint32_t first,
                       std::uint32_t second) const;
  std::vector<Influences> influences_of(const Source& source) const;
  // Positions, normals and tangents at the first pose and, if they differ, at all as steps.
  void shape(MeshDescription& mesh, const Source& source, const std::vector<MeshPose>& poses) const;
  void apply_skin(MeshStep& step, const Source& source, const std::vector<Influences>& influences,
                  const JointMaps& maps) const;
  void apply_morph_targets(MeshStep& step, const Source& source, const std::vector<float>& weights) const;

  const Document& document_;
  Buffers& buffers_;
  Accessors& accessors_;
};

}  // namespace tessera::core::gltf
