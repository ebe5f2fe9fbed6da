// SPDX-License-Identifier: Apache-2.0
// The keys of shapes, as scene files give them: before their transform, and before their files are read.
#pragma once

#include <optional>

#include "core/scene/description.hpp"
#include "core/scene/tables/domains.hpp"

namespace tessera::core {

// The shading normals of a mesh.
enum class NormalsMode {
  kFile,    // the file's, or else means of the faces around each vertex that meet without an edge
  kSmooth,  // means of all faces around each vertex, ignoring the file's
  kFlat,    // none
};

enum class VertexColors { kUse, kIgnore };

// Parameters that a description has in another form.
struct MeshKeys {
  std::optional<VertexColors> vertex_colors{};
  NormalsMode normals = NormalsMode::kFile;
};
struct InstanceKeys {};
struct DiskKeys {
  Vec3 center{}, normal{0, 0, 1};
  float radius = 1, inner_radius = 0;
  bool flip_normal = false;
};
struct CylinderKeys {
  Vec3 start{}, end{0, 0, 1};
  float radius = 1;
  bool flip_normal = false;
};
struct CurvesKeys {
  CurveBasis basis = CurveStrands().basis;
  CurveShape shape = CurveStrands().shape;
  std::optional<float> radius{};  // of all points; nullopt: each has its own
};

// In the order of ShapeDescription.
using ShapeKeys = std::variant<MeshKeys, SphereDescription, QuadDescription, InstanceKeys, DiskKeys,
                               CylinderKeys, CurvesKeys>;

namespace domains {
inline constexpr Domain kShapeName{.definition = "shape_name", .values = "a text"};
inline constexpr Domain kMaterialName{.definition = "material_name", .values = "a name in `materials`"};
inline constexpr Domain kMaterialNames{.definition = "material_names", .values = "a list of names"};
inline constexpr Domain kObjectName{.definition = "object_name", .values = "a name in `objects`"};
inline constexpr Domain kFileName{.definition = "file_name", .values = "a path"};
inline constexpr Domain kControlPoints{.definition = "control_points", .values = "a list of curves"};
inline constexpr Domain kCurveNormals{.definition = "curve_normals", .values = "a list for each curve"};
inline constexpr Domain kNormals = words(scene_keys::kNormals);
inline constexpr Domain kVertexColors = words(scene_keys::kVertexColors);
inline constexpr Domain kCurveBasis = words(scene_keys::kCurveBases);
inline constexpr Domain kCurveShape = words(scene_keys::kCurveShapes);
}  // namespace domains

namespace shape_keys {
inline constexpr OtherKey kName{"name",
                                domains::kShapeName,
                                "what messages and [Cryptomatte](layers.md) call the shape",
                                {.otherwise = "its place in the list"}};
inline constexpr OtherKey kMaterial{"material", domains::kMaterialName, "the material", {.required = true}};
inline constexpr OtherKey kTransform{
    "transform", domains::kTransform, "places the shape", {.otherwise = "none"}};
}  // namespace shape_keys

template <>
inline constexpr auto kKeys<MeshKeys> = Table{
    shape_keys::kName,
    OtherKey{
        "file",
        domains::kFileName,
        "an [OBJ file](#obj-files), a PLY file (`.ply`, `.ply.gz`) or an STL file (`.stl`), relative to the "
        "scene file: [meshes](importing.md#meshes). With keyframes, PLY files of a mesh that "
        "[deforms](#meshes-that-deform)",
        {.required = true, .has_keyframes = true}},
    OtherKey{"material", domains::kMaterialName, "replaces all materials of the file", {.otherwise = "none"}},
    OtherKey{"default_material",
             domains::kMaterialName,
             "the material of faces to which the file gives none",
             {.otherwise = "mid-gray lambert"}},
    OtherKey{"materials",
             domains::kMaterialNames,
             "PLY: the materials that the face property `material_index` counts, from 0",
             {.otherwise = "none"}},
    Key{"vertex_colors", &MeshKeys::vertex_colors, domains::kVertexColors,
        "whether vertex colours multiply the base colour",
        KeyTraits{.otherwise = "`\"use\"`; `\"ignore\"` with `material`"}},
    Key{"normals", &MeshKeys::normals, domains::kNormals,
        "the shading normals: those of the file, and where it has none, smooth but for edges sharper than 40 "
        "degrees; the mean of the faces at each vertex, whatever the file has; or those of the faces. See "
        "[Vertex normals](#vertex-normals)"},
    shape_keys::kTransform,
};

template <>
inline constexpr auto kKeys<SphereDescription> = Table{
    shape_keys::kName,
    Key{"center", &SphereDescription::center, domains::kPoint, "the centre"},
    Key{"radius", &SphereDescription::radius, domains::kPositive, "the radius", KeyTraits{.required = true}},
    shape_keys::kMaterial,
    OtherKey{
        "transform", domains::kTransform, "places the sphere, which must stay round", {.otherwise = "none"}},
    Unkeyed{&SphereDescription::material},
};

template <>
inline constexpr auto kKeys<QuadDescription> = Table{
    shape_keys::kName,
    Key{"corner", &QuadDescription::corner, domains::kPoint,
        "the corner of the parallelogram *corner* + *s* *edge_u* + *t* *edge_v* with *s* and *t* from 0 to "
        "1, "
        "which are also its texture coordinates",
        KeyTraits{.required = true}},
    Key{"edge_u", &QuadDescription::edge_u, domains::kEdge, "one of its edges", KeyTraits{.required = true}},
    Key{"edge_v", &QuadDescription::edge_v, domains::kEdge, "the other edge", KeyTraits{.required = true}},
    shape_keys::kMaterial,
    shape_keys::kTransform,
    Unkeyed{&QuadDescription::material},
};

template <>
inline constexpr auto kKeys<InstanceKeys> = Table{
    shape_keys::kName,
    OtherKey{"object", domains::kObjectName, "the object; see [Instances](#instances)", {.required = true}},
    OtherKey{
        "material", domains::kMaterialName, "replaces all materials of the object", {.otherwise = "none"}},
    OtherKey{"transform",
             domains::kTransform,
             "places the object. Spheres that emit light must stay round",
             {.otherwise = "none"}},
};

template <>
inline constexpr auto kKeys<DiskKeys> = Table{
    shape_keys::kName,
    Key{"center", &DiskKeys::center, domains::kPoint, "the centre"},
    Key{"normal", &DiskKeys::normal, domains::kVector,
        "the direction that the front faces, of any length above 0"},
    Key{"radius", &DiskKeys::radius, domains::kPositive, "the radius", KeyTraits{.required = true}},
    Key{"inner_radius", &DiskKeys::inner_radius, domains::kNotNegative,
        "the radius of the hole of a ring, less than `radius`"},
    Key{"flip_normal", &DiskKeys::flip_normal, domains::kTruth, "whether the front is the other side"},
    shape_keys::kMaterial,
    shape_keys::kTransform,
};

template <>
inline constexpr auto kKeys<CylinderKeys> = Table{
    shape_keys::kName,
    Key{"start", &CylinderKeys::start, domains::kPoint,
        "the start of the axis. The cylinder has no caps: add disks", KeyTraits{.required = true}},
    Key{"end", &CylinderKeys::end, domains::kPoint, "the end of the axis, another point",
        KeyTraits{.required = true}},
    Key{"radius", &CylinderKeys::radius, domains::kPositive, "the radius", KeyTraits{.required = true}},
    Key{"flip_normal", &CylinderKeys::flip_normal, domains::kTruth,
        "whether the front is the inside instead of the outside"},
    shape_keys::kMaterial,
    shape_keys::kTransform,
};

template <>
inline constexpr auto kKeys<CurvesKeys> = Table{
    shape_keys::kName,
    OtherKey{"points",
             domains::kControlPoints,
             "the control points of each curve, `[x, y, z]` or `[x, y, z, radius]`; or `file`; see "
             "[Curves](#curves)",
             {.otherwise = "—"}},
    OtherKey{
        "file", domains::kFileName, "a PLY file of curves, relative to the scene file", {.otherwise = "—"}},
    Key{"basis", &CurvesKeys::basis, domains::kCurveBasis, "what the control points of a segment mean"},
    Key{"shape", &CurvesKeys::shape, domains::kCurveShape,
        "a circle swept along the curve, a band that faces each ray, or a band with normals of its own"},
    Key{"radius", &CurvesKeys::radius, domains::kPositive,
        "half of the width of all curves, if their points have no radius each",
        KeyTraits{.otherwise = "none"}},
    OtherKey{"normals",
             domains::kCurveNormals,
             "of ribbons: for each curve a normal for each end of a segment",
             {.otherwise = "none"}},
    OtherKey{"material", domains::kMaterialName, "the material, without emission", {.required = true}},
    shape_keys::kTransform,
};

}  // namespace tessera::core
