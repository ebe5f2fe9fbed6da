# SPDX-License-Identifier: Apache-2.0
"""Makes a Tessera scene file's scene in Blender, for Cycles: the same meshes, materials, lamps, sky and camera.

Runs inside Blender (3.4). Coordinates stay as they are, y up. What has no counterpart here is refused with a
sentence. What differs: spheres become icospheres of 81,920 triangles with interpolated normals; cook_torrance becomes
diffuse plus Principled metal, whose masking is separable and whose Fresnel term has the curve of a dielectric.
"""

import json
import math
import os
import re

import bmesh
import bpy
from mathutils import Matrix, Vector


class CannotConvert(Exception):
    pass


def read_scene(path):
    """The scene file without its comments."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    pattern = r'"(?:\\.|[^"\\])*"|//[^\n]*|/\*.*?\*/'
    return json.loads(re.sub(pattern, lambda m: m[0] if m[0][0] == '"' else " ", text, flags=re.S))


def rgb(value):
    return tuple(value) if isinstance(value, list) else (value,) * 3


def refuse_unknown(what, given, known):
    unknown = set(given) - set(known)
    if unknown:
        raise CannotConvert(f"{what} has '{sorted(unknown)[0]}', which is not converted for Cycles")


class MaterialBuilder:
    """One material's node tree."""

    def __init__(self, scene, name):
        self.scene = scene
        self.material = bpy.data.materials.new(name)
        self.material.use_nodes = True
        self.tree = self.material.node_tree
        self.tree.nodes.clear()

    def node(self, kind, **properties):
        node = self.tree.nodes.new(kind)
        for key, value in properties.items():
            setattr(node, key, value)
        return node

    def feed(self, socket, value):
        """`value` is a number, a triple or the output of another node."""
        if isinstance(value, bpy.types.NodeSocket):
            self.tree.links.new(value, socket)
        elif isinstance(value, tuple):
            socket.default_value = (*value, 1)
        else:
            socket.default_value = value

    def shader(self, kind, inputs, **properties):
        node = self.node(kind, **properties)
        for name, value in inputs.items():
            self.feed(node.inputs[name], value)
        return node.outputs[0]

    def texture(self, name, linear=False):
        description = self.scene.description["textures"][name]
        refuse_unknown(f"texture '{name}'", description, {"file", "color_space", "wrap", "scale"})
        image = self.node("ShaderNodeTexImage", interpolation="Linear")
        image.extension = "EXTEND" if description.get("wrap") == "clamp" else "REPEAT"
        image.image = bpy.data.images.load(self.scene.path_of(description["file"]), check_existing=True)
        linear = linear or description.get("color_space") == "linear" or image.image.is_float
        image.image.colorspace_settings.name = "Non-Color" if linear else "sRGB"
        image.texture_mapping.scale = (*description.get("scale", (1, 1)), 1)
        return image.outputs["Color"]

    def color(self, value):
        """A share of light: a number, a triple, or a texture times a tint."""
        if not isinstance(value, dict):
            return rgb(value)
        texture, tint = self.texture(value["texture"]), rgb(value.get("tint", 1))
        if tint == (1, 1, 1):
            return texture
        product = self.node("ShaderNodeVectorMath", operation="MULTIPLY")
        self.tree.links.new(texture, product.inputs[0])
        product.inputs[1].default_value = tint
        return product.outputs[0]

    def normal(self, description):
        """What to feed the Normal sockets with."""
        bend = description.get("normal_map")
        if not bend:
            return {}
        if bend.get("strength", 1) != 1:
            raise CannotConvert("a normal map's 'strength' is not converted for Cycles")
        node = self.node("ShaderNodeNormalMap", space="TANGENT")
        self.feed(node.inputs["Color"], self.texture(bend["texture"], linear=True))
        return {"Normal": node.outputs[0]}

    def add(self, first, second):
        node = self.node("ShaderNodeAddShader")
        self.tree.links.new(first, node.inputs[0])
        self.tree.links.new(second, node.inputs[1])
        return node.outputs[0]

    def mix(self, share_of_second, first, second):
        node = self.node("ShaderNodeMixShader")
        self.feed(node.inputs[0], share_of_second)
        if first:
            self.tree.links.new(first, node.inputs[1])
        self.tree.links.new(second, node.inputs[2])
        return node.outputs[0]

    def lambert(self, d):
        albedo = self.color(d.get("albedo", 0.5))
        if albedo == (0, 0, 0):
            return None
        return self.shader("ShaderNodeBsdfDiffuse", {"Color": albedo, **self.normal(d)})

    def mirror(self, d):
        color = self.color(d.get("reflectance", 1))
        return self.shader("ShaderNodeBsdfGlossy", {"Color": color, **self.normal(d)}, distribution="SHARP")

    def glass(self, d):
        if d.get("roughness", 0) != 0 or d.get("fresnel", "exact") != "exact":
            raise CannotConvert("only smooth glass with exact Fresnel is converted for Cycles")
        reflectance = self.color(d.get("reflectance", 1))
        transmittance = self.color(d.get("transmittance", 1))
        ior = d.get("ior", 1.5)
        if reflectance == transmittance:
            return self.shader("ShaderNodeBsdfGlass", {"Color": reflectance, "IOR": ior}, distribution="SHARP")
        refracted = self.shader("ShaderNodeBsdfRefraction", {"Color": transmittance, "IOR": ior}, distribution="SHARP")
        reflected = self.shader("ShaderNodeBsdfGlossy", {"Color": reflectance}, distribution="SHARP")
        return self.mix(self.shader("ShaderNodeFresnel", {"IOR": ior}), refracted, reflected)

    def cook_torrance(self, d):
        share = self.color(d.get("specular", 1))
        if "conductor" in d or not isinstance(share, tuple) or len(set(share)) != 1:
            raise CannotConvert("of cook_torrance only gray 'specular' with 'f0' is converted for Cycles")
        normal = self.normal(d)
        # Reflectance rises towards grazing angles as that of a dielectric does, whose index "Specular" gives. At 1.3, and
        # 0.0035 lower, it stays within 6 % of Schlick's curve for f0 = 0.05, up to 66 degrees.
        f0 = tuple(c - 0.0035 * (1 - c) for c in self.color(d.get("f0", 0.04)))
        facets = {"Base Color": f0, "Metallic": 1.0, "Specular": 0.213, "Roughness": d.get("roughness", 0.3)}
        metal = self.shader("ShaderNodeBsdfPrincipled", {**facets, **normal}, distribution="GGX")
        metal = self.mix(share[0], None, metal)
        diffuse = self.color(d.get("diffuse", 0))
        if diffuse == (0, 0, 0):
            return metal
        return self.add(self.shader("ShaderNodeBsdfDiffuse", {"Color": diffuse, **normal}), metal)

    def emission(self, d):
        color = rgb(d["emission"]) if not isinstance(d["emission"], dict) else None
        if color is None:
            raise CannotConvert("textured emission is not converted for Cycles")
        strength = max(color)
        inputs = {"Color": tuple(c / strength for c in color), "Strength": strength}
        if d.get("emission_sides", "both") == "front":
            front = self.node("ShaderNodeMath", operation="MULTIPLY_ADD")
            self.tree.links.new(self.node("ShaderNodeNewGeometry").outputs["Backfacing"], front.inputs[0])
            front.inputs[1].default_value = -strength
            front.inputs[2].default_value = strength
            inputs["Strength"] = front.outputs[0]
        return self.shader("ShaderNodeEmission", inputs)

    def build(self, d):
        makers = {"lambert": self.lambert, "mirror": self.mirror, "glass": self.glass,
                  "cook_torrance": self.cook_torrance}
        if d["type"] not in makers:
            raise CannotConvert(f"material type '{d['type']}' is not converted for Cycles")
        surface = makers[d["type"]](d)
        if "emission" in d:
            emission = self.emission(d)
            surface = self.add(surface, emission) if surface else emission
        if surface:
            output = self.node("ShaderNodeOutputMaterial")
            self.tree.links.new(surface, output.inputs["Surface"])
        return self.material


