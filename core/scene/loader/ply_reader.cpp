// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "core/scene/loader/gunzip.hpp"
#include "core/scene/loader/mesh_file.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/ply_corner_uvs.hpp"
#include "core/scene/loader/ply_header.hpp"
#include "core/scene/loader/ply_triangles.hpp"
#include "core/scene/loader/ply_values.hpp"
#include "core/scene/loader/ply_vertex_property.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

bool is_index_list(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

// What is done with a property: it is stored in the mesh, kept as an attribute, or skipped.
struct PlyColumn {
  PlyProperty property;
  StorePlyValue store = nullptr;
  std::optional<std::size_t> attribute{};
};

class PlyReader {
 public:
  PlyReader(const PlyHeader& header, std::string_view body, const SceneLimit& limit,
            MeshAttributes attributes)
      : header_(header), values_(body, header.encoding), limit_(limit), attributes_(attributes) {
    if (attributes == MeshAttributes::kIgnore) file_.images = header.images;
  }

  Result<MeshFile> read();

 private:
  Status read_rows(const PlyElement& element);
  Status read_element(const PlyElement& element);
  Status read_vertices(const PlyElement& element);
  std::vector<PlyColumn> vertex_columns(const PlyElement& element);
  void read_columns(const std::vector<PlyColumn>& columns, std::size_t rows, std::size_t row_bytes);
  void read_row(const std::vector<PlyColumn>& columns, std::size_t row);

  Status read_faces(const PlyElement& element);
  // The scalars of the row, and the corners of its face.
  void read_face(const PlyElement& element);
  void add_triangle_attributes(const PlyElement& element, std::size_t triangles_before);
  Status read_strips(const PlyElement& element);
  void read_corners(const PlyProperty& property);
  // The list of one number for each triangle that gets the values of a property of faces; null if none does.
  std::vector<std::uint32_t>* numbers_of(const PlyProperty& property);
  bool is_corner_uvs(const PlyProperty& property) const {
    return attributes_ == MeshAttributes::kIgnore && PlyCornerUvs::is_list_of(property);
  }

  void skip_rows(const PlyElement& element);
  void skip_property(const PlyProperty& property);
  // Adds an attribute, or tells that the property is not used.
  std::optional<std::size_t> settle_attribute(const PlyElement& element, const PlyProperty& property,
                                              bool of_triangles);
  std::uint32_t vertex_index(std::int64_t written) const {
    return written < 0 || written >= kNoPlyVertex ? kNoPlyVertex : static_cast<std::uint32_t>(written);
  }
  Status check_rows(const PlyElement& element) const;
  static tl::unexpected<Error> broken(std::string_view what) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("is a broken PLY file ({})", what));
  }
  template <typename Text>
  void warn(std::string_view kind, const Text& text, std::uint64_t count = 1,
            std::string_view unit = "times") {
    file_.warnings.add(kind, 0, text, count, unit);
  }

  const PlyHeader& header_;
  PlyValues values_;
  const SceneLimit& limit_;
  MeshAttributes attributes_;
  MeshFile file_;
  PlyCornerUvs corner_uvs_;
  PlyTriangles triangles_{file_, corner_uvs_, limit_};
  bool has_vertices_ = false, has_materials_ = false, has_image_numbers_ = false;
  bool has_wrong_count_ = false;  // a row has more corners than the file
  // Faces that stand before the vertices, and where their rows begin.
  std::vector<std::pair<const PlyElement*, PlyValues>> before_vertices_;
  // Of one face; the lists are kept to reuse their memory.
  PlyRow row_;
  std::vector<float> scalars_;                               // one for each property
  std::vector<std::optional<std::size_t>> face_attributes_;  // one for each property of the faces
};

Result<MeshFile> PlyReader::read() {
  for (const PlyElement& element : header_.elements)
    if (auto done = read_rows(element); !done) return fail(done.error());
  if (!has_vertices_) return broken("it has no element 'vertex'");
  for (const auto& [element, values] : before_vertices_) {
    values_ = values;
    if (auto done = read_rows(*element); !done) return fail(done.error());
  }
  if (file_.mesh.triangles.empty())
    return fail(ErrorCode::kInvalidArgument, triangles_.first_left_out().empty()
                                                 ? "has no faces; clouds of points cannot be rendered"
                                                 : fmt::format("has no face that can be used; the first: {}",
                                                               triangles_.first_left_out()));
  const std::size_t triangles = file_.mesh.triangles.size();
  file_.mesh.triangle_materials.resize(has_materials_ ? triangles : 1);
  file_.triangle_images.resize(has_image_numbers_ ? triangles : 0);
  corner_uvs_.apply(file_.mesh);
  for (MeshAttribute& attribute : file_.attributes)
    if (attribute.of_triangles) attribute.values.resize(triangles);
  return std::move(file_);
}

