#include "core/scene/loader/obj_reader.hpp"

#include <fmt/format.h>
#include <tiny_obj_loader.h>

#include <map>
#include <optional>

#include "core/scene/loader/memory_stream.hpp"
#include "core/scene/loader/polygon.hpp"
#include "core/scene/loader/text_lines.hpp"

namespace tessera::core {
namespace {

// Receives tinyobjloader's callbacks. scan_obj has passed the text, so indices are in range.
class FaceCollector {
 public:
  explicit FaceCollector(ObjFile& file) : file_(file) {}

  // The number, from 0, of a face that could not be cut into triangles.
  std::optional<std::size_t> failed_face() const { return failed_face_; }

  static tinyobj::callback_t callbacks() {
    tinyobj::callback_t calls;
    calls.vertex_cb = [](void* self, float, float, float, float) { ++of(self).positions_seen_; };
    calls.normal_cb = [](void* self, float, float, float) { ++of(self).normals_seen_; };
    calls.texcoord_cb = [](void* self, float, float, float) { ++of(self).uvs_seen_; };
    calls.index_cb = [](void* self, tinyobj::index_t* corners, int count) {
      of(self).add_face(corners, count);
    };
    calls.usemtl_cb = [](void* self, const char* name, int) { of(self).use_material(name); };
    return calls;
  }

 private:
  static FaceCollector& of(void* self) { return *static_cast<FaceCollector*>(self); }

  // From 1 for the first, or from -1 for the last so far; 0 for none.
  static std::int32_t resolve(int index, std::int32_t seen) { return index < 0 ? seen + index : index - 1; }

  void add_face(const tinyobj::index_t* corners, int count);
  void use_material(const char* name);

  ObjFile& file_;
  std::int32_t positions_seen_ = 0, normals_seen_ = 0, uvs_seen_ = 0;
  std::uint32_t material_ = kNoMaterialName;
  std::size_t usemtl_seen_ = 0;
  std::map<std::string, std::uint32_t, std::less<>> material_indices_;
  std::size_t faces_seen_ = 0;
  std::optional<std::size_t> failed_face_;
  // Of one face; kept for their memory.
  std::vector<ObjFile::Corner> face_;
  std::vector<Vec3> outline_;
  std::vector<std::array<std::uint32_t, 3>> triangles_;
};

void FaceCollector::add_face(const tinyobj::index_t* corners, int count) {
  face_.clear();
  outline_.clear();
  triangles_.clear();
  for (int i = 0; i < count; ++i) {
    face_.push_back({resolve(corners[i].vertex_index, positions_seen_),
                     resolve(corners[i].texcoord_index, uvs_seen_),
                     resolve(corners[i].normal_index, normals_seen_)});
    outline_.push_back(file_.text.positions.at(static_cast<std::size_t>(face_.back().position)));
  }
  if (!triangulate(outline_, triangles_) && !failed_face_) failed_face_ = faces_seen_;
  ++faces_seen_;
  for (const auto& triangle : triangles_) {
    for (const std::uint32_t corner : triangle) file_.corners.push_back(face_[corner]);
    file_.triangle_materials.push_back(material_);
  }
}

void FaceCollector::use_material(const char* name) {
  const int line = file_.text.usemtl_lines.at(usemtl_seen_++);
  const std::string_view trimmed_name = trimmed(name);
  const auto known = material_indices_.find(trimmed_name);
  if (known != material_indices_.end()) {
    material_ = known->second;
    return;
  }
  material_ = static_cast<std::uint32_t>(file_.material_names.size());
  material_indices_.emplace(trimmed_name, material_);
  file_.material_names.emplace_back(trimmed_name);
  file_.material_lines.push_back(line);
}

// The line of a face, counted from 0.
int line_of_face(std::string_view text, std::size_t face) {
  for (int line = 1; !text.empty(); ++line) {
    std::string_view rest = take_line(text);
    if (take_word(rest) == "f" && face-- == 0) return line;
  }
  return 0;
}

}  // namespace

Result<ObjFile> read_obj(std::string_view bytes, const std::string& name) {
  bytes = without_byte_order_mark(bytes);
  auto text = scan_obj(bytes, name);
  if (!text) return fail(text.error());
  ObjFile file;
  file.text = std::move(*text);
  FaceCollector collector(file);
  MemoryStream stream(bytes);
  std::string warnings, errors;
  if (!tinyobj::LoadObjWithCallback(stream, FaceCollector::callbacks(), &collector, nullptr, &warnings,
                                    &errors))
    return fail(ErrorCode::kInvalidArgument, fmt::format("{}: {}", name, errors));
  if (const auto face = collector.failed_face())
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("{}:{}: a face that is not convex may have {} corners at most", name,
                            line_of_face(bytes, *face), kMaxConcaveCorners));
  return file;
}

}  // namespace tessera::core
