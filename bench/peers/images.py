# SPDX-License-Identifier: Apache-2.0
"""The noise of images that differ in their seed alone, and how well two renderers agree. Plain Python; PFM and PNG
files."""

import array
import struct
import sys
import zlib


def read_pfm(path):
    """(width, height, values): three floats a pixel, from the bottom row upwards."""
    with open(path, "rb") as file:
        if file.readline().strip() != b"PF":
            raise ValueError(f"{path} is not a PFM image of three channels")
        width, height = map(int, file.readline().split())
        little_endian = float(file.readline()) < 0
        values = array.array("f")
        values.frombytes(file.read())
    if little_endian != (sys.byteorder == "little"):
        values.byteswap()
    return width, height, values


def write_png(path, width, height, rows):
    """Rows of three bytes a pixel, from the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    pixels = b"".join(b"\0" + row for row in rows)
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)))
        file.write(chunk(b"IDAT", zlib.compress(pixels, 1)) + chunk(b"IEND", b""))


def write_side_by_side(path, first, second, width, height):
    """Both images in one PNG file, equally exposed: a tenth of the values of the first is white."""
    white = sorted(first)[len(first) * 9 // 10] or 1.0

    def encoded(value):
        share = min(max(value / white, 0.0), 1.0)
        return round(255 * (12.92 * share if share <= 0.0031308 else 1.055 * share ** (1 / 2.4) - 0.055))

    rows = []
    for y in reversed(range(height)):
        line = slice(3 * y * width, 3 * (y + 1) * width)
        rows.append(bytes(map(encoded, first[line])) + bytes(12) + bytes(map(encoded, second[line])))
    write_png(path, 2 * width + 4, height, rows)


def mean_image(images):
    count = len(images)
    return array.array("f", (sum(values) / count for values in zip(*images)))


def noise(images, expected):
    """(MSE, relative MSE) of one image of several with independent seeds: the mean of the values' sample variance,
    for two images a and b (a-b)^2 / 2, and of it over the square of the value to expect plus 0.01."""
    if len(images) < 2:
        raise ValueError("noise needs two images")
    total = relative = 0.0
    for value, *samples in zip(expected, *images):
        mean = sum(samples) / len(samples)
        variance = sum((sample - mean) ** 2 for sample in samples) / (len(samples) - 1)
        total += variance
        relative += variance / (value * value + 0.01)
    return total / len(expected), relative / len(expected)


def region_ratios(first, second, width, height, side=8):
    """Means of the second over the first, of the image and of each of side * side regions that is not black."""

    def mean_of(values, column, row):
        total = 0.0
        for y in range(row * height // side, (row + 1) * height // side):
            begin = y * width + column * width // side
            total += sum(values[3 * begin : 3 * (y * width + (column + 1) * width // side)])
        return total

    ratios = []
    for row in range(side):
        for column in range(side):
            divisor = mean_of(first, column, row)
            if divisor > 0:
                ratios.append(mean_of(second, column, row) / divisor)
    return sum(second) / sum(first), ratios
