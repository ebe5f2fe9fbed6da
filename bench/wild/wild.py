#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Tells which of other people's OBJ files and images Tessera renders.

Renders every OBJ file and every image below the given folders, small and by itself: an OBJ file as a mesh in
the middle of the image, an image as the texture of a square that emits it. Prints for each file whether it
renders, with which warnings, or why it is refused, and at the end one line of totals.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from collections import Counter

IMAGES = {".bmp", ".exr", ".gif", ".hdr", ".jpeg", ".jpg", ".pfm", ".pgm", ".pic", ".png", ".ppm", ".psd", ".tga",
          ".tif", ".tiff", ".webp"}
WARNING = "tessera: warning: "
ERROR = "tessera: "


def vertices_of(path):
    """The finite positions of an OBJ file."""
    with open(path, "rb") as file:
        data = file.read()
    utf16 = {b"\xff\xfe": "utf-16-le", b"\xfe\xff": "utf-16-be"}.get(data[:2])
    if utf16:
        data = data[2:].decode(utf16, "replace").encode()
    for line in data.replace(b"\\\n", b" ").splitlines():
        words = line.split()
        if words[:1] != [b"v"] or len(words) < 4:
            continue
        try:
            point = [float(word) for word in words[1:4]]
        except ValueError:
            continue
        if all(math.isfinite(x) and abs(x) < 1e15 for x in point):
            yield point


def bounds_of(path):
    """The middle of an OBJ file's vertices and the radius of a sphere around them."""
    low, high = [math.inf] * 3, [-math.inf] * 3
    for point in vertices_of(path):
        low, high = [min(a, b) for a, b in zip(low, point)], [max(a, b) for a, b in zip(high, point)]
    if low[0] == math.inf:
        return [0, 0, 0], 1
    middle = [(a + b) / 2 for a, b in zip(low, high)]
    return middle, math.dist(low, high) / 2 or 1


def scene_of_mesh(path):
    middle, radius = bounds_of(path)
    position = [middle[0] + 1.5 * radius, middle[1] + radius, middle[2] + 2.5 * radius]
    return {
        "camera": {"position": position, "look_at": middle, "vertical_fov_degrees": 45},
        "environment": {"radiance": 0.6},
        "lights": [{"type": "directional", "direction": [-0.5, -1, -0.7], "irradiance": 2}],
        "shapes": [{"type": "mesh", "file": path}],
    }


def scene_of_image(path):
    emission = {"texture": "image"}
    return {
        "camera": {"position": [0.5, 0.5, 1.5], "look_at": [0.5, 0.5, 0]},
        "textures": {"image": {"file": path}},
        "materials": {"shown": {"type": "lambert", "albedo": 0, "emission": emission}},
        "shapes": [{"type": "quad", "corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [0, 1, 0],
                    "material": "shown"}],
    }


def files_below(folders):
    for folder in folders:
        for root, subfolders, names in os.walk(folder):
            subfolders.sort()
            for name in sorted(names):
                suffix = os.path.splitext(name)[1].lower()
                if suffix == ".obj" or suffix in IMAGES:
                    yield os.path.join(root, name), suffix == ".obj"


def render(options, path, is_mesh, folder):
    """What became of the file, and the messages."""
    scene = scene_of_mesh(os.path.abspath(path)) if is_mesh else scene_of_image(os.path.abspath(path))
    scene["render"] = {"width": options.size, "height": options.size, "spp": options.spp}
    scene_path = os.path.join(folder, "scene.json")
    with open(scene_path, "w", encoding="utf-8") as out:
        json.dump(scene, out)
    image = os.path.join(options.images or folder, f"{len(os.listdir(options.images or folder)):05}.png")
    command = [options.tessera, "render", scene_path, "-q", "-o", image]
    try:
        done = subprocess.run(command, stderr=subprocess.PIPE, timeout=options.timeout, check=False)
    except subprocess.TimeoutExpired:
        return "too slow", [f"takes longer than {options.timeout} s"]
    lines = done.stderr.decode("utf-8", "replace").replace(scene_path, "scene.json").splitlines()
    warnings = [line.removeprefix(WARNING) for line in lines if line.startswith(WARNING)]
    if done.returncode == 0:
        return ("renders with warnings" if warnings else "renders"), warnings
    errors = [line.removeprefix(ERROR) for line in lines if not line.startswith(WARNING)]
    return ("refused" if done.returncode == 1 else "crashed"), errors or [f"exit status {done.returncode}"]


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter,
                                     epilog="Exit status: 0, or 1 if a file crashed the program or took too long.")
    parser.add_argument("tessera", help="the program, as build/release/bin/tessera")
    parser.add_argument("folders", nargs="+", metavar="FOLDER", help="where the files are, at any depth")
    parser.add_argument("--size", type=int, default=32, help="width and height in pixels (default: 32)")
    parser.add_argument("--spp", type=int, default=4, help="samples per pixel (default: 4)")
    parser.add_argument("--timeout", type=float, default=120, help="seconds for each file (default: 120)")
    parser.add_argument("--images", metavar="FOLDER", help="keep the rendered images there, numbered in order")
    return parser.parse_args()


def main():
    options = parse_options()
    if options.images:
        os.makedirs(options.images, exist_ok=True)
    totals = {True: Counter(), False: Counter()}
    with tempfile.TemporaryDirectory() as folder:
        for path, is_mesh in files_below(options.folders):
            outcome, messages = render(options, path, is_mesh, folder)
            totals[is_mesh][outcome] += 1
            print(f"{outcome}: {path}")
            for message in messages:
                print(f"    {message}", flush=True)
    for is_mesh, name in ((True, "OBJ files"), (False, "images")):
        counts = totals[is_mesh]
        rendered = counts["renders"] + counts["renders with warnings"]
        print(f"{counts.total()} {name}: {rendered} render ({counts['renders with warnings']} with warnings), "
              f"{counts['refused']} refused, {counts['crashed']} crashed, {counts['too slow']} too slow")
    failed = sum(counts["crashed"] + counts["too slow"] for counts in totals.values())
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
