# SPDX-License-Identifier: Apache-2.0
"""The noise of images that differ in their seed alone, and how well two renderers agree. Plain Python; PFM files."""

import array
import sys


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
