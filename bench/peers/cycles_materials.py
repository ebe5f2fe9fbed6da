# SPDX-License-Identifier: Apache-2.0
"""A Tessera material as a node tree of Blender (3.4), for Cycles. What has no counterpart is refused by a sentence."""

import bpy


class CannotConvert(Exception):
    pass


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

    def math(self, operation, *values):
        node = self.node("ShaderNodeMath", operation=operation)
        for socket, value in zip(node.inputs, values):
            self.feed(socket, value)
        return node.outputs[0]

    def texture(self, name, linear=False):
        description = self.scene.description["textures"][name]
        refuse_unknown(f"texture '{name}'", description, {"file", "color_space", "wrap", "scale"})
        image = self.node("ShaderNodeTexImage", interpolation="Linear")
        image.extension = "EXTEND" if description.get("wrap") == "clamp" else "REPEAT"
        linear = linear or description.get("color_space") == "linear"
        image.image = self.scene.image(description["file"], linear)
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

    def number(self, value):
        """A number, or the red channel of a texture times a scale."""
        if not isinstance(value, dict):
            return value
        red = self.shader("ShaderNodeSeparateColor", {"Color": self.texture(value["texture"], linear=True)})
        return red if value.get("scale", 1) == 1 else self.math("MULTIPLY", red, value["scale"])

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

    def by_side(self, front, back):
        """One number on the front of a surface and another on its back."""
        backfacing = self.node("ShaderNodeNewGeometry").outputs["Backfacing"]
        return self.math("MULTIPLY_ADD", backfacing, back - front, front)

    def add(self, first, second):
        node = self.node("ShaderNodeAddShader")
        self.tree.links.new(first, node.inputs[0])
        self.tree.links.new(second, node.inputs[1])
        return node.outputs[0]

    def mix(self, share_of_second, first, second):
        node = self.node("ShaderNodeMixShader")
        self.feed(node.inputs[0], share_of_second)
        for shader, socket in ((first, node.inputs[1]), (second, node.inputs[2])):
            if shader:
                self.tree.links.new(shader, socket)
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
        if d.get("fresnel", "exact") != "exact":
            raise CannotConvert("only glass with exact Fresnel is converted for Cycles")
        reflectance = self.color(d.get("reflectance", 1))
        transmittance = self.color(d.get("transmittance", 1))
        ior, roughness = d.get("ior", 1.5), self.number(d.get("roughness", 0))
        if reflectance == transmittance:
            inputs = {"Color": reflectance, "IOR": ior, "Roughness": roughness}
            return self.shader("ShaderNodeBsdfGlass", inputs, distribution="SHARP" if roughness == 0 else distribution(d))
        if roughness != 0:
            raise CannotConvert("rough glass with unequal 'reflectance' and 'transmittance' is not converted for Cycles")
        refracted = self.shader("ShaderNodeBsdfRefraction", {"Color": transmittance, "IOR": ior}, distribution="SHARP")
        reflected = self.shader("ShaderNodeBsdfGlossy", {"Color": reflectance}, distribution="SHARP")
        return self.mix(self.shader("ShaderNodeFresnel", {"IOR": ior}), refracted, reflected)

    def thin_dielectric(self, d):
        ior = d.get("ior", 1.5)
        # The Fresnel node takes the inverse index on the back.
        surface = self.shader("ShaderNodeFresnel", {"IOR": self.by_side(ior, 1 / ior)})
        pane = self.math("DIVIDE", self.math("MULTIPLY", surface, 2.0), self.math("ADD", surface, 1.0))
        through = self.shader("ShaderNodeBsdfTransparent", {"Color": self.color(d.get("transmittance", 1))})
        return self.mix(pane, through, self.mirror({"reflectance": d.get("reflectance", 1)}))

    def cook_torrance(self, d):
        share = self.color(d.get("specular", 1))
        if not isinstance(share, tuple) or len(set(share)) != 1:
            raise CannotConvert("of cook_torrance only gray 'specular' is converted for Cycles")
        normal = self.normal(d)
        # Reflectance rises towards grazing angles as that of a dielectric does, whose index "Specular" gives. At 1.3,
        # and 0.0035 lower, it stays within 6 % of Schlick's curve for f0 = 0.05, up to 66 degrees.
        f0 = tuple(c - 0.0035 * (1 - c) for c in self.color(d.get("f0", 0.04)))
        facets = {"Base Color": f0, "Metallic": 1.0, "Specular": 0.213, "Roughness": d.get("roughness", 0.3)}
        metal = self.shader("ShaderNodeBsdfPrincipled", {**facets, **normal}, distribution="GGX")
        metal = self.mix(share[0], None, metal)
        diffuse = self.color(d.get("diffuse", 0))
        if diffuse == (0, 0, 0):
            return metal
        return self.add(self.shader("ShaderNodeBsdfDiffuse", {"Color": diffuse, **normal}), metal)

    def conductor(self, d):
        """One that reflects everything but for its tint."""
        roughness = self.number(d.get("roughness", 0))
        inputs = {"Color": self.color(d.get("specular", 1)), "Roughness": roughness, **self.normal(d)}
        return self.shader("ShaderNodeBsdfGlossy", inputs, distribution="SHARP" if roughness == 0 else distribution(d))

    def principled(self, d):
        # "Specular" is the reflectance at normal incidence over 0.08.
        ior = d.get("specular_ior", 1.5)
        inputs = {"Base Color": self.color(d.get("base_color", 0.8)),
                  "Metallic": self.number(d.get("base_metalness", 0)),
                  "Roughness": self.number(d.get("specular_roughness", 0.3)),
                  "Specular": ((ior - 1) / (ior + 1)) ** 2 / 0.08}
        return self.shader("ShaderNodeBsdfPrincipled", {**inputs, **self.normal(d)}, distribution="GGX")

    def diffuse_transmission(self, d):
        reflectance, transmittance = (self.color(d.get(key, 0.25)) for key in ("reflectance", "transmittance"))
        return self.add(self.shader("ShaderNodeBsdfDiffuse", {"Color": reflectance, **self.normal(d)}),
                        self.shader("ShaderNodeBsdfTranslucent", {"Color": transmittance, **self.normal(d)}))

    def emission(self, d):
        if isinstance(d["emission"], dict):
            raise CannotConvert("textured emission is not converted for Cycles")
        color = rgb(d["emission"])
        strength = max(color)
        front_only = d.get("emission_sides", "both") == "front"
        inputs = {"Color": tuple(c / strength for c in color),
                  "Strength": self.by_side(strength, 0.0) if front_only else strength}
        return self.shader("ShaderNodeEmission", inputs)

    def medium(self, d):
        """The volume shader of a homogeneous medium. The colour of an absorption node says what it does not absorb."""
        refuse_unknown("a medium", d, {"sigma_a", "sigma_s", "scale", "g"})
        sigma_a, sigma_s = (tuple(c * d.get("scale", 1) for c in rgb(d.get(key, 0))) for key in ("sigma_a", "sigma_s"))
        volumes = []
        if any(sigma_a):
            most = max(sigma_a)
            inputs = {"Color": tuple(1 - c / most for c in sigma_a), "Density": most}
            volumes.append(self.shader("ShaderNodeVolumeAbsorption", inputs))
        if any(sigma_s):
            most = max(sigma_s)
            inputs = {"Color": tuple(c / most for c in sigma_s), "Density": most, "Anisotropy": d.get("g", 0)}
            volumes.append(self.shader("ShaderNodeVolumeScatter", inputs))
        return volumes[0] if len(volumes) == 1 else self.add(*volumes)

    def surface(self, d):
        make, keys = SURFACES.get(d["type"], (None, ()))
        if not make:
            raise CannotConvert(f"material type '{d['type']}' is not converted for Cycles")
        refuse_unknown(f"material '{self.material.name}'", d, keys | KEYS_OF_ALL)
        surface = make(self, d)
        if "emission" in d:
            emission = self.emission(d)
            surface = self.add(surface, emission) if surface else emission
        opacity = self.number(d.get("opacity", 1))
        if surface and opacity != 1:
            surface = self.mix(opacity, self.shader("ShaderNodeBsdfTransparent", {}), surface)
        return surface

    def build(self, d):
        surface = self.surface(d)
        output = self.node("ShaderNodeOutputMaterial")
        if surface:
            self.tree.links.new(surface, output.inputs["Surface"])
        if "interior_medium" in d:
            volume = self.medium(self.scene.description["media"][d["interior_medium"]])
            self.tree.links.new(volume, output.inputs["Volume"])
        return self.material


