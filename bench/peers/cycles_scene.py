# SPDX-License-Identifier: Apache-2.0
"""Makes a Tessera scene file's scene in Blender, for Cycles: the same shapes, materials, lights and camera.

Runs inside Blender (3.4). Coordinates stay as they are, y up. What has no counterpart here is refused with a
sentence. docs/notebook/peers.md lists what differs.
"""

import json
import math
import os
import re
from dataclasses import dataclass
from typing import Any, Callable, Optional

import bmesh
import bpy
from mathutils import Matrix, Quaternion, Vector

from cycles_curves import curves_parts
from cycles_materials import CannotConvert, MaterialBuilder, refuse_unknown, rgb
from images import read_pfm

# Spheres are icospheres: of 81,920 triangles, but of 320 where there are many.
FEW_SPHERES = 32
FINE, COARSE = 7, 3


def read_scene(path):
    """The scene file without its comments."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    pattern = r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/'
    return json.loads(re.sub(pattern, lambda m: m[0] if m[0][0] == '"' else " ", text, flags=re.S))


@dataclass
class Part:
    """What an object of Blender shows: its data, where that is in the shape, and what else the object needs."""

    data: Any
    place: Matrix
    modify: Optional[Callable] = None


def step_matrix(step):
    (kind, value), = step.items()
    if kind == "translate":
        return Matrix.Translation(Vector(value))
    if kind == "scale":
        return Matrix.Diagonal((*rgb(value), 1))
    if kind == "rotate" and "quaternion" in value:
        return Quaternion(value["quaternion"]).to_matrix().to_4x4()
    if kind == "rotate":
        return Matrix.Rotation(math.radians(value["degrees"]), 4, Vector(value["axis"]))
    return Matrix((*value, (0, 0, 0, 1)))


def transform_matrix(d):
    product = Matrix.Identity(4)
    for step in d.get("transform", ()):
        product = step_matrix(step) @ product
    return product


def shade(mesh, smooth):
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))


class SceneBuilder:
    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        self.description = read_scene(path)
        self.materials = {}
        self.parts = {}  # of shapes, by their place in memory and material: instances share them
        known = {"$schema", "render", "output", "camera", "textures", "materials", "media", "environment", "lights",
                 "objects", "shapes"}
        refuse_unknown("the scene", self.description, known)
        spheres = [d for d in self.description["shapes"] if d["type"] == "sphere"]
        self.fineness = FINE if len(spheres) <= FEW_SPHERES else COARSE
        self.largest_lamp = max((d["radius"] for d in spheres if self.lamp_radiance(d)), default=0)

    def path_of(self, file):
        return os.path.join(self.folder, file)

    def image(self, file, linear=False):
        if file.endswith(".pfm"):
            return self.pfm_image(file)
        image = bpy.data.images.load(self.path_of(file), check_existing=True)
        image.colorspace_settings.name = "Non-Color" if linear or image.is_float else "sRGB"
        return image

    def pfm_image(self, file):
        """Blender does not read PFM files."""
        width, height, values = read_pfm(self.path_of(file))
        image = bpy.data.images.new(file, width, height, float_buffer=True, is_data=True)
        image.pixels.foreach_set([value for i in range(0, len(values), 3) for value in (*values[i : i + 3], 1.0)])
        image.pack()
        return image

    def material(self, name):
        if name not in self.materials:
            self.materials[name] = MaterialBuilder(self, name).build(self.description["materials"][name])
        return self.materials[name]

    def mesh_part(self, mesh, material, place=Matrix.Identity(4)):
        mesh.materials.clear()
        mesh.materials.append(self.material(material))
        return Part(mesh, place)

    def quad(self, d):
        radiance = self.lamp_radiance(d)
        if radiance and self.description["materials"][d["material"]].get("emission_sides") == "front":
            return [self.quad_lamp(d, radiance)]
        corner, u, v = (Vector(d[key]) for key in ("corner", "edge_u", "edge_v"))
        mesh = bpy.data.meshes.new("quad")
        mesh.from_pydata([corner, corner + u, corner + u + v, corner + v], [], [(0, 1, 2, 3)])
        layer = mesh.uv_layers.new()
        for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
            loop.uv = uv
        return [self.mesh_part(mesh, d["material"])]

    def sphere(self, d):
        radiance = self.lamp_radiance(d)
        if radiance and d["radius"] < self.largest_lamp / 3:
            return [self.sphere_lamp(d, radiance)]
        builder = bmesh.new()
        place = Matrix.Translation(Vector(d.get("center", (0, 0, 0))))
        bmesh.ops.create_icosphere(builder, subdivisions=self.fineness, radius=d["radius"], matrix=place)
        mesh = bpy.data.meshes.new("sphere")
        builder.to_mesh(mesh)
        builder.free()
        shade(mesh, smooth=True)
        return [self.mesh_part(mesh, d["material"])]

    def lamp_radiance(self, d):
        """The radiance of a shape that only emits, or None: Cycles has lamps of its own for those."""
        material = self.description["materials"][d["material"]]
        if material["type"] != "lambert" or material.get("albedo", 0.5) != 0 or "emission" not in material:
            return None
        return None if isinstance(material["emission"], dict) else rgb(material["emission"])

    def sphere_lamp(self, d, radiance):
        watts = 4 * math.pi**2 * d["radius"] ** 2
        lamp = lamp_data("POINT", radiance, watts)
        lamp.shadow_soft_size = d["radius"]
        return Part(lamp, Matrix.Translation(Vector(d.get("center", (0, 0, 0)))))

    def quad_lamp(self, d, radiance):
        corner, u, v = (Vector(d[key]) for key in ("corner", "edge_u", "edge_v"))
        axes = Matrix((u.normalized(), -v.normalized(), -u.cross(v).normalized())).transposed().to_4x4()
        lamp = lamp_data("AREA", radiance, 4 * u.length * v.length)
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", u.length, v.length
        return Part(lamp, Matrix.Translation(corner + (u + v) / 2) @ axes)

    def mesh(self, d):
        refuse_unknown("a mesh", d, {"name", "type", "file", "material", "normals", "transform"})
        if not d["file"].endswith(".obj"):
            raise CannotConvert(f"the mesh {d['file']} is not converted for Cycles, since it is no OBJ file")
        before = set(bpy.data.objects)
        bpy.ops.wm.obj_import(filepath=self.path_of(d["file"]), forward_axis="Y", up_axis="Z", validate_meshes=False)
        parts = []
        for imported in set(bpy.data.objects) - before:
            mesh = imported.data
            bpy.data.objects.remove(imported)
            set_normals(mesh, d.get("normals", "file"))
            if "material" in d:
                parts.append(self.mesh_part(mesh, d["material"]))
            else:
                self.use_diffuse_of_mtl(mesh)
                parts.append(Part(mesh, Matrix.Identity(4)))
        return parts

    def use_diffuse_of_mtl(self, mesh):
        """Of MTL files only the diffuse colour, Kd, is converted."""
        for slot, imported in enumerate(mesh.materials):
            color = list(imported.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value)[:3]
            name = f"{imported.name} of the MTL file"
            mesh.materials[slot] = MaterialBuilder(self, name).build({"type": "lambert", "albedo": color})

    def curves(self, d):
        data, modify = curves_parts(d, self.folder, self.material(d["material"]))
        return [Part(data, Matrix.Identity(4), modify)]

    def parts_of(self, d, material):
        """The parts of a shape, made once for each material that it has."""
        key = (id(d), material)
        if key not in self.parts:
            if d["type"] not in SHAPES:
                raise CannotConvert(f"a shape of the type '{d['type']}' is not converted for Cycles")
            self.parts[key] = SHAPES[d["type"]](self, d | {"material": material} if material else d)
        return self.parts[key]

    def place(self, d, outside=Matrix.Identity(4), material=None):
        """Adds a shape, or what an instance shows; `material` is that of the outermost instance that has one."""
        place = outside @ transform_matrix(d)
        if d["type"] == "instance":
            for inner in self.description["objects"][d["object"]]["shapes"]:
                self.place(inner, place, material or d.get("material"))
            return
        for part in self.parts_of(d, material):
            self.link(part, place)

    def link(self, part, place):
        thing = bpy.data.objects.new(part.data.name, part.data)
        thing.matrix_world = place @ part.place
        thing.visible_camera = True
        if part.modify:
            part.modify(thing)
        bpy.context.collection.objects.link(thing)

    def light(self, d):
        if d["type"] == "directional":
            refuse_unknown("a directional light", d, {"type", "direction", "irradiance"})
            sun = lamp_data("SUN", rgb(d["irradiance"]), 1)
            sun.angle = 0
            return Part(sun, Vector(d["direction"]).to_track_quat("-Z", "Y").to_matrix().to_4x4())
        if d["type"] == "point":
            refuse_unknown("a point light", d, {"type", "position", "intensity"})
            point = lamp_data("POINT", rgb(d["intensity"]), 4 * math.pi)
            point.shadow_soft_size = 0
            return Part(point, Matrix.Translation(Vector(d["position"])))
        raise CannotConvert(f"a light of the type '{d['type']}' is not converted for Cycles")

    def environment(self):
        d = self.description.get("environment")
        world = bpy.data.worlds.new("environment")
        bpy.context.scene.world = world
        world.use_nodes = True
        background = world.node_tree.nodes["Background"]
        background.inputs["Color"].default_value = (0, 0, 0, 1)
        if d is None:
            return
        refuse_unknown("the environment", d, {"texture", "radiance", "rotation_degrees"})
        radiance = rgb(d.get("radiance", 1))
        if "texture" not in d:
            background.inputs["Color"].default_value = (*radiance, 1)
            return
        if len(set(radiance)) != 1:
            raise CannotConvert("a coloured 'radiance' beside a texture is not converted for Cycles")
        background.inputs["Strength"].default_value = radiance[0]
        sky = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        sky.image = self.image(self.description["textures"][d["texture"]]["file"])
        # Ours looks along -z in the image's middle, right of it along +x, up along +y; Blender's along +x, -y, +z.
        turn = Matrix.Rotation(math.radians(-d.get("rotation_degrees", 0)), 3, "Y")
        axes = Matrix(((0, 0, -1), (-1, 0, 0), (0, 1, 0)))
        sky.texture_mapping.rotation = (axes @ turn).to_euler("XYZ")
        world.node_tree.links.new(sky.outputs["Color"], background.inputs["Color"])

    def camera(self, width, height):
        d = self.description["camera"]
        refuse_unknown("the camera", d, {"position", "look_at", "up", "vertical_fov_degrees", "aperture_radius",
                                         "focus_distance"})
        position, look_at = Vector(d["position"]), Vector(d["look_at"])
        forward = (look_at - position).normalized()
        right = forward.cross(Vector(d.get("up", (0, 1, 0)))).normalized()
        up = right.cross(forward)
        data = bpy.data.cameras.new("camera")
        data.sensor_fit = "VERTICAL"
        data.sensor_height = 1000  # millimetres; that of a small one would need an f-number below Blender's least
        data.lens = data.sensor_height / 2 / math.tan(math.radians(d.get("vertical_fov_degrees", 40)) / 2)
        distance = (look_at - position).length
        data.clip_start, data.clip_end = distance * 1e-4, distance * 1e4
        if d.get("aperture_radius", 0) > 0:
            data.dof.use_dof = True
            data.dof.focus_distance = d.get("focus_distance", distance)
            data.dof.aperture_fstop = data.lens / 1000 / (2 * d["aperture_radius"])
        camera = bpy.data.objects.new("camera", data)
        camera.matrix_world = Matrix.Translation(position) @ Matrix((right, up, -forward)).transposed().to_4x4()
        bpy.context.collection.objects.link(camera)
        scene = bpy.context.scene
        scene.camera = camera
        scene.render.resolution_x, scene.render.resolution_y = width, height
        scene.render.resolution_percentage = 100

    def build(self, width, height):
        for thing in list(bpy.data.objects):
            bpy.data.objects.remove(thing)
        for d in self.description["shapes"]:
            self.place(d)
        for d in self.description.get("lights", ()):
            self.link(self.light(d), Matrix.Identity(4))
        self.environment()
        self.camera(width, height)


SHAPES = {"quad": SceneBuilder.quad, "sphere": SceneBuilder.sphere, "mesh": SceneBuilder.mesh,
          "curves": SceneBuilder.curves}


def lamp_data(kind, color, watts_at_1):
    """A lamp of Blender whose strength at the colour 1 is given; the largest channel goes into the strength."""
    data = bpy.data.lights.new("lamp", kind)
    strength = max(color)
    data.color, data.energy = [c / strength for c in color], watts_at_1 * strength
    return data


def set_normals(mesh, normals):
    if normals == "file":
        if not mesh.has_custom_normals:
            shade(mesh, smooth=True)
            mesh.use_auto_smooth, mesh.auto_smooth_angle = True, math.radians(40)
        return
    mesh.use_auto_smooth = False
    mesh.free_normals_split()
    shade(mesh, smooth=normals == "smooth")
