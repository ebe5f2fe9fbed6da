# SPDX-License-Identifier: Apache-2.0
"""Scenes of kinds in which renderers' noise differs from that in the scenes of scenes/, for compare.py and noise.py.
Plain Python; the same bytes on every machine but for the last digits of sines. To add one: a function that writes the
scene's files into a folder and returns the scene, and its name in SCENES."""

import json
import os
import random

from scene_parts import (floor, lambert, lamp, quad, room_with_window, small_lamps, sphere, write_bumpy_body,
                         write_revolved, write_sky)
from textured_scenes import foliage, principled, textures


def bodies(folder):
    """Twenty-five instances of a bumpy body under an even sky and a lamp."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    chance = random.Random(1)
    shapes = [floor(40), quad([-6, 9, 6], [1.2, 0, 0], [0, 0, 1.2], "lamp")]
    for i in range(25):
        shapes.append({"type": "instance", "object": "body", "transform": [
            {"scale": [chance.uniform(0.6, 1)] * 3},
            {"rotate": {"axis": [0, 1, 0], "degrees": chance.uniform(0, 360)}},
            {"translate": [2.4 * (i % 5 - 2), 0, 2.4 * (i // 5 - 2)]}]})
    return {
        "camera": {"position": [1.8, 5.4, 10.2], "look_at": [0, 0.6, 0], "vertical_fov_degrees": 36},
        "materials": {"body": lambert([0.62, 0.55, 0.45]), "floor": lambert(0.4),
                      "lamp": lamp([150, 131, 106]) | {"emission_sides": "front"}},
        "environment": {"radiance": [0.5, 0.6, 0.75]},
        "objects": {"body": {"shapes": [{"type": "mesh", "file": "body.obj", "material": "body"}]}},
        "shapes": shapes,
    }


def small_sun(folder):
    """Matt and glossy bodies under an image of a sky with a sun of the size of the real one."""
    write_sky(os.path.join(folder, "sky.pfm"), to_sun=(-0.5, 0.6, 0.62))
    write_bumpy_body(os.path.join(folder, "body.obj"))
    mesh = {"type": "mesh", "file": "body.obj"}
    return {
        "camera": {"position": [1, 3, 8], "look_at": [0, 0.8, 0], "vertical_fov_degrees": 34},
        "textures": {"sky": {"file": "sky.pfm"}},
        "materials": {"matt": lambert([0.6, 0.3, 0.2]), "floor": lambert(0.45),
                      "glossy": {"type": "cook_torrance", "diffuse": [0.1, 0.2, 0.35], "specular": 0.6, "roughness": 0.25}},
        "environment": {"texture": "sky"},
        "shapes": [floor(30), mesh | {"material": "matt", "transform": [{"translate": [-1.3, 0, 0]}]},
                   mesh | {"material": "glossy", "transform": [{"translate": [1.3, 0, 0.3]}]},
                   sphere([0.1, 0.4, 2], 0.4, "matt")],
    }


def window(folder):
    """A room lit by the sky through a window."""
    del folder
    return {
        "camera": {"position": [2.6, 1.7, 3.7], "look_at": [-0.6, 1, -1], "vertical_fov_degrees": 58},
        "materials": {"wall": lambert([0.72, 0.7, 0.66]), "floor": lambert([0.45, 0.32, 0.2]),
                      "ball": lambert([0.2, 0.4, 0.6]),
                      "vase": {"type": "cook_torrance", "diffuse": [0.3, 0.1, 0.1], "specular": 0.5, "roughness": 0.3}},
        "environment": {"radiance": [5, 6, 8]},
        "shapes": [*room_with_window(), sphere([-1.2, 0.6, -1.2], 0.6, "ball"), sphere([0.5, 0.4, -0.2], 0.4, "vase")],
    }


def sunny_window(folder):
    """The same room, under an image of a sky with a small sun, which lights its floor."""
    write_sky(os.path.join(folder, "sky.pfm"), to_sun=(-0.8, 0.45, -0.15), scale=5)
    return window(folder) | {"textures": {"sky": {"file": "sky.pfm"}}, "environment": {"texture": "sky"}}


def pane(folder):
    """The same room with a pane in the window; the sun is a directional light."""
    room = window(folder)
    room["materials"]["pane"] = {"type": "thin_dielectric", "ior": 1.5}
    room["shapes"].append(quad([-3, 0.9, 0], [0, 0, -2], [0, 1.2, 0], "pane"))
    return room | {"lights": [{"type": "directional", "direction": [0.8, -0.45, 0.15], "irradiance": [30, 27, 22]}]}


def sunny_pane(folder):
    """The same room under an image of a sky with a small sun, with a pane of solid glass in the window."""
    room = sunny_window(folder)
    x, y, z, thickness, height, width = -3.03, 0.85, 0.05, 0.02, 1.3, 2.1
    across, up, along = [thickness, 0, 0], [0, height, 0], [0, 0, -width]
    for corner, u, v in (([x, y, z], up, along), ([x + thickness, y, z], along, up), ([x, y, z], along, across),
                         ([x, y + height, z], across, along), ([x, y, z], across, up), ([x, y, z - width], up, across)):
        room["shapes"].append(quad(corner, u, v, "pane"))
    room["materials"]["pane"] = {"type": "glass", "ior": 1.5}
    return room


def white_room(folder):
    """A closed room of albedo 0.9 under a small lamp: long paths."""
    del folder
    return {
        "camera": {"position": [0, 1.5, 3.6], "look_at": [0, 1.2, 0], "vertical_fov_degrees": 60},
        "materials": {"white": lambert(0.9), "ball": lambert([0.9, 0.5, 0.3]),
                      "lamp": lambert(0.9) | {"emission": [10, 9.5, 8.5], "emission_sides": "front"}},
        "shapes": [
            quad([-2.5, 0, 4], [5, 0, 0], [0, 0, -8], "white"), quad([-2.5, 3, -4], [5, 0, 0], [0, 0, 8], "white"),
            quad([-2.5, 0, -4], [5, 0, 0], [0, 3, 0], "white"), quad([2.5, 0, 4], [-5, 0, 0], [0, 3, 0], "white"),
            quad([-2.5, 0, 4], [0, 0, -8], [0, 3, 0], "white"), quad([2.5, 0, -4], [0, 0, 8], [0, 3, 0], "white"),
            quad([-0.4, 2.98, 0.4], [0, 0, -0.8], [0.8, 0, 0], "lamp"),
            sphere([-1, 0.7, -1], 0.7, "white"), sphere([0.9, 0.5, 0], 0.5, "ball")],
    }


def lamps(folder):
    """Five hundred small lamps over a floor with bodies."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    chance = random.Random(2)
    materials = {"floor": lambert(0.5), "body": lambert([0.6, 0.55, 0.5])}

    def place(c):
        return [round(c.uniform(-9, 9), 4), round(c.uniform(0.3, 4), 4), round(c.uniform(-12, 6), 4)]

    shapes = [floor(20)] + small_lamps(500, chance, place, 0.03, materials)
    for x, z in ((-2.4, -1), (0, -3), (2.2, 0.5), (5, -5), (-5, -6)):
        shapes.append({"type": "mesh", "file": "body.obj", "material": "body", "transform": [{"translate": [x, 0, z]}]})
    return {"camera": {"position": [0, 3, 9], "look_at": [0, 1, -2], "vertical_fov_degrees": 45},
            "materials": materials, "shapes": shapes}


