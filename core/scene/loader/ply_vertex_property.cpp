// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/ply_vertex_property.hpp"

#include <algorithm>
#include <array>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

constexpr double kLargestByte = 255;

constexpr StorePlyValue kSetX = [](MeshDescription& m, std::size_t i, float v) { m.positions[i].x = v; };
constexpr StorePlyValue kSetY = [](MeshDescription& m, std::size_t i, float v) { m.positions[i].y = v; };
constexpr StorePlyValue kSetZ = [](MeshDescription& m, std::size_t i, float v) { m.positions[i].z = v; };
constexpr StorePlyValue kSetNormalX = [](MeshDescription& m, std::size_t i, float v) { m.normals[i].x = v; };
constexpr StorePlyValue kSetNormalY = [](MeshDescription& m, std::size_t i, float v) { m.normals[i].y = v; };
constexpr StorePlyValue kSetNormalZ = [](MeshDescription& m, std::size_t i, float v) { m.normals[i].z = v; };
constexpr StorePlyValue kSetTangentX = [](MeshDescription& m, std::size_t i, float v) {
  m.tangents[i].direction.x = v;
};
constexpr StorePlyValue kSetTangentY = [](MeshDescription& m, std::size_t i, float v) {
  m.tangents[i].direction.y = v;
};
constexpr StorePlyValue kSetTangentZ = [](MeshDescription& m, std::size_t i, float v) {
  m.tangents[i].direction.z = v;
};
constexpr StorePlyValue kSetHandedness = [](MeshDescription& m, std::size_t i, float v) {
  m.tangents[i].handedness = v;
};
constexpr StorePlyValue kSetU = [](MeshDescription& m, std::size_t i, float v) { m.uvs[i].x = v; };
constexpr StorePlyValue kSetV = [](MeshDescription& m, std::size_t i, float v) { m.uvs[i].y = v; };
constexpr StorePlyValue kSetSecondU = [](MeshDescription& m, std::size_t i, float v) {
  m.second_uvs[i].x = v;
};
constexpr StorePlyValue kSetSecondV = [](MeshDescription& m, std::size_t i, float v) {
  m.second_uvs[i].y = v;
};
constexpr StorePlyValue kSetRed = [](MeshDescription& m, std::size_t i, float v) { m.colors[i].r = v; };
constexpr StorePlyValue kSetGreen = [](MeshDescription& m, std::size_t i, float v) { m.colors[i].g = v; };
constexpr StorePlyValue kSetBlue = [](MeshDescription& m, std::size_t i, float v) { m.colors[i].b = v; };

constexpr std::array<PlyVertexProperty, 29> kVertexProperties{{
    {"x", PlyVertexData::kPosition, 0, kSetX},
    {"y", PlyVertexData::kPosition, 1, kSetY},
    {"z", PlyVertexData::kPosition, 2, kSetZ},
    {"nx", PlyVertexData::kNormal, 0, kSetNormalX},
    {"ny", PlyVertexData::kNormal, 1, kSetNormalY},
    {"nz", PlyVertexData::kNormal, 2, kSetNormalZ},
    {"tx", PlyVertexData::kTangent, 0, kSetTangentX},
    {"ty", PlyVertexData::kTangent, 1, kSetTangentY},
    {"tz", PlyVertexData::kTangent, 2, kSetTangentZ},
    {"tw", PlyVertexData::kHandedness, 0, kSetHandedness},
    {"u", PlyVertexData::kUv, 0, kSetU},
    {"v", PlyVertexData::kUv, 1, kSetV},
    {"s", PlyVertexData::kUv, 0, kSetU},
    {"t", PlyVertexData::kUv, 1, kSetV},
    {"texture_u", PlyVertexData::kUv, 0, kSetU},
    {"texture_v", PlyVertexData::kUv, 1, kSetV},
    {"texture_s", PlyVertexData::kUv, 0, kSetU},
    {"texture_t", PlyVertexData::kUv, 1, kSetV},
    {"u1", PlyVertexData::kSecondUv, 0, kSetSecondU},
    {"v1", PlyVertexData::kSecondUv, 1, kSetSecondV},
    {"red", PlyVertexData::kColor, 0, kSetRed},
    {"green", PlyVertexData::kColor, 1, kSetGreen},
    {"blue", PlyVertexData::kColor, 2, kSetBlue},
    {"r", PlyVertexData::kColor, 0, kSetRed},
    {"g", PlyVertexData::kColor, 1, kSetGreen},
    {"b", PlyVertexData::kColor, 2, kSetBlue},
    {"diffuse_red", PlyVertexData::kColor, 0, kSetRed},
    {"diffuse_green", PlyVertexData::kColor, 1, kSetGreen},
    {"diffuse_blue", PlyVertexData::kColor, 2, kSetBlue},
}};

int components_of(PlyVertexData data) {
  if (data == PlyVertexData::kHandedness) return 1;
  return data == PlyVertexData::kUv || data == PlyVertexData::kSecondUv ? 2 : 3;
}

double largest_code(PlyType type) {
  if (size_of(type) == 1) return kLargestByte;
  return size_of(type) == 2 ? 65535 : 4294967295.0;
}

}  // namespace

const PlyVertexProperty* ply_vertex_property(const PlyProperty& property) {
  const auto found = std::ranges::find(kVertexProperties, property.name, &PlyVertexProperty::name);
  return property.is_list || found == kVertexProperties.end() ? nullptr : &*found;
}

bool has_data(const PlyElement& element, PlyVertexData data) {
  if (data == PlyVertexData::kSecondUv && !has_data(element, PlyVertexData::kUv)) return false;
  if (data == PlyVertexData::kHandedness && !has_data(element, PlyVertexData::kTangent)) return false;
  const int components = components_of(data);
  for (int component = 0; component < components; ++component)
    if (std::ranges::none_of(element.properties, [&](const PlyProperty& property) {
          const PlyVertexProperty* known = ply_vertex_property(property);
          return known != nullptr && known->data == data && known->component == component;
        }))
      return false;
  return true;
}

void decode_colors(const PlyElement& element, std::vector<Rgb>& colors) {
  const auto found = std::ranges::find_if(element.properties, [](const PlyProperty& property) {
    const PlyVertexProperty* known = ply_vertex_property(property);
    return known != nullptr && known->data == PlyVertexData::kColor;
  });
  if (colors.empty() || is_floating_point(found->type)) return;
  float largest = 0;
  for (const Rgb color : colors) largest = std::max(largest, max_component(color));
  const double most = largest > kLargestByte ? largest_code(found->type) : kLargestByte;
  const auto linear = [most](float code) { return srgb_decode(std::clamp(code / most, 0.0, 1.0)); };
  for (Rgb& color : colors) color = {linear(color.r), linear(color.g), linear(color.b)};
}

}  // namespace tessera::core
