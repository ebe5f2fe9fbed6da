// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/draco.hpp"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <stdexcept>
#include <utility>

#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

// By which integers must be multiplied that the stream does not know to be normalised.
float factor_of(const Accessor::Layout& layout, const draco::PointAttribute& attribute) {
  if (!layout.normalized || attribute.normalized()) return 1;
  switch (layout.component) {
    case Component::kByte:
      return 1.0f / 127;
    case Component::kUnsignedByte:
      return 1.0f / 255;
    case Component::kShort:
      return 1.0f / 32767;
    case Component::kUnsignedShort:
      return 1.0f / 65535;
    case Component::kUnsignedInt:
    case Component::kFloat:
      break;
  }
  return 1;
}

Accessor floats_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                   const Accessor::Layout& layout) {
  constexpr std::size_t kMaxComponents = 4;
  const std::size_t components = std::min(layout.components, kMaxComponents), points = mesh.num_points();
  const float factor = factor_of(layout, attribute);
  auto bytes = std::make_shared<std::string>(points * components * sizeof(float), '\0');
  for (std::size_t i = 0; i < points; ++i) {
    std::array<float, kMaxComponents> values{};
    const auto at = attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(i)));
    if (at.value() < attribute.size())
      attribute.ConvertValue<float>(at, static_cast<std::int8_t>(components), values.data());
    for (float& value : values) value *= factor;
    std::copy_n(reinterpret_cast<const char*>(values.data()), components * sizeof(float),
                bytes->data() + i * components * sizeof(float));
  }
  const std::string_view all = *bytes;
  return {{Component::kFloat, components, false, components * sizeof(float), points}, all, std::move(bytes)};
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(const draco::Mesh& mesh, const Value& extension) {
  std::vector<std::array<std::uint32_t, 3>> triangles(mesh.num_faces());
  for (std::uint32_t i = 0; i < mesh.num_faces(); ++i) {
    const draco::Mesh::Face& face = mesh.face(draco::FaceIndex(i));
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = face[k].value();
      if (vertex >= mesh.num_points()) extension.refuse("its compressed bytes are damaged");
      triangles[i][k] = vertex;
    }
  }
  return triangles;
}

std::unique_ptr<draco::Mesh> decompress(const Value& extension, std::string_view bytes) {
  draco::DecoderBuffer buffer;
  buffer.Init(bytes.data(), bytes.size());
  draco::Decoder decoder;
  try {
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (decoded.ok()) return std::move(decoded).value();
  } catch (const std::length_error&) {  // of a count that no memory could hold
  }
  extension.refuse("its compressed bytes are damaged");
}

}  // namespace

DracoMesh decode_draco(const Value& extension, std::string_view bytes,
                       const std::vector<DracoAttribute>& attributes, std::uint64_t max_triangles) {
  const std::unique_ptr<draco::Mesh> mesh = decompress(extension, bytes);
  if (mesh->num_faces() > max_triangles)
    extension.refuse(fmt::format("has {} triangles, more than are allowed here", mesh->num_faces()),
                     ErrorCode::kResourceExhausted);
  DracoMesh result{triangles_of(*mesh, extension), {}};
  for (const DracoAttribute& wanted : attributes) {
    const draco::PointAttribute* attribute = mesh->GetAttributeByUniqueId(wanted.id);
    if (attribute == nullptr)
      extension.refuse(
          fmt::format("the compressed mesh has no attribute {} for {}", wanted.id, in_quotes(wanted.name)));
    result.attributes.emplace(wanted.name, floats_of(*mesh, *attribute, wanted.layout));
  }
  return result;
}

}  // namespace tessera::core::gltf