def blurred_lamps(folder):
    """Three hundred small lamps, out of focus behind a few things on a table."""
    del folder
    chance = random.Random(3)
    materials = {"floor": lambert(0.3), "ball": lambert([0.6, 0.3, 0.25]),
                 "polished": {"type": "cook_torrance", "diffuse": [0.05, 0.06, 0.08], "specular": 0.8, "roughness": 0.2}}

    def place(c):
        return [round(c.uniform(-9, 9), 4), round(c.uniform(0.2, 6), 4), round(c.uniform(-16, -5), 4)]

    shapes = [floor(30)] + small_lamps(300, chance, place, 0.04, materials)
    shapes += [sphere([-0.5, 0.5, 0], 0.5, "ball"), sphere([0.6, 0.4, 0.3], 0.4, "polished")]
    return {"camera": {"position": [0, 1.1, 4], "look_at": [0, 0.7, 0], "vertical_fov_degrees": 35, "aperture_radius": 0.15},
            "materials": materials, "shapes": shapes}


def glasses(folder):
    """Tumblers with a liquid on a table, under a small lamp and a dim sky: light passes up to eight surfaces."""
    tumbler = [(0, 0), (0.4, 0), (0.42, 0.05), (0.5, 1.3), (0.46, 1.3), (0.385, 0.12), (0.35, 0.08), (0, 0.08)]
    liquid = [(0, 0.085), (0.345, 0.085), (0.38, 0.125), (0.43, 0.85), (0, 0.85)]
    write_revolved(os.path.join(folder, "tumbler.obj"), tumbler)
    write_revolved(os.path.join(folder, "liquid.obj"), liquid)
    drink = [{"type": "mesh", "file": "tumbler.obj", "material": "glass"},
             {"type": "mesh", "file": "liquid.obj", "material": "liquid"}]
    shapes = [floor(12), sphere([-2.5, 4, 1.5], 0.25, "lamp")]
    for x, z in ((-1.1, 0), (0.1, -0.5), (1.2, 0.2)):
        shapes += [mesh | {"transform": [{"translate": [x, 0.001, z]}]} for mesh in drink]
    return {
        "camera": {"position": [0, 1.8, 5], "look_at": [0, 0.55, 0], "vertical_fov_degrees": 34},
        "materials": {"floor": lambert([0.55, 0.5, 0.45]), "lamp": lamp([120, 110, 90]), "glass": {"type": "glass", "ior": 1.5},
                      "liquid": {"type": "glass", "ior": 1.33, "transmittance": [0.9, 0.6, 0.3]}},
        "environment": {"radiance": [0.25, 0.3, 0.4]},
        "shapes": shapes,
    }


