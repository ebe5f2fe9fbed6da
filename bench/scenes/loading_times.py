#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Measures how long large scene files take to be read.

Generates one height field in each format, as large as --megabytes says, and prints for each the processor seconds and the
peak memory of reading it: by 'tessera info', and by pbrt and Mitsuba where they are given. The two render an image of one
pixel with one sample, since they cannot read a file alone; so their figures include building their trees.

  loading_times.py --tessera build/release/bin/tessera --out out/loading
  loading_times.py --tessera build/release/bin/tessera --pbrt pbrt --mitsuba mitsuba --runs 5

Of several runs, the least processor time counts. Files in --out are kept, and generated once.
"""
import argparse
import array
import json
import math
import multiprocessing
import os
import struct
import subprocess
import sys

# Bytes of a vertex with its two triangles, about.
BYTES_OF_VERTEX = {"glb": 48, "ply": 38, "obj": 78, "pbrt": 74}
MEGA = 1_000_000
CHUNK = 300_000  # numbers, a multiple of 3


def height_field(side):
    """The coordinates of side * side vertices, and the corners of the triangles between them."""
    axis = [2 * i / (side - 1) - 1 for i in range(side)]
    waves = [0.2 * math.sin(9 * x) for x in axis]
    vertices = array.array("f")
    for z in axis:
        height = math.cos(7 * z)
        for x, wave in zip(axis, waves):
            vertices.extend((x, wave * height, z))
    triangles = array.array("I")
    for row in range(side - 1):
        for corner in range(row * side, row * side + side - 1):
            below = corner + side
            triangles.extend((corner, below, corner + 1, corner + 1, below, below + 1))
    return vertices, triangles


def write_rows(file, numbers, form):
    for begin in range(0, len(numbers), CHUNK):
        part = tuple(numbers[begin : begin + CHUNK])
        file.write(form * (len(part) // 3) % part)


def write_obj(path, vertices, triangles):
    with open(path, "w", encoding="ascii") as file:
        write_rows(file, vertices, "v %.6f %.6f %.6f\n")
        write_rows(file, array.array("I", [corner + 1 for corner in triangles]), "f %d %d %d\n")


def write_pbrt(path, vertices, triangles):
    with open(path, "w", encoding="ascii") as file:
        file.write('LookAt 0 2 4  0 0 0  0 1 0\nCamera "perspective" "float fov" 40\n')
        file.write('Film "rgb" "integer xresolution" 1 "integer yresolution" 1 "string filename" "loading.exr"\n')
        file.write('Sampler "independent" "integer pixelsamples" 1\nWorldBegin\nLightSource "infinite"\n')
        file.write('Shape "trianglemesh" "point3 P" [\n')
        write_rows(file, vertices, "%.6f %.6f %.6f\n")
        file.write('] "integer indices" [\n')
        write_rows(file, triangles, "%d %d %d\n")
        file.write("]\n")


def write_ply(path, vertices, triangles):
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % (len(vertices) // 3))
        file.write(b"property float x\nproperty float y\nproperty float z\nelement face %d\n" % (len(triangles) // 3))
        file.write(b"property list uchar uint vertex_indices\nend_header\n")
        file.write(vertices.tobytes())
        for begin in range(0, len(triangles), CHUNK):
            part = triangles[begin : begin + CHUNK]
            faces = [number for i in range(0, len(part), 3) for number in (3, *part[i : i + 3])]
            file.write(struct.pack("<" + "BIII" * (len(part) // 3), *faces))


def write_glb(path, vertices, triangles):
    count = len(vertices) // 3
    normals = array.array("f", (0, 1, 0)) * count
    parts = [vertices.tobytes(), normals.tobytes(), triangles.tobytes()]
    offsets = [0, len(parts[0]), len(parts[0]) + len(parts[1])]
    accessor = {"componentType": 5126, "type": "VEC3", "count": count}
    document = {
        "asset": {"version": "2.0"},
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "buffers": [{"byteLength": sum(map(len, parts))}],
        "bufferViews": [{"buffer": 0, "byteOffset": at, "byteLength": len(part)} for at, part in zip(offsets, parts)],
        "accessors": [
            {"bufferView": 0, **accessor, "min": [-1, -1, -1], "max": [1, 1, 1]},
            {"bufferView": 1, **accessor},
            {"bufferView": 2, "componentType": 5125, "type": "SCALAR", "count": len(triangles)},
        ],
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    with open(path, "wb") as file:
        file.write(struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)))
        file.write(struct.pack("<I4s", len(text), b"JSON") + text)
        file.write(struct.pack("<I4s", len(binary), b"BIN\0") + binary)


def write_mitsuba_scene(path, mesh):
    with open(path, "w", encoding="ascii") as file:
        file.write(f"""<scene version="3.0.0">
