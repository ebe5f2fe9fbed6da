# SPDX-License-Identifier: Apache-2.0
"""The scenes of noise_scenes.py that depend on textures: instances of principled objects, foliage, large images."""

import math
import os
import random

from images import write_png
from scene_parts import cross, floor, lambert, lamp, normalized, quad, write_surface, write_texture


def torus(u, v):
    around, along = 2 * math.pi * u, 2 * math.pi * v
    r = 0.68 + 0.3 * math.cos(along)
    return r * math.cos(around), 0.3 - 0.3 * math.sin(along), -r * math.sin(around)


def revolved(radius_at, height_at):
    def point_at(u, v):
        return (radius_at(v) * math.cos(2 * math.pi * u), height_at(v), -radius_at(v) * math.sin(2 * math.pi * u))
    return point_at


def bumpy_ball(u, v):
    x, y, z = (math.sin(math.pi * v) * math.cos(2 * math.pi * u), math.cos(math.pi * v),
               -math.sin(math.pi * v) * math.sin(2 * math.pi * u))
    r = 0.8 + 0.07 * math.sin(8 * y) * math.sin(6 * x) + 0.06 * math.sin(7 * z)
    return r * x, r * y + 0.8, r * z


def signed_power(x, exponent):
    return math.copysign(abs(x) ** exponent, x)


def rounded_box(u, v):
    """A superellipsoid."""
    ring = signed_power(math.sin(math.pi * v), 0.5)
    return (0.75 * ring * signed_power(math.cos(2 * math.pi * u), 0.5),
            0.75 + 0.75 * signed_power(math.cos(math.pi * v), 0.5),
            -0.75 * ring * signed_power(math.sin(2 * math.pi * u), 0.5))


# What write_surface turns into meshes: from the top, v = 0, to the bottom.
FORMS = {
    "ball": bumpy_ball,
    "torus": torus,
    "vase": revolved(lambda v: math.sin(math.pi * v) ** 0.7 * (0.5 + 0.25 * math.sin(5.5 * v - 1)),
                     lambda v: 1.9 * (1 - v)),
    "box": rounded_box,
    "gourd": revolved(lambda v: math.sin(math.pi * v) ** 0.8 * (0.55 - 0.25 * math.cos(9 * v)),
                      lambda v: 1.6 * (1 - v)),
}


def waves(u, v, seed):
    """A smooth pattern between 0 and 1 that tiles."""
    a, b = 2 * math.pi * u, 2 * math.pi * v
    return 0.5 + 0.25 * (math.sin(3 * a + 2 * math.sin(2 * b + seed)) + math.sin(4 * b + 2 * math.sin(3 * a - seed)))


def write_principled_textures(folder, side=256):
    """The textures of `principled`, as the scene file describes them."""
    def color(dark, bright, seed):
        return lambda u, v: [d + (b - d) * waves(u, v, seed) for d, b in zip(dark, bright)]

    def gray(low, high, seed, sharpness=1):
        def value(u, v):
            share = min(max(0.5 + sharpness * (waves(u, v, seed) - 0.5), 0), 1)
            return [low + (high - low) * share] * 3
        return value

    images = {
        "rust": color((0.35, 0.15, 0.08), (0.8, 0.55, 0.35), 1), "moss": color((0.15, 0.3, 0.12), (0.6, 0.7, 0.4), 2),
        "sea": color((0.1, 0.2, 0.45), (0.5, 0.7, 0.8), 3), "bone": color((0.6, 0.55, 0.45), (0.9, 0.88, 0.8), 4),
        "worn": gray(0.25, 0.6, 5), "polished": gray(0.15, 0.4, 6),
        "scales": gray(0, 1, 7, 8), "spots": gray(0, 1, 8, 8)}
    for name, rgb_at in images.items():
        write_texture(os.path.join(folder, f"{name}.png"), side, rgb_at)
    return {name: {"file": f"{name}.png"} for name in images}


def principled(folder):
    """Three hundred instances of textured `principled` objects of five meshes, on a floor of the same kind."""
    for name, point_at in FORMS.items():
        write_surface(os.path.join(folder, f"{name}.obj"), 96, 64, point_at)
    textures_of = write_principled_textures(folder)

    def textured(color, roughness, metalness):
        return {"type": "principled", "base_color": {"texture": color}, "specular_roughness": {"texture": roughness},
                "base_metalness": {"texture": metalness}}

    materials = {"ball": textured("rust", "worn", "spots"), "torus": textured("sea", "polished", "scales"),
                 "vase": textured("bone", "polished", "spots"), "box": textured("moss", "worn", "scales"),
                 "gourd": textured("rust", "polished", "scales"), "ground": textured("bone", "worn", "spots"),
                 "lamp": lamp([60, 54, 46]) | {"emission_sides": "front"}}
    objects = {name: {"shapes": [{"type": "mesh", "file": f"{name}.obj", "material": name}]} for name in FORMS}
    objects["ground"] = {"shapes": [quad([-2, 0, 2], [4, 0, 0], [0, 0, -4], "ground")]}
    chance = random.Random(5)
    shapes = [quad([-7, 9, 4], [2, 0, 0], [0, 0, 2], "lamp")]
    for x in range(-6, 7):
        for z in range(-9, 4):
            shapes.append({"type": "instance", "object": "ground", "transform": [{"translate": [4 * x, 0, 4 * z]}]})
    for x in range(20):
        for z in range(15):
            shapes.append({"type": "instance", "object": chance.choice(list(FORMS)), "transform": [
                {"scale": round(chance.uniform(0.5, 0.8), 4)},
                {"rotate": {"axis": [0, 1, 0], "degrees": round(chance.uniform(0, 360), 2)}},
                {"translate": [round(1.5 * (x - 9.5), 4), 0, round(1.5 * (z - 10), 4)]}]})
    return {"camera": {"position": [2.5, 5, 11], "look_at": [0, 0.2, 0], "vertical_fov_degrees": 40},
            "textures": textures_of, "materials": materials, "environment": {"radiance": [0.5, 0.6, 0.75]},
            "objects": objects, "shapes": shapes}