def tinted_glass(folder):
    """Solid glass that absorbs light inside, under a small lamp and a dim sky."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    materials = {"floor": lambert([0.6, 0.58, 0.55]), "lamp": lamp([120, 110, 90])}
    media = {}
    shapes = [floor(12), sphere([-2.5, 4, 1.5], 0.25, "lamp")]
    for name, x, z, absorption in (("amber", -1.3, -0.4, [0.2, 0.9, 2.4]), ("green", 1.2, -0.6, [1.4, 0.2, 1.0])):
        media[name] = {"sigma_a": absorption}
        materials[name] = {"type": "glass", "ior": 1.5, "interior_medium": name}
        shapes.append({"type": "mesh", "file": "body.obj", "normals": "smooth", "material": name,
                       "transform": [{"scale": 0.75}, {"translate": [x, 0.001, z]}]})
    media["blue"] = {"sigma_a": [3, 1.2, 0.2]}
    materials["blue"] = {"type": "glass", "ior": 1.33, "interior_medium": "blue"}
    shapes.append(sphere([0, 0.451, 1], 0.45, "blue"))
    return {"camera": {"position": [0, 2.2, 5.5], "look_at": [0, 0.6, 0], "vertical_fov_degrees": 34},
            "materials": materials, "media": media, "environment": {"radiance": [0.4, 0.45, 0.55]}, "shapes": shapes}


def rough_glass(folder):
    """Frosted bodies under a lamp and a dim sky."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    frosted = {"type": "glass", "ior": 1.5, "masking": "separable"}
    mesh = {"type": "mesh", "file": "body.obj", "normals": "smooth"}
    return {
        "camera": {"position": [0.5, 2.4, 6], "look_at": [0, 0.7, 0], "vertical_fov_degrees": 36},
        "materials": {"floor": lambert([0.5, 0.45, 0.4]), "wall": lambert([0.3, 0.45, 0.5]), "lamp": lamp([40, 37, 32]),
                      "dull": frosted | {"roughness": 0.4}, "satin": frosted | {"roughness": 0.2}},
        "environment": {"radiance": [0.3, 0.35, 0.45]},
        "shapes": [floor(15), quad([-15, 0, -4], [30, 0, 0], [0, 8, 0], "wall"), sphere([-3, 5, 2], 0.6, "lamp"),
                   mesh | {"material": "satin", "transform": [{"scale": 0.85}, {"translate": [-1.2, 0.001, 0]}]},
                   mesh | {"material": "dull", "transform": [{"scale": 0.7}, {"translate": [1.1, 0.001, -0.5]}]},
                   sphere([0.4, 0.451, 1.3], 0.45, "satin")],
    }


