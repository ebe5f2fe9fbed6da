// SPDX-License-Identifier: Apache-2.0
// The properties of a PLY file's vertices that are known, by all the names that programs write. Stateless;
// thread-safe.
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "core/scene/description.hpp"
#include "core/scene/loader/ply_header.hpp"

namespace tessera::core {

// Where a property of vertices goes.
using StorePlyValue = void (*)(MeshDescription& mesh, std::size_t vertex, float value);

enum class PlyVertexData { kPosition, kNormal, kTangent, kHandedness, kUv, kSecondUv, kColor };

struct PlyVertexProperty {
  std::string_view name;
  PlyVertexData data;
  int component;
  StorePlyValue store;
};

// Null for properties that are not known.
const PlyVertexProperty* ply_vertex_property(const PlyProperty& property);

// Whether the element has all components of the data. Second texture coordinates count beside first ones, and
// handedness beside tangents.
bool has_data(const PlyElement& element, PlyVertexData data);

// Makes colours as written, of all vertices of the element, linear: integers are sRGB codes. Those of wide
// integers range to 255 if none is larger.
void decode_colors(const PlyElement& element, std::vector<Rgb>& colors);

}  // namespace tessera::core
