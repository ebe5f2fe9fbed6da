#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how much light surfaces keep that are shaded with other normals than their own, and prints a table.

    bench/peers/energy.py [--bunny FILE.obj] [--cycles] [--spp N] [--keep FOLDER]

Furnace: a surface that reflects everything, under an even sky of radiance 1, has radiance 1. Field: 25 bodies on a
floor under an even sky and a lamp; the image with interpolated normals is compared with that of flat triangles. The
body is a bumpy ball, and the OBJ file of --bunny too if it is given. --cycles renders the same scenes with Blender's
Cycles. The tessera program is that of the release build, or of the folder TESSERA_BIN.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile

from images import read_pfm, write_png

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TESSERA = os.path.join(os.environ.get("TESSERA_BIN", os.path.join(ROOT, "build/release/bin")), "tessera")
MASK_SPP = 16
WHITE = {"type": "lambert", "albedo": 1}
GLOWING = {"type": "lambert", "albedo": 0, "emission": 1}


def write_ball(path, rows, columns, radius_at=lambda x, y, z: 1):
    """A ball of rows * columns quads, split into triangles; the poles are triangles."""
    with open(path, "w", encoding="utf-8") as out:
        for i in range(rows + 1):
            theta = math.pi * i / rows
            for j in range(columns):
                phi = 2 * math.pi * j / columns
                x, y, z = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
                r = radius_at(x, y, z)
                out.write(f"v {r * x:.7f} {r * y:.7f} {r * z:.7f}\n")
        for i in range(rows):
            for j in range(columns):
                a, b = i * columns + j + 1, i * columns + (j + 1) % columns + 1
                c, d = a + columns, b + columns
                if i > 0:
                    out.write(f"f {a} {b} {d}\n")
                if i + 1 < rows:
                    out.write(f"f {a} {d} {c}\n")


def bumpy(x, y, z):
    return 1 + 0.06 * math.sin(9 * y) * math.sin(7 * x) + 0.02 * math.sin(31 * x) * math.sin(37 * z)


def read_triangles(path):
    """Vertices, scaled to lie in the ball of radius 1, and triangles."""
    vertices, triangles = [], []
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append(tuple(map(float, words[1:4])))
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                triangles += [(corners[0], b, c) for b, c in zip(corners[1:], corners[2:])]
    low, high = ([pick(axis) for axis in zip(*vertices)] for pick in (min, max))
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    scale = 1 / max(math.dist(vertex, middle) for vertex in vertices)
    return [[(c - m) * scale for c, m in zip(v, middle)] for v in vertices], triangles


def write_bodies(path, body, places):
    """Turned and moved copies of the body in one file, as Cycles' scenes have no transforms."""
    vertices, triangles = body
    with open(path, "w", encoding="utf-8") as out:
        for turn, (px, py, pz) in places:
            c, s = math.cos(turn), math.sin(turn)
            out.writelines(f"v {c * x + s * z + px:.7f} {y + py:.7f} {c * z - s * x + pz:.7f}\n" for x, y, z in vertices)
        for n in range(len(places)):
            first = n * len(vertices) + 1
            out.writelines(f"f {a + first} {b + first} {c + first}\n" for a, b, c in triangles)


def write_normal_map(path, slope, side=256):
    """Normals of one slope that lean all ways, a different one in each texel."""
    chance = random.Random(1)
    length = math.hypot(slope, 1)
    rows = []
    for _ in range(side):
        row = b""
        for _ in range(side):
            phi = chance.uniform(0, 2 * math.pi)
            normal = (slope * math.cos(phi) / length, slope * math.sin(phi) / length, 1 / length)
            row += bytes(round(127.5 * (c + 1)) for c in normal)
        rows.append(row)
    write_png(path, side, side, rows)


def scene(camera, materials, shapes, sky=1, **more):
    return {"camera": camera, "materials": materials, "shapes": shapes, "environment": {"radiance": sky}, **more}


def furnaces(folder, bunny):
    """Name, and a function that makes the scene from the surface's material and the sky's radiance."""
    write_ball(os.path.join(folder, "coarse.obj"), 10, 20)
    front = {"position": [0, 0, 6], "look_at": [0, 0, 0], "vertical_fov_degrees": 20}
    bodies = [("ball of 20 x 10 faces", "coarse.obj", front)]
    if bunny:
        write_bodies(os.path.join(folder, "bunny.obj"), bunny, [(0, (0, 0, 0))])
        bodies.append((f"bunny of {len(bunny[1]):,} faces", "bunny.obj", front))
    for name, file, camera in bodies:
        shape = {"type": "mesh", "file": file, "normals": "smooth", "material": "m"}
        yield name, lambda m, sky, camera=camera, shape=shape: scene(camera, {"m": m}, [shape], sky)
    for slope in (0.2, 0.5, 1.0):
        file = f"slope_{slope}.png"
        write_normal_map(os.path.join(folder, file), slope)
        quad = {"type": "quad", "corner": [-1, -1, 0], "edge_u": [2, 0, 0], "edge_v": [0, 2, 0], "material": "m"}
        texture = {"t": {"file": file, "color_space": "linear"}}
        for view, position in (("head-on", [0, 0, 6]), ("at 60 degrees", [5.2, 0, 3])):
            camera = {"position": position, "look_at": [0, 0, 0], "vertical_fov_degrees": 8}
            yield (f"normal map of slope {slope}, {view}",
                   lambda m, sky, camera=camera, texture=texture: scene(
                       camera, {"m": {**m, "normal_map": {"texture": "t"}}}, [quad], sky, textures=texture))


