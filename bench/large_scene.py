#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Load, build and memory of a scene of many triangles: writes one, renders it small, and prints a table.

    bench/large_scene.py build/profiled/bin/tessera [TRIANGLES [FOLDER [RENDER OPTION ...]]]

Ten million triangles if no number is given. The files go to FOLDER, where they are used again, or to a
temporary one. The mesh is a bumpy sheet without normals and texture coordinates: those are computed and left
out, in turn, as the scene file asks.
"""
import json
import math
import os
import subprocess
import sys
import tempfile

SCENE = """{
  "render": {"width": 320, "height": 180, "spp": 4},
  "camera": {"position": [0, 3, 8], "look_at": [0, 0, 0], "vertical_fov_degrees": 45},
  "materials": {"clay": {"type": "lambert", "albedo": [0.7, 0.6, 0.5]}},
  "shapes": [{"type": "mesh", "file": "sheet.obj", "material": "clay", "normals": "%s"}],
  "environment": {"radiance": [1, 1, 1]}
}
"""


def write_sheet(path, triangles):
    side = math.ceil(math.sqrt(triangles / 2))
    with open(path + ".new", "w") as out:
        for i in range(side + 1):
            x = i / side
            wave = 0.05 * math.sin(40 * x)
            out.writelines(
                f"v {10 * x - 5:.6f} {wave * math.sin(50 * j / side):.6f} {10 * j / side - 5:.6f}\n"
                for j in range(side + 1))
        for i in range(side):
            first = i * (side + 1) + 1
            out.writelines(
                f"f {a} {a + 1} {a + side + 2}\nf {a} {a + side + 2} {a + side + 1}\n"
                for a in range(first, first + side))
    os.rename(path + ".new", path)


def render(program, folder, normals, options):
    scene = os.path.join(folder, f"{normals}.json")
    with open(scene, "w") as out:
        out.write(SCENE % normals)
    stats = os.path.join(folder, "stats.json")
    subprocess.run([program, "render", scene, "-o", os.path.join(folder, "out.png"), "--stats", stats, "-q",
                    *options], check=True)
    with open(stats) as file:
        return json.load(file)


def main():
    program = sys.argv[1]
    triangles = int(sys.argv[2]) if len(sys.argv) > 2 else 10_000_000
    with tempfile.TemporaryDirectory() as temporary:
        folder = sys.argv[3] if len(sys.argv) > 3 else temporary
        os.makedirs(folder, exist_ok=True)
        sheet = os.path.join(folder, "sheet.obj")
        if not os.path.exists(sheet):
            write_sheet(sheet, triangles)
        megabytes = os.path.getsize(sheet) / 1e6
        print(f"{triangles} triangles, {megabytes:.0f} MB of text")
        print("| normals | load s | MB/s | build s | peak MiB | bytes a triangle |")
        print("|---|---|---|---|---|---|")
        for normals in ("flat", "smooth"):
            stats = render(program, folder, normals, sys.argv[4:])
            peak = stats["peak_memory_bytes"]
            print(f"| {normals} | {stats['load_seconds']:.2f} | {megabytes / stats['load_seconds']:.0f} "
                  f"| {stats['build_seconds']:.2f} | {peak / 2**20:.0f} | {peak / triangles:.0f} |")


if __name__ == "__main__":
    main()
