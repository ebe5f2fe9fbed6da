# SPDX-License-Identifier: Apache-2.0
"""Parts of scenes for noise_scenes.py: materials, shapes, meshes and images. Plain Python; the same bytes on every
machine but for the last digits of sines."""

import array
import math
import sys

from images import write_png


def lambert(albedo):
    return {"type": "lambert", "albedo": albedo}


def lamp(emission):
    return {"type": "lambert", "albedo": 0, "emission": emission}


def quad(corner, edge_u, edge_v, material):
    return {"type": "quad", "corner": corner, "edge_u": edge_u, "edge_v": edge_v, "material": material}


def cross(a, b):
    return [a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3] for i in range(3)]


def normalized(v):
    size = math.sqrt(sum(c * c for c in v))
    return [c / size for c in v]


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


def write_surface(path, columns, rows, point_at):
    """The surface point_at(u, v), with u from 0 to 1 around it and v from pole to pole or around it too. It has texture
    coordinates, and smooth normals on the side of its derivative by v times that by u."""
    lines = []
    step = 1e-4

    def normal_at(u, v):
        along_u = [b - a for a, b in zip(point_at(u - step, v), point_at(u + step, v))]
        along_v = [b - a for a, b in zip(point_at(u, v - step), point_at(u, v + step))]
        return normalized(cross(along_v, along_u))

    for i in range(rows + 1):
        for j in range(columns + 1):
            u, v = j / columns, i / rows
            inner_v = min(max(v, 10 * step), 1 - 10 * step)  # poles have no derivative by u
            lines.append("v {:.6f} {:.6f} {:.6f}".format(*point_at(u, v)))
            lines.append(f"vt {u:.6f} {1 - v:.6f}")
            lines.append("vn {:.6f} {:.6f} {:.6f}".format(*normal_at(u, inner_v)))
    for i in range(rows):
        for j in range(columns):
            a, b = 1 + i * (columns + 1) + j, 2 + i * (columns + 1) + j
            d, c = a + columns + 1, b + columns + 1
            for corners, row in (((a, d, c), i + 1), ((a, c, b), i)):
                ends = (point_at((j + k) / columns, row / rows) for k in (0, 1))
                if math.dist(*ends) > 1e-6:  # not at a pole
                    lines.append("f " + " ".join(f"{n}/{n}/{n}" for n in corners))
    with open(path, "w", encoding="ascii") as file:
        file.write("\n".join(lines) + "\n")


def write_texture(path, side, rgb_at):
    """A PNG image of encoded values: rgb_at(u, v) from 0 to 1, with v from the bottom."""
    rows = []
    for row in reversed(range(side)):
        pixels = (rgb_at((column + 0.5) / side, (row + 0.5) / side) for column in range(side))
        rows.append(bytes(round(255 * min(max(value, 0), 1)) for pixel in pixels for value in pixel))
    write_png(path, side, side, rows)


def write_sky(path, to_sun=None, scale=1.0):
    """An image of a hazy sky, with a sun of the size of the real one in the direction `to_sun` if that is given."""
    if to_sun:
        to_sun = normalized(to_sun)
    cos_of_sun = math.cos(math.radians(0.4))

    def sky(u, v):
        longitude, latitude = 2 * math.pi * (u - 0.5), math.pi * (v - 0.5)
        d = (math.cos(latitude) * math.sin(longitude), math.sin(latitude), -math.cos(latitude) * math.cos(longitude))
        if to_sun and sum(a * b for a, b in zip(d, to_sun)) > cos_of_sun:
            return (20000, 18000, 15000)
        if d[1] < 0:
            return (0.1 * scale, 0.09 * scale, 0.08 * scale)
        haze = math.exp(-4 * d[1])
        return ((0.25 + 0.7 * haze) * scale, (0.4 + 0.6 * haze) * scale, (0.8 + 0.3 * haze) * scale)

    write_pfm(path, 1024, 512, sky)


def small_lamps(count, chance, place, radius, materials):
    shapes = []
    for i in range(count):
        hue = chance.random()
        strength = chance.uniform(0.3, 1) * 60
        materials[f"lamp {i}"] = lamp([strength * (0.4 + 0.6 * hue), strength * 0.7, strength * (1 - 0.6 * hue)])
        shapes.append(sphere(place(chance), radius, f"lamp {i}"))
    return shapes


def room_with_window():
    """The walls of a room, 6 wide, 3 high and 8 deep, with a window 2 wide and 1.2 high at x = -3."""
    def wall(corner, u, v):
        return quad(corner, u, v, "wall")

    return [
        quad([-3, 0, 4], [6, 0, 0], [0, 0, -8], "floor"), wall([-3, 3, -4], [6, 0, 0], [0, 0, 8]),
        wall([-3, 0, -4], [6, 0, 0], [0, 3, 0]), wall([3, 0, 4], [-6, 0, 0], [0, 3, 0]),
        wall([3, 0, -4], [0, 0, 8], [0, 3, 0]),
        wall([-3, 0, 4], [0, 0, -8], [0, 0.9, 0]), wall([-3, 2.1, 4], [0, 0, -8], [0, 0.9, 0]),
        wall([-3, 0.9, 4], [0, 0, -4], [0, 1.2, 0]), wall([-3, 0.9, -2], [0, 0, -2], [0, 1.2, 0])]
