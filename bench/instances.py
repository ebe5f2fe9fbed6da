#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Time and memory of a scene of many instances: writes one, renders it small, and prints both.

    bench/instances.py build/profiled/bin/tessera [INSTANCES [FOLDER [RENDER OPTION ...]]]

Ten thousand instances if no number is given, of a bumpy body of 69,000 triangles. The files go to FOLDER, or to
a temporary one.
"""
import json
import math
import os
import random
import resource
import subprocess
import sys
import tempfile
import time

ROWS = 132


def write_body(path):
    columns = 2 * ROWS
    with open(path, "w") as out:
        for i in range(ROWS + 1):
            theta = math.pi * i / ROWS
            for j in range(columns):
                phi = 2 * math.pi * j / columns
                x, y, z = math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)
                r = 1 + 0.06 * math.sin(9 * y) * math.sin(7 * x) + 0.02 * math.sin(31 * x) * math.sin(37 * z)
                out.write(f"v {r * x:.6f} {r * y:.6f} {r * z:.6f}\n")

        def vertex(i, j):
            return i * columns + j % columns + 1

        for i in range(ROWS):
            for j in range(columns):
                if i > 0:
                    out.write(f"f {vertex(i, j)} {vertex(i, j + 1)} {vertex(i + 1, j + 1)}\n")
                if i + 1 < ROWS:
                    out.write(f"f {vertex(i, j)} {vertex(i + 1, j + 1)} {vertex(i + 1, j)}\n")


def instance(number, side, chance):
    place = [2.4 * (number % side - side / 2), 1, 2.4 * (number // side - side / 2)]
    axis = [chance.uniform(-1, 1), 1, chance.uniform(-1, 1)]
    steps = [{"scale": round(chance.uniform(0.7, 1.1), 3)},
             {"rotate": {"axis": [round(c, 3) for c in axis], "degrees": round(chance.uniform(0, 360), 1)}},
             {"translate": [round(c, 3) for c in place]}]
    return {"type": "instance", "object": "body", "transform": steps}


def write_scene(path, instances):
    side = math.ceil(math.sqrt(instances))
    half = 1.2 * side
    chance = random.Random(1)
    ground = {"type": "quad", "corner": [-2 * half, 0, 2 * half], "edge_u": [4 * half, 0, 0],
              "edge_v": [0, 0, -4 * half], "material": "clay"}
    scene = {
        "render": {"width": 640, "height": 360, "spp": 4},
        "camera": {"position": [0.1 * half, 12, 1.1 * half], "look_at": [0, 0, 0.7 * half]},
        "materials": {"clay": {"type": "lambert", "albedo": [0.7, 0.6, 0.5]}},
        "objects": {"body": {"shapes": [{"type": "mesh", "file": "body.obj", "material": "clay"}]}},
        "shapes": [ground] + [instance(i, side, chance) for i in range(instances)],
        "environment": {"radiance": [1, 1, 1]},
    }
    with open(path, "w") as out:
        json.dump(scene, out)


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    tessera, instances = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 10000
    folder = sys.argv[3] if len(sys.argv) > 3 else tempfile.mkdtemp()
    os.makedirs(folder, exist_ok=True)
    write_body(os.path.join(folder, "body.obj"))
    scene = os.path.join(folder, "instances.json")
    write_scene(scene, instances)
    begin = time.time()
    subprocess.run([tessera, "render", scene, "-o", os.path.join(folder, "instances.png"), *sys.argv[4:]],
                   check=True)
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    triangles = instances * 2 * 2 * ROWS * (ROWS - 1)
    print(f"{instances:,} instances, {triangles / 1e6:,.0f} million triangles, "
          f"scene file {os.path.getsize(scene) / 1e6:.1f} MB: {time.time() - begin:.1f} s "
          f"({usage.ru_utime:.1f} s of CPU), peak {usage.ru_maxrss / 1024:.0f} MiB")


if __name__ == "__main__":
    main()