def distribution(d):
    return {"ggx": "GGX", "beckmann": "BECKMANN"}[d.get("distribution", "ggx")]


# Of each type the function that makes its shader, and the keys that it converts. "sampling" changes the noise alone;
# Cycles has separable masking only.
KEYS_OF_ALL = {"type", "emission", "emission_sides", "normal_map", "opacity", "interior_medium", "sampling"}
SURFACES = {
    "lambert": (MaterialBuilder.lambert, {"albedo"}),
    "mirror": (MaterialBuilder.mirror, {"reflectance"}),
    "glass": (MaterialBuilder.glass,
              {"ior", "reflectance", "transmittance", "fresnel", "roughness", "distribution", "masking"}),
    "thin_dielectric": (MaterialBuilder.thin_dielectric, {"ior", "reflectance", "transmittance"}),
    "cook_torrance": (MaterialBuilder.cook_torrance, {"diffuse", "specular", "f0", "roughness"}),
    "conductor": (MaterialBuilder.conductor, {"specular", "roughness", "distribution", "masking"}),
    "principled": (MaterialBuilder.principled, {"base_color", "base_metalness", "specular_roughness", "specular_ior"}),
    "diffuse_transmission": (MaterialBuilder.diffuse_transmission, {"reflectance", "transmittance"}),
}