def write_leaves(path, chance, count=400):
    """Leaves around a centre, as squares with texture coordinates, in a ball of radius 1 that stands on y = 0."""
    with open(path, "w", encoding="ascii") as file:
        file.write("vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n")
        for i in range(count):
            normal, along = ([chance.gauss(0, 1) for _ in range(3)] for _ in range(2))
            normal = normalized(normal)
            overlap = sum(a * b for a, b in zip(normal, along))
            along = [0.16 * c for c in normalized([a - overlap * n for a, n in zip(along, normal)])]
            across = cross(normal, along)
            radius = 0.9 * chance.random() ** 0.4
            center = [radius * n + (1 if axis == 1 else 0) for axis, n in enumerate(normal)]
            for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1)):
                corner = (c + s * a + t * b for c, a, b in zip(center, across, along))
                file.write("v {:.5f} {:.5f} {:.5f}\n".format(*corner))
            file.write("f " + " ".join(f"{4 * i + k}/{k}" for k in (1, 2, 3, 4)) + "\n")


def foliage(folder):
    """Shrubs, instances of four hundred leaves each: cut out of squares by a texture, they let light through. A sun
    and an even sky."""
    chance = random.Random(6)
    write_leaves(os.path.join(folder, "leaves.obj"), chance)

    def leaf(u, v):
        inside = abs(u - 0.5) < 0.42 * math.sin(math.pi * min(max(v, 0), 1)) ** 0.8
        return [1.0 if inside else 0.0] * 3

    write_texture(os.path.join(folder, "leaf.png"), 256, leaf)
    shapes = [floor(40)]
    for x in range(16):
        for z in range(16):
            shapes.append({"type": "instance", "object": "shrub", "transform": [
                {"scale": round(chance.uniform(0.6, 1.1), 4)},
                {"rotate": {"axis": [0, 1, 0], "degrees": round(chance.uniform(0, 360), 2)}},
                {"translate": [round(1.7 * (x - 7.5 + chance.uniform(-0.3, 0.3)), 4), 0,
                               round(1.7 * (z - 10 + chance.uniform(-0.3, 0.3)), 4)]}]})
    return {
        "camera": {"position": [0, 3.2, 11], "look_at": [0, 0.9, 0], "vertical_fov_degrees": 38},
        "textures": {"leaf": {"file": "leaf.png"}},
        "materials": {"floor": lambert([0.35, 0.28, 0.2]),
                      "leaf": {"type": "diffuse_transmission", "reflectance": [0.25, 0.4, 0.12],
                               "transmittance": [0.2, 0.35, 0.08], "opacity": {"texture": "leaf"}}},
        "lights": [{"type": "directional", "direction": [0.5, -0.8, -0.35], "irradiance": [3, 2.8, 2.4]}],
        "environment": {"radiance": [0.5, 0.6, 0.8]},
        "objects": {"shrub": {"shapes": [{"type": "mesh", "file": "leaves.obj", "material": "leaf"}]}},
        "shapes": shapes,
    }


def write_tiles(path, side, tile, dark, bright, chance):
    """Square tiles of random shades, with grain in each texel."""
    grain_of = int.from_bytes(bytes([15]) * 3 * side, "big")
    rows = []
    for _ in range(side // tile):
        shades = (chance.random() for _ in range(side // tile))
        row = b"".join(bytes(round(d + (b - d) * shade) for d, b in zip(dark, bright)) * tile for shade in shades)
        for _ in range(tile):
            grain = int.from_bytes(chance.randbytes(3 * side), "big") & grain_of
            rows.append((int.from_bytes(row, "big") ^ grain).to_bytes(3 * side, "big"))
    write_png(path, side, side, rows)


def textures(folder):
    """Three images of 4096 x 4096 pixels on a floor, a wall and bodies, under an even sky and a lamp."""
    chance = random.Random(7)
    for name, tile, dark, bright in (("floor", 64, (90, 70, 50), (200, 180, 150)),
                                     ("wall", 32, (70, 90, 110), (190, 205, 215)),
                                     ("ball", 128, (150, 50, 40), (230, 190, 90))):
        write_tiles(os.path.join(folder, f"{name}.png"), 4096, tile, dark, bright, chance)
    write_surface(os.path.join(folder, "ball.obj"), 96, 64, bumpy_ball)
    ball = {"type": "mesh", "file": "ball.obj", "material": "ball"}
    names = ("floor", "wall", "ball")
    materials = {name: lambert({"texture": name}) for name in names} | {
        "lamp": lamp([40, 37, 32]) | {"emission_sides": "front"}}
    return {
        "camera": {"position": [0, 2.2, 6], "look_at": [0, 0.9, 0], "vertical_fov_degrees": 42},
        "textures": {name: {"file": f"{name}.png"} for name in names},
        "materials": materials,
        "environment": {"radiance": [0.4, 0.45, 0.55]},
        "shapes": [quad([-8, 0, 6], [16, 0, 0], [0, 0, -9], "floor"), quad([-8, 0, -3], [16, 0, 0], [0, 9, 0], "wall"),
                   quad([-4, 5, 2], [1.5, 0, 0], [0, 0, 1.5], "lamp"),
                   ball | {"transform": [{"translate": [-1.3, 0, -0.5]}]},
                   ball | {"transform": [{"scale": 0.7}, {"translate": [1.2, 0, 0.3]}]}],
    }
