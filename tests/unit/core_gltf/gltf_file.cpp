// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_gltf/gltf_file.hpp"

#include <utility>

namespace tessera::core::test {
namespace {

template <typename T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::size_t components(const std::string& type) {
  if (type == "SCALAR") return 1;
  return type == "MAT4" ? 16 : static_cast<std::size_t>(type[3] - '0');
}

std::string word(std::size_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes.push_back(static_cast<char>(value >> shift & 0xff));
  return bytes;
}

std::string chunk(const char* type, std::string bytes, char filler) {
  while (bytes.size() % 4 != 0) bytes.push_back(filler);
  return word(bytes.size()) + std::string(type, 4) + bytes;
}

}  // namespace

std::string bytes_of(const std::vector<float>& values) {
  return raw(values);
}

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text.push_back(i + k > bytes.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63]);
  }
  return text;
}

int GltfFile::view(const std::string& bytes, int stride) {
  nlohmann::json view{{"buffer", 0}, {"byteOffset", buffer_.size()}, {"byteLength", bytes.size()}};
  if (stride > 0) view["byteStride"] = stride;
  buffer_ += bytes;
  while (buffer_.size() % 4 != 0) buffer_.push_back('\0');
  json["bufferViews"].push_back(view);
  return static_cast<int>(json["bufferViews"].size()) - 1;
}

int GltfFile::accessor(int view, int component_type, const char* type, std::size_t count, bool normalized,
                       int offset) {
  json["accessors"].push_back({{"bufferView", view},
                               {"byteOffset", offset},
                               {"componentType", component_type},
                               {"type", type},
                               {"count", count},
                               {"normalized", normalized}});
  return static_cast<int>(json["accessors"].size()) - 1;
}

int GltfFile::floats(const char* type, const std::vector<float>& values) {
  return accessor(view(raw(values)), 5126, type, values.size() / components(type));
}

int GltfFile::indices(const std::vector<std::uint16_t>& values) {
  return accessor(view(raw(values)), 5123, "SCALAR", values.size());
}

int GltfFile::triangle(int material) {
  nlohmann::json primitive{{"attributes",
                            {{"POSITION", floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})},
                             {"TEXCOORD_0", floats("VEC2", {0, 0, 1, 0, 0, 1})}}}};
  if (material >= 0) primitive["material"] = material;
  json["meshes"].push_back({{"primitives", {primitive}}});
  return static_cast<int>(json["meshes"].size()) - 1;
}

std::string GltfFile::text() const {
  nlohmann::json file = json;
  if (!buffer_.empty())
    file["buffers"] = {
        {{"byteLength", buffer_.size()}, {"uri", "data:application/octet-stream;base64," + base64(buffer_)}}};
  return file.dump(1);
}

std::string GltfFile::binary() const {
  nlohmann::json file = json;
  file["buffers"] = {{{"byteLength", buffer_.size()}}};
  const std::string chunks = chunk("JSON", file.dump(), ' ') + chunk("BIN\0", buffer_, '\0');
  return "glTF" + word(2) + word(12 + chunks.size()) + chunks;
}

Result<SceneDescription> load_gltf(const std::string& text, MemoryAssets::Files files) {
  files.emplace("model.gltf", text);
  MemoryAssets assets(std::move(files));
  return load_scene(assets, "model.gltf", "model.gltf");
}

std::string gltf_mistake(const std::string& text, MemoryAssets::Files files) {
  const auto loaded = load_gltf(text, std::move(files));
  return loaded ? "no mistake" : loaded.error().message;
}

std::string warnings_of(const SceneDescription& scene) {
  std::string lines;
  for (const std::string& warning : scene.warnings) lines += warning + "\n";
  return lines;
}

const MeshDescription& mesh_of(const SceneDescription& scene, std::size_t shape) {
  return std::get<MeshDescription>(scene.shapes.at(shape));
}

}  // namespace tessera::core::test