<integrator type="path"/>
<sensor type="perspective"><transform name="to_world"><lookat origin="0, 2, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="1"/><integer name="height" value="1"/></film>
<sampler type="independent"><integer name="sample_count" value="1"/></sampler></sensor>
<emitter type="constant"/>
<shape type="{mesh.rsplit('.', 1)[1]}"><string name="filename" value="{mesh}"/></shape>
</scene>
""")


WRITERS = {"glb": write_glb, "ply": write_ply, "obj": write_obj, "pbrt": write_pbrt}


def write(path, kind, megabytes):
    side = max(2, int((megabytes * MEGA / BYTES_OF_VERTEX[kind]) ** 0.5))
    WRITERS[kind](path + ".new", *height_field(side))
    os.replace(path + ".new", path)


def generate(folder, kind, megabytes):
    path = os.path.join(folder, f"field{megabytes}.{kind}")
    if not os.path.exists(path):
        # In a process of its own: the peak memory of a program is at least that of the process that starts it.
        writer = multiprocessing.Process(target=write, args=(path, kind, megabytes))
        writer.start()
        writer.join()
        if writer.exitcode != 0:
            sys.exit(f"{path} could not be written")
    return path


def measure(command, folder):
    """Processor seconds and peak memory in MB; None if the command fails."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        return None
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000


def best_of(command, folder, runs):
    measured = [measure(command, folder) for _ in range(runs)]
    return None if None in measured else min(measured)


def commands_for(options, kind, path):
    """The commands that read the file, by the program's name."""
    commands = {"tessera": [options.tessera, "info", path]}
    if options.pbrt and kind == "pbrt":
        commands["pbrt"] = [options.pbrt, "--quiet", "--nthreads", "1", path]
    if options.mitsuba and kind in ("ply", "obj"):
        scene = path + ".xml"
        write_mitsuba_scene(scene, os.path.basename(path))
        commands["Mitsuba"] = [options.mitsuba, "-m", "scalar_rgb", "-t", "1", "-o", "loading.exr", scene]
    return commands


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tessera", required=True)
    parser.add_argument("--pbrt")
    parser.add_argument("--mitsuba")
    parser.add_argument("--out", default="out/loading")
    parser.add_argument("--megabytes", type=int, default=100)
    parser.add_argument("--runs", type=int, default=3)
    options = parser.parse_args()
    options.tessera = os.path.abspath(options.tessera)
    folder = os.path.abspath(options.out)
    os.makedirs(folder, exist_ok=True)
    print("| file | size (MB) | program | processor time (s) | peak memory (MB) |\n|---|---|---|---|---|")
    failed = False
    for kind in WRITERS:
        path = generate(folder, kind, options.megabytes)
        size = os.path.getsize(path) / MEGA
        for program, command in commands_for(options, kind, path).items():
            best = best_of(command, folder, options.runs)
            failed |= best is None
            figures = "failed | " if best is None else f"{best[0]:.2f} | {best[1]:.0f}"
            print(f"| `.{kind}` | {size:.0f} | {program} | {figures} |", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