def glossy(folder):
    """Rough metal on rough metal: each lobe sees the others."""
    write_bumpy_body(os.path.join(folder, "body.obj"))

    def metal(color, roughness):
        return {"type": "conductor", "specular": color, "roughness": roughness, "masking": "separable"}

    mesh = {"type": "mesh", "file": "body.obj", "normals": "smooth"}
    return {
        "camera": {"position": [0, 2.6, 6.5], "look_at": [0, 0.7, 0], "vertical_fov_degrees": 36},
        "materials": {"floor": metal([0.7, 0.7, 0.72], 0.35), "copper": metal([0.9, 0.55, 0.4], 0.25),
                      "gold": metal([0.95, 0.75, 0.35], 0.4), "steel": metal(0.65, 0.2),
                      "lamp": lamp([14, 13, 11]) | {"emission_sides": "front"}},
        "environment": {"radiance": [0.35, 0.4, 0.5]},
        "shapes": [floor(12), quad([-4, 5, 2], [2, 0, 0], [0, 0, 2], "lamp"),
                   mesh | {"material": "copper", "transform": [{"translate": [-1.5, 0, -0.5]}]},
                   mesh | {"material": "gold", "transform": [{"scale": 0.8}, {"translate": [1.4, 0, -0.8]}]},
                   sphere([0, 0.6, 1], 0.6, "steel")],
    }


def emitters(folder):
    """A mesh of three thousand small triangles that emit, in the air among bodies."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    chance = random.Random(4)
    with open(os.path.join(folder, "emitters.obj"), "w", encoding="ascii") as file:
        for i in range(3000):
            center = [chance.uniform(-8, 8), chance.uniform(0.3, 3.5), chance.uniform(-12, 5)]
            for _ in range(3):
                file.write("v {:.4f} {:.4f} {:.4f}\n".format(*(c + chance.uniform(-0.04, 0.04) for c in center)))
            file.write(f"f {3 * i + 1} {3 * i + 2} {3 * i + 3}\n")
    shapes = [floor(20), {"type": "mesh", "file": "emitters.obj", "material": "lamp"}]
    for x, z in ((-2.4, -1), (0, -3), (2.2, 0.5), (5, -5), (-5, -6)):
        shapes.append({"type": "mesh", "file": "body.obj", "material": "body", "transform": [{"translate": [x, 0, z]}]})
    return {"camera": {"position": [0, 3, 9], "look_at": [0, 1, -2], "vertical_fov_degrees": 45},
            "materials": {"floor": lambert(0.5), "body": lambert([0.6, 0.55, 0.5]), "lamp": lamp([60, 45, 28])},
            "shapes": shapes}


SCENES = {make.__name__: make for make in (
    bodies, small_sun, window, sunny_window, pane, sunny_pane, white_room, lamps, blurred_lamps, emitters, glasses, tinted_glass,
    rough_glass, glossy, principled, foliage, textures)}


def write_scene(name, folder):
    """Writes a scene of SCENES with its files into the folder; returns the scene file."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, f"{name}.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(SCENES[name](folder), file, indent=1)
    return path
