# SPDX-License-Identifier: Apache-2.0
"""Scenes of kinds in which a renderer's noise differs from the six scenes of compare.py. Plain Python; the same bytes on
every machine but for the last digits of sines."""

import array
import json
import math
import os
import random
import sys


def lambert(albedo):
    return {"type": "lambert", "albedo": albedo}


def lamp(emission):
    return {"type": "lambert", "albedo": 0, "emission": emission}


def quad(corner, edge_u, edge_v, material):
    return {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v, "material": material}


def floor(half_width, material="floor"):
    w = half_width
    return quad([-w, 0, w], [2 * w, 0, 0], [0, 0, -2 * w], material)


def sphere(center, radius, material):
    return {"type": "sphere", "center": center, "radius": radius, "material": material}


def write_revolved(path, profile, columns=64):
    """Revolves points (radius, height) of a closed outline about the y axis, with the outside to the right of the
    outline's direction. Normals are smooth but for corners of more than 60 degrees."""
    lines = []
    count = 0
    for (r0, y0), (r1, y1), before, after in edges_of(profile):
        for column in range(columns + 1):
            angle = 2 * math.pi * (column % columns) / columns
            c, s = math.cos(angle), math.sin(angle)
            for (r, y), (nr, ny) in (((r0, y0), before), ((r1, y1), after)):
                lines.append(f"v {r * c:.6f} {y:.6f} {r * s:.6f}")
                lines.append(f"vn {nr * c:.6f} {ny:.6f} {nr * s:.6f}")
        for column in range(columns):
            a, b, c, d = (f"{count + 2 * column + i}//{count + 2 * column + i}" for i in (1, 2, 4, 3))
            if r1 > 0:
                lines.append(f"f {a} {b} {c}")
            if r0 > 0:
                lines.append(f"f {a} {c} {d}")
        count += 2 * (columns + 1)
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


def edges_of(profile):
    """The edges of an outline with the normals at their ends, in (radius, height)."""
    flat = []
    for (r0, y0), (r1, y1) in zip(profile, profile[1:]):
        size = math.hypot(r1 - r0, y1 - y0)
        flat.append(((y1 - y0) / size, (r0 - r1) / size))

    def blended(i, j):
        if not 0 <= j < len(flat) or flat[i][0] * flat[j][0] + flat[i][1] * flat[j][1] < 0.5:
            return flat[i]
        r, y = flat[i][0] + flat[j][0], flat[i][1] + flat[j][1]
        return r / math.hypot(r, y), y / math.hypot(r, y)

    for i, (begin, end) in enumerate(zip(profile, profile[1:])):
        yield begin, end, blended(i, i - 1), blended(i, i + 1)


def write_pfm(path, width, height, rgb_at):
    """rgb_at(u, v) with v from the bottom."""
    values = array.array("f")
    for row in range(height):
        for column in range(width):
            values.extend(rgb_at((column + 0.5) / width, (row + 0.5) / height))
    if sys.byteorder == "big":
        values.byteswap()
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        file.write(values.tobytes())