def field(folder, name, body, normals):
    file = f"{name}_field.obj"
    chance = random.Random(2)
    if not os.path.exists(os.path.join(folder, file)):
        places = [(chance.uniform(0, 2 * math.pi), (2.2 * (n % 5 - 2), 0.9, 2.2 * (n // 5 - 2))) for n in range(25)]
        write_bodies(os.path.join(folder, file), body, places)
    camera = {"position": [0, 7, 16], "look_at": [0, 0, 0], "vertical_fov_degrees": 38}
    shapes = [{"type": "mesh", "file": file, "normals": normals, "material": "clay"},
              {"type": "quad", "corner": [-50, 0, 50], "edge_u": [100, 0, 0], "edge_v": [0, 0, -100], "material": "floor"},
              {"type": "sphere", "center": [-9, 14, 5], "radius": 1.5, "material": "lamp"}]
    materials = {"clay": {"type": "lambert", "albedo": 0.7}, "floor": {"type": "lambert", "albedo": 0.5},
                 "lamp": {"type": "lambert", "albedo": 0, "emission": 60}}
    return scene(camera, materials, shapes, 0.8)


class Renderers:
    def __init__(self, folder, options):
        self.folder, self.options = folder, options
        self.names = ["Tessera", "Cycles"] if options.cycles else ["Tessera"]

    def write(self, description):
        path = os.path.join(self.folder, "scene.json")
        with open(path, "w", encoding="utf-8") as file:
            json.dump(description, file)
        return path

    def render(self, name, description, size, spp):
        path, image = self.write(description), os.path.join(self.folder, "image.pfm")
        if name == "Cycles":
            command = ["blender", "--background", "--factory-startup", "--threads", str(self.options.threads),
                       "--python-exit-code", "1", "--python", os.path.join(HERE, "cycles_render.py"), "--", path,
                       *map(str, size), str(spp), "1", image]
        else:
            command = [TESSERA, "render", path, "--size", f"{size[0]}x{size[1]}", "--spp", str(spp), "--threads",
                       str(self.options.threads), "--quiet", "-o", image]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit("\n".join([f"failed: {' '.join(command)}", *(done.stdout + done.stderr).strip().splitlines()[-12:]]))
        return read_pfm(image)[2]


def mean(values, chosen=None):
    chosen = range(0, len(values), 3) if chosen is None else chosen
    return sum(values[i] for i in chosen) / len(chosen)


def report_furnaces(renderers, bunny, spp):
    size = (96, 96)
    print("| white furnace | " + " | ".join(renderers.names) + " |")
    print("| --- |" + " --- |" * len(renderers.names))
    for name, make in furnaces(renderers.folder, bunny):
        glow = renderers.render("Tessera", make(GLOWING, 0), size, MASK_SPP)
        covered = [i for i in range(0, len(glow), 3) if glow[i] > 0.9999]
        cells = [f"{mean(renderers.render(r, make(WHITE, 1), size, spp), covered):.4f}" for r in renderers.names]
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def report_fields(renderers, bodies, spp):
    size = (240, 135)
    print("\n| field: mean of the image | " + " | ".join(f"{r}, {n}" for r in renderers.names for n in ("flat", "smooth")) + " |")
    print("| --- |" + " --- |" * (2 * len(renderers.names)))
    for name, body in bodies:
        cells = []
        for renderer in renderers.names:
            for normals in ("flat", "smooth"):
                image = renderers.render(renderer, field(renderers.folder, name, body, normals), size, spp)
                cells.append(f"{mean(image):.5f}")
        print(f"| {name} | " + " | ".join(cells) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bunny", help="an OBJ file of one body")
    parser.add_argument("--cycles", action="store_true", help="render with Cycles as well")
    parser.add_argument("--spp", type=int, default=256)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", help="a folder for the files, which are kept")
    options = parser.parse_args()
    bunny = read_triangles(options.bunny) if options.bunny else None
    with tempfile.TemporaryDirectory() as temporary:
        folder = options.keep or temporary
        os.makedirs(folder, exist_ok=True)
        write_ball(os.path.join(folder, "bumpy.obj"), 24, 48, bumpy)
        bodies = [("bumpy ball of 2,208 faces", read_triangles(os.path.join(folder, "bumpy.obj")))]
        renderers = Renderers(folder, options)
        report_furnaces(renderers, bunny, options.spp)
        report_fields(renderers, bodies + ([("bunny", bunny)] if bunny else []), options.spp)


main()