Status PlyReader::read_rows(const PlyElement& element) {
  if (auto done = read_element(element); !done) return done;
  if (!values_.failed()) return {};
  if (has_wrong_count_)
    return broken(fmt::format("it ends in row {} of {}, which says that it has {} corners", row_.number,
                              in_quotes(element.name), row_.corner_count));
  return broken(values_.is_binary() || values_.bytes_left() == 0
                    ? fmt::format("it ends among the rows of {}", in_quotes(element.name))
                    : fmt::format("a row of {} has something else than numbers", in_quotes(element.name)));
}

Status PlyReader::read_element(const PlyElement& element) {
  if (element.properties.empty()) return {};
  if (auto fits = check_rows(element); !fits) return fits;
  if (element.name == "vertex") return read_vertices(element);
  const bool has_indices = std::ranges::any_of(element.properties, is_index_list);
  if ((element.name == "face" || element.name == "tristrips") && has_indices && !has_vertices_) {
    before_vertices_.push_back({&element, values_});
    skip_rows(element);
    return {};
  }
  if (element.name == "face" && has_indices) return read_faces(element);
  if (element.name == "tristrips" && has_indices) return read_strips(element);
  if (element.count > 0)
    warn(element.name, [&] { return fmt::format("the element {} is not used", in_quotes(element.name)); });
  skip_rows(element);
  return {};
}

// Before memory is taken for the rows.
Status PlyReader::check_rows(const PlyElement& element) const {
  if (values_.may_follow(element.count,
                         values_.is_binary() ? element.row_bytes() : element.properties.size()))
    return {};
  return broken(fmt::format("it is too short for the {} rows of {}", element.count, in_quotes(element.name)));
}

std::optional<std::size_t> PlyReader::settle_attribute(const PlyElement& element, const PlyProperty& property,
                                                       bool of_triangles) {
  constexpr std::size_t kMaxAttributes = 48;  // they take memory for each triangle
  if (property.is_list || attributes_ == MeshAttributes::kIgnore ||
      file_.attributes.size() >= kMaxAttributes) {
    warn(element.name + "." + property.name, [&] {
      return fmt::format("the property {} of {} is not used", in_quotes(property.name),
                         in_quotes(element.name));
    });
    return std::nullopt;
  }
  file_.attributes.push_back({property.name, of_triangles, {}});
  return file_.attributes.size() - 1;
}