def write_bumpy_body(path, rows=60):
    """A ball with bumps, standing on the plane y = 0."""
    lines = []
    columns = 2 * rows
    for i in range(rows + 1):
        for j in range(columns):
            theta, phi = math.pi * i / rows, 2 * math.pi * j / columns
            x, y, z = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
            r = 1 + 0.12 * math.sin(9 * y) * math.sin(7 * x) + 0.1 * math.sin(8 * z) * math.sin(5 * x + 1)
            lines.append(f"v {r * x:.6f} {r * y + 1.05:.6f} {r * z:.6f}")
    for i in range(rows):
        for j in range(columns):
            a, b = 1 + i * columns + j, 1 + i * columns + (j + 1) % columns
            c, d = b + columns, a + columns
            if i > 0:
                lines.append(f"f {a} {b} {c}")
            if i + 1 < rows:
                lines.append(f"f {a} {c} {d}")
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


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
    sun = (-0.5, 0.6, 0.62)
    to_sun = [c / math.sqrt(sum(c * c for c in sun)) for c in sun]
    cos_of_sun = math.cos(math.radians(0.4))

    def sky(u, v):
        longitude, latitude = 2 * math.pi * (u - 0.5), math.pi * (v - 0.5)
        d = (math.cos(latitude) * math.sin(longitude), math.sin(latitude), -math.cos(latitude) * math.cos(longitude))
        if sum(a * b for a, b in zip(d, to_sun)) > cos_of_sun:
            return (20000, 18000, 15000)
        if d[1] < 0:
            return (0.1, 0.09, 0.08)
        haze = math.exp(-4 * d[1])
        return (0.25 + 0.7 * haze, 0.4 + 0.6 * haze, 0.8 + 0.3 * haze)

    write_pfm(os.path.join(folder, "sky.pfm"), 1024, 512, sky)
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
    wall = lambda corner, u, v: quad(corner, u, v, "wall")
    return {
        "camera": {"position": [2.6, 1.7, 3.7], "look_at": [-0.6, 1, -1], "vertical_fov_degrees": 58},
        "materials": {"wall": lambert([0.72, 0.7, 0.66]), "floor": lambert([0.45, 0.32, 0.2]), "ball": lambert([0.2, 0.4, 0.6]),
                      "vase": {"type": "cook_torrance", "diffuse": [0.3, 0.1, 0.1], "specular": 0.5, "roughness": 0.3}},
        "environment": {"radiance": [5, 6, 8]},
        "shapes": [
            quad([-3, 0, 4], [6, 0, 0], [0, 0, -8], "floor"), wall([-3, 3, -4], [6, 0, 0], [0, 0, 8]),
            wall([-3, 0, -4], [6, 0, 0], [0, 3, 0]), wall([3, 0, 4], [-6, 0, 0], [0, 3, 0]),
            wall([3, 0, -4], [0, 0, 8], [0, 3, 0]),
            # The wall with the window, 2 wide and 1.2 high.
            wall([-3, 0, 4], [0, 0, -8], [0, 0.9, 0]), wall([-3, 2.1, 4], [0, 0, -8], [0, 0.9, 0]),
            wall([-3, 0.9, 4], [0, 0, -4], [0, 1.2, 0]), wall([-3, 0.9, -2], [0, 0, -2], [0, 1.2, 0]),
            sphere([-1.2, 0.6, -1.2], 0.6, "ball"), sphere([0.5, 0.4, -0.2], 0.4, "vase")],
    }


def small_lamps(count, chance, place, radius, materials):
    shapes = []
    for i in range(count):
        hue = chance.random()
        strength = chance.uniform(0.3, 1) * 60
        materials[f"lamp {i}"] = lamp([strength * (0.4 + 0.6 * hue), strength * 0.7, strength * (1 - 0.6 * hue)])
        shapes.append(sphere(place(chance), radius, f"lamp {i}"))
    return shapes


def lamps(folder):
    """Five hundred small lamps over a floor with bodies."""
    write_bumpy_body(os.path.join(folder, "body.obj"))
    chance = random.Random(2)
    materials = {"floor": lambert(0.5), "body": lambert([0.6, 0.55, 0.5])}
    place = lambda c: [round(c.uniform(-9, 9), 4), round(c.uniform(0.3, 4), 4), round(c.uniform(-12, 6), 4)]
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
    place = lambda c: [round(c.uniform(-9, 9), 4), round(c.uniform(0.2, 6), 4), round(c.uniform(-16, -5), 4)]
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
        shapes += [mesh | {"transform": [{"translate": [x, 0, z]}]} for mesh in drink]
    return {
        "camera": {"position": [0, 1.8, 5], "look_at": [0, 0.55, 0], "vertical_fov_degrees": 34},
        "materials": {"floor": lambert([0.55, 0.5, 0.45]), "lamp": lamp([120, 110, 90]), "glass": {"type": "glass", "ior": 1.5},
                      "liquid": {"type": "glass", "ior": 1.33, "transmittance": [0.9, 0.6, 0.3]}},
        "environment": {"radiance": [0.25, 0.3, 0.4]},
        "shapes": shapes,
    }


SCENES = {make.__name__: make for make in (bodies, small_sun, window, lamps, blurred_lamps, glasses)}


def write_scene(name, folder):
    """Writes a scene of SCENES with its files into the folder; returns the scene file."""
    os.makedirs(folder, exist_ok=True)
    path = os.path.join(folder, f"{name}.json")
    with open(path, "w", encoding="utf-8") as file:
        json.dump(SCENES[name](folder), file, indent=1)
    return path
