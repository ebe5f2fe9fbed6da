// SPDX-License-Identifier: Apache-2.0
// glTF files made by tests.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/scene/description.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::test {

// A glTF file under construction, with one buffer.
class GltfFile {
 public:
  nlohmann::json json{{"asset", {{"version", "2.0"}}}};

  // Each returns the index of the new view or accessor.
  int view(const std::string& bytes, int stride = 0);
  int accessor(int view, int component_type, const char* type, std::size_t count, bool normalized = false,
               int offset = 0);
  int floats(const char* type, const std::vector<float>& values);
  int indices(const std::vector<std::uint16_t>& values);

  // The index of a new mesh of one triangle (0, 0, 0), (1, 0, 0), (0, 1, 0) with these corners as texture
  // coordinates, in glTF's orientation.
  int triangle(int material = -1);
  // Adds a node to the scene.
  void node(const nlohmann::json& node) { json["nodes"].push_back(node); }

  // As .gltf with the buffer in a data URI, and as .glb.
  std::string text() const;
  std::string binary() const;

 private:
  std::string buffer_;
};

std::string bytes_of(const std::vector<float>& values);
std::string base64(const std::string& bytes);

// Loads the text as "model.gltf", with other files beside it.
Result<SceneDescription> load_gltf(const std::string& text, MemoryAssets::Files files = {});
// The error's message, or "no mistake".
std::string gltf_mistake(const std::string& text, MemoryAssets::Files files = {});
// The warnings, one in each line.
std::string warnings_of(const SceneDescription& scene);
const MeshDescription& mesh_of(const SceneDescription& scene, std::size_t shape = 0);

}  // namespace tessera::core::test