std::vector<PlyColumn> PlyReader::vertex_columns(const PlyElement& element) {
  std::vector<PlyColumn> columns;
  for (const PlyProperty& property : element.properties) {
    PlyColumn column{property};
    const PlyVertexProperty* known = ply_vertex_property(property);
    if (known != nullptr && has_data(element, known->data)) {
      column.store = known->store;
    } else {
      column.attribute = settle_attribute(element, property, false);
      if (column.attribute) file_.attributes[*column.attribute].values.resize(element.count);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

Status PlyReader::read_vertices(const PlyElement& element) {
  if (has_vertices_) return broken("it has two elements 'vertex'");
  if (!has_data(element, PlyVertexData::kPosition)) return broken("its vertices have no x, y and z");
  has_vertices_ = true;
  MeshDescription& mesh = file_.mesh;
  mesh.positions.resize(element.count);
  if (has_data(element, PlyVertexData::kNormal)) mesh.normals.resize(element.count);
  if (has_data(element, PlyVertexData::kTangent)) mesh.tangents.resize(element.count);
  if (has_data(element, PlyVertexData::kUv)) mesh.uvs.resize(element.count);
  if (has_data(element, PlyVertexData::kSecondUv)) mesh.second_uvs.resize(element.count);
  if (has_data(element, PlyVertexData::kColor)) mesh.colors.resize(element.count);
  const std::vector<PlyColumn> columns = vertex_columns(element);
  if (values_.is_binary() && !element.has_lists()) {
    read_columns(columns, element.count, element.row_bytes());
  } else {
    for (std::size_t row = 0; row < element.count && !values_.failed(); ++row) read_row(columns, row);
  }
  decode_colors(element, mesh.colors);
  return {};
}

void PlyReader::read_columns(const std::vector<PlyColumn>& columns, std::size_t rows, std::size_t row_bytes) {
  const char* first = values_.take(rows * row_bytes);
  if (first == nullptr) return;
  const bool swapped = values_.is_swapped();
  for (const PlyColumn& column : columns) {
    with_ply_type(column.property.type, [&](auto sample) {
      using T = decltype(sample);
      const char* bytes = first;
      for (std::size_t row = 0; row < rows; ++row, bytes += row_bytes) {
        const float value = ply_float(load_ply_value<T>(bytes, swapped));
        if (column.store != nullptr)
          column.store(file_.mesh, row, value);
        else if (column.attribute)
          file_.attributes[*column.attribute].values[row] = value;
      }
    });
    first += size_of(column.property.type);
  }
}

void PlyReader::read_row(const std::vector<PlyColumn>& columns, std::size_t row) {
  for (const PlyColumn& column : columns) {
    if (column.store != nullptr)
      column.store(file_.mesh, row, values_.next_float(column.property.type));
    else if (column.attribute)
      file_.attributes[*column.attribute].values[row] = values_.next_float(column.property.type);
    else
      skip_property(column.property);
  }
}

void PlyReader::skip_property(const PlyProperty& property) {
  const std::int64_t count = property.is_list ? values_.next_integer(property.count_type) : 1;
  if (count > 0) values_.skip(property.type, static_cast<std::uint64_t>(count));
}

void PlyReader::skip_rows(const PlyElement& element) {
  for (std::uint64_t row = 0; row < element.count && !values_.failed(); ++row)
    for (const PlyProperty& property : element.properties) skip_property(property);
}

void PlyReader::read_corners(const PlyProperty& property) {
  row_.corners.clear();
  row_.corner_count = values_.next_integer(property.count_type);
  if (row_.corner_count <= 0) return;
  const std::size_t value_size = values_.is_binary() ? size_of(property.type) : 1;
  if (!values_.may_follow(static_cast<std::uint64_t>(row_.corner_count), value_size)) {
    values_.skip(property.type, static_cast<std::uint64_t>(row_.corner_count));  // fails
    has_wrong_count_ = true;
    return;
  }
  for (std::int64_t i = 0; i < row_.corner_count; ++i)
    row_.corners.push_back(vertex_index(values_.next_integer(property.type)));
}

Status PlyReader::read_faces(const PlyElement& element) {
  file_.mesh.triangles.reserve(std::min<std::uint64_t>(element.count, limit_.most));
  scalars_.resize(element.properties.size());
  face_attributes_.clear();
  for (const PlyProperty& property : element.properties) {
    const auto* numbers = numbers_of(property);
    has_materials_ = has_materials_ || numbers == &file_.mesh.triangle_materials;
    has_image_numbers_ = has_image_numbers_ || numbers == &file_.triangle_images;
    const bool is_known = numbers != nullptr || is_index_list(property) || is_corner_uvs(property);
    face_attributes_.push_back(is_known ? std::nullopt : settle_attribute(element, property, true));
  }
  for (std::uint64_t row = 0; row < element.count && !values_.failed(); ++row) {
    const std::size_t before = file_.mesh.triangles.size();
    row_.number = row + 1;
    read_face(element);
    if (values_.failed()) return {};
    if (auto added = triangles_.add_face(row_); !added) return added;
    add_triangle_attributes(element, before);
  }
  return {};
}

std::vector<std::uint32_t>* PlyReader::numbers_of(const PlyProperty& property) {
  if (property.is_list) return nullptr;
  if (property.name == "material_index") return &file_.mesh.triangle_materials;
  return property.name == "texnumber" && !file_.images.empty() ? &file_.triangle_images : nullptr;
}

void PlyReader::read_face(const PlyElement& element) {
  corner_uvs_.begin_face();
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    const PlyProperty& property = element.properties[i];
    if (is_index_list(property))
      read_corners(property);
    else if (is_corner_uvs(property))
      corner_uvs_.read_face(property, values_);
    else if (property.is_list)
      skip_property(property);
    else
      scalars_[i] = values_.next_float(property.type);
  }
}

// Triangles of other elements, which lack them, have zeros.
void PlyReader::add_triangle_attributes(const PlyElement& element, std::size_t triangles_before) {
  const std::size_t more = file_.mesh.triangles.size() - triangles_before;
  for (std::size_t i = 0; i < element.properties.size(); ++i) {
    if (face_attributes_[i]) {
      auto& values = file_.attributes[*face_attributes_[i]].values;
      values.resize(triangles_before);
      values.insert(values.end(), more, scalars_[i]);
    } else if (auto* numbers = numbers_of(element.properties[i])) {
      constexpr float kMaxIndex = 1 << 24;
      const float index = scalars_[i] >= 0 && scalars_[i] < kMaxIndex ? scalars_[i] : kMaxIndex;
      numbers->resize(triangles_before);
      numbers->insert(numbers->end(), more, static_cast<std::uint32_t>(index));
    }
  }
}

Status PlyReader::read_strips(const PlyElement& element) {
  for (std::uint64_t row = 0; row < element.count && !values_.failed(); ++row) {
    row_.number = row + 1;
    for (const PlyProperty& property : element.properties) {
      if (is_index_list(property))
        read_corners(property);
      else
        skip_property(property);
    }
    if (auto added = triangles_.add_strips(row_.corners); !added) return added;
  }
  return {};
}

Result<MeshFile> read_plain_ply(std::string_view bytes, const SceneLimit& triangles,
                                MeshAttributes attributes) {
  const auto header = read_ply_header(bytes);
  if (!header) return fail(header.error());
  return PlyReader(*header, bytes.substr(header->size), triangles, attributes).read();
}

}  // namespace

Result<MeshFile> read_ply(std::string_view bytes, const std::string& name, const SceneLimit& triangles,
                          MeshAttributes attributes) {
  const auto named = [&name](const Error& error) {
    return fail(error.code, fmt::format("{} {}", in_quotes(name), error.message));
  };
  std::string content;
  const auto plain = gunzipped(bytes, content);
  if (!plain) return named(plain.error());
  auto file = read_plain_ply(*plain, triangles, attributes);
  if (!file) return named(file.error());
  return file;
}

}  // namespace tessera::core