class SceneBuilder:
    def __init__(self, path):
        self.folder = os.path.dirname(os.path.abspath(path))
        self.description = read_scene(path)
        self.materials = {}
        known = {"$schema", "render", "output", "camera", "textures", "materials", "environment", "shapes"}
        refuse_unknown("the scene", self.description, known)
        self.largest_lamp = max((d["radius"] for d in self.description["shapes"]
                                 if d["type"] == "sphere" and self.lamp_radiance(d)), default=0)

    def path_of(self, file):
        return os.path.join(self.folder, file)

    def material(self, name):
        if name not in self.materials:
            self.materials[name] = MaterialBuilder(self, name).build(self.description["materials"][name])
        return self.materials[name]

    def link(self, mesh, material):
        mesh.materials.clear()
        mesh.materials.append(self.material(material))
        bpy.context.collection.objects.link(bpy.data.objects.new(mesh.name, mesh))

    def quad(self, d):
        radiance = self.lamp_radiance(d)
        if radiance and self.description["materials"][d["material"]].get("emission_sides") == "front":
            return self.quad_lamp(d, radiance)
        corner, u, v = (Vector(d[key]) for key in ("corner", "edge_u", "edge_v"))
        mesh = bpy.data.meshes.new("quad")
        mesh.from_pydata([corner, corner + u, corner + u + v, corner + v], [], [(0, 1, 2, 3)])
        layer = mesh.uv_layers.new()
        for loop, uv in zip(layer.data, ((0, 0), (1, 0), (1, 1), (0, 1))):
            loop.uv = uv
        self.link(mesh, d["material"])

    def sphere(self, d):
        radiance = self.lamp_radiance(d)
        if radiance and d["radius"] < self.largest_lamp / 3:
            return self.sphere_lamp(d, radiance)
        builder = bmesh.new()
        place = Matrix.Translation(Vector(d.get("center", (0, 0, 0))))
        bmesh.ops.create_icosphere(builder, subdivisions=7, radius=d["radius"], matrix=place)
        mesh = bpy.data.meshes.new("sphere")
        builder.to_mesh(mesh)
        builder.free()
        shade(mesh, smooth=True)
        self.link(mesh, d["material"])

    def lamp_radiance(self, d):
        """The radiance of a shape that only emits, or None: Cycles has lamps of its own for those."""
        material = self.description["materials"][d["material"]]
        if material["type"] != "lambert" or material.get("albedo", 0.5) != 0 or "emission" not in material:
            return None
        return None if isinstance(material["emission"], dict) else rgb(material["emission"])

    def lamp(self, kind, radiance, watts_at_radiance_1, place):
        data = bpy.data.lights.new("lamp", kind)
        strength = max(radiance)
        data.color, data.energy = [c / strength for c in radiance], watts_at_radiance_1 * strength
        lamp = bpy.data.objects.new("lamp", data)
        lamp.matrix_world = place
        lamp.visible_camera = True
        bpy.context.collection.objects.link(lamp)
        return data

    def sphere_lamp(self, d, radiance):
        power = 4 * math.pi**2 * d["radius"] ** 2
        lamp = self.lamp("POINT", radiance, power, Matrix.Translation(Vector(d.get("center", (0, 0, 0)))))
        lamp.shadow_soft_size = d["radius"]

    def quad_lamp(self, d, radiance):
        corner, u, v = (Vector(d[key]) for key in ("corner", "edge_u", "edge_v"))
        axes = Matrix((u.normalized(), -v.normalized(), -u.cross(v).normalized())).transposed().to_4x4()
        power = 4 * u.length * v.length
        lamp = self.lamp("AREA", radiance, power, Matrix.Translation(corner + (u + v) / 2) @ axes)
        lamp.shape, lamp.size, lamp.size_y = "RECTANGLE", u.length, v.length

    def mesh(self, d):
        before = set(bpy.data.objects)
        bpy.ops.wm.obj_import(filepath=self.path_of(d["file"]), forward_axis="Y", up_axis="Z", validate_meshes=False)
        for imported in set(bpy.data.objects) - before:
            if d.get("normals", "file") != "file":
                imported.data.use_auto_smooth = False
                imported.data.free_normals_split()
                shade(imported.data, smooth=d["normals"] == "smooth")
            if "material" in d:
                imported.data.materials.clear()
                imported.data.materials.append(self.material(d["material"]))
            else:
                self.use_diffuse_of_mtl(imported.data)

    def use_diffuse_of_mtl(self, mesh):
        """Of MTL files only the diffuse colour, Kd, is converted."""
        for slot, imported in enumerate(mesh.materials):
            color = list(imported.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value)[:3]
            name = f"{imported.name} of the MTL file"
            mesh.materials[slot] = MaterialBuilder(self, name).build({"type": "lambert", "albedo": color})

    def environment(self):
        d = self.description.get("environment")
        world = bpy.data.worlds.new("environment")
        bpy.context.scene.world = world
        world.use_nodes = True
        background = world.node_tree.nodes["Background"]
        background.inputs["Color"].default_value = (0, 0, 0, 1)
        if d is None:
            return
        radiance = rgb(d.get("radiance", 1))
        if "texture" not in d:
            background.inputs["Color"].default_value = (*radiance, 1)
            return
        if len(set(radiance)) != 1:
            raise CannotConvert("a coloured 'radiance' beside a texture is not converted for Cycles")
        background.inputs["Strength"].default_value = radiance[0]
        sky = world.node_tree.nodes.new("ShaderNodeTexEnvironment")
        sky.image = bpy.data.images.load(self.path_of(self.description["textures"][d["texture"]]["file"]))
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
        data.sensor_height = 1000  # millimetres; large, since the f-number of a small one would be below Blender's least
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
        makers = {"quad": self.quad, "sphere": self.sphere, "mesh": self.mesh}
        for d in self.description["shapes"]:
            if d["type"] not in makers or "transform" in d:
                raise CannotConvert(f"a shape of type '{d['type']}' (or its transform) is not converted for Cycles")
            makers[d["type"]](d)
        self.environment()
        self.camera(width, height)


def shade(mesh, smooth):
    mesh.polygons.foreach_set("use_smooth", [smooth] * len(mesh.polygons))
