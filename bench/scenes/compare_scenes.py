#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares Tessera with the reference images of public scenes.

Takes folders and renders every Mitsuba regression test (test_NAME_INTEGRATOR.xml beside refs/test_NAME_ref_rgb.exr) and
every pbrt scene with a reference (scene*.pbrt beside *Render*.exr) below them. Prints for each whether it renders, how many
parameters are approximated or ignored, the ratio of the means, the relative mean squared error of 8 x 8 regions, the
core-seconds and the samples per core-second. For Mitsuba's tests it also applies a z-test: two-sided, for each pixel and
channel, with the variance of a sample of both images, corrected for their number (Šidák) at 1 %, which 99.75 % must
pass. Our variance is that of the seeds, the mean of 3 x 3 pixels. The last number is the share that passes with the
variance of the reference only, as in Mitsuba's own tests, which also fails where our noise is larger.

  compare_scenes.py --tessera build/release/bin/tessera --out out/scenes ../shared/data/scenes/mitsuba

Writes an image and the report of each scene into --out. Needs numpy. With --strict, the exit status is 1 if a scene does not
render or its mean is off by more than 1 %.
"""
import argparse
import json
import math
import os
import re
import resource
import subprocess
import sys

import numpy

REGIONS = 8
WARNING = "warning: "
SIGNIFICANCE = 0.01
PASSING_SHARE = 0.9975
LEAST_VARIANCE = 1e-4


def read_pfm(path):
    """An array of height x width x 3, from the top."""
    with open(path, "rb") as file:
        kind = file.readline().strip()
        width, height = map(int, file.readline().split())
        scale = float(file.readline())
        data = numpy.frombuffer(file.read(), "<f4" if scale < 0 else ">f4")
    channels = 3 if kind == b"PF" else 1
    image = data.reshape(height, width, channels)[::-1].astype(numpy.float64)
    return numpy.repeat(image, 3, axis=2) if channels == 1 else image


class Tessera:
    def __init__(self, program, out, threads):
        self.program, self.out, self.threads = program, out, threads

    def run(self, *arguments):
        """The exit status, all output and the processor seconds of a command."""
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, check=False)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        return done.returncode, done.stdout + done.stderr, seconds

    def render(self, scene, name, spp, seed):
        """The path of the image, or None; the output; the processor seconds."""
        path = os.path.join(self.out, f"{name}.{seed}.pfm")
        threads = ["--threads", self.threads] if self.threads else []
        status, text, seconds = self.run("render", scene, "-o", path, "--spp", spp, "--seed", seed, *threads)
        return (path if status == 0 else None), text, seconds

    def decoded(self, image):
        """An image of any format as an array: the importer writes textures of floats as PFM."""
        scene, written = (os.path.join(self.out, name) for name in ("reference.json", "decoded.json"))
        with open(scene, "w") as file:
            json.dump({"camera": {"position": [0, 0, 3], "look_at": [0, 0, 0]},
                       "textures": {"image": {"file": os.path.abspath(image)}},
                       "materials": {"lamp": {"type": "lambert", "emission": {"texture": "image"}}},
                       "shapes": [{"type": "sphere", "radius": 1, "material": "lamp"}]}, file)
        status, text, _ = self.run("import", scene, "-o", written)
        if status != 0:
            raise SystemExit(f"{image}: {text}")
        with open(written) as file:
            textures = json.load(file)["textures"]
        return read_pfm(os.path.join(self.out, next(iter(textures.values()))["file"]))


def scenes_below(folder):
    """Scene, reference and variance (or None) of each scene with a reference."""
    for where, folders, files in os.walk(folder):
        folders.sort()
        for name in sorted(files):
            path = os.path.join(where, name)
            test = re.fullmatch(r"(test_.+)_[a-z]+\.xml", name)
            if test:
                reference = os.path.join(where, "refs", test[1] + "_ref_rgb.exr")
                if os.path.exists(reference):
                    yield path, reference, reference.replace("_rgb.exr", "_rgb_var.exr")
            elif name.startswith("scene") and name.endswith(".pbrt"):
                references = [other for other in sorted(files) if other.endswith(".exr") and "Render" in other]
                if references:
                    yield path, os.path.join(where, references[0]), None


def regions_of(image):
    """The means of 8 x 8 regions."""
    rows = numpy.array_split(image, min(REGIONS, image.shape[0]), axis=0)
    return numpy.array([[part.mean(axis=(0, 1)) for part in
                         numpy.array_split(row, min(REGIONS, image.shape[1]), axis=1)] for row in rows])


def reduced(image, shape):
    """The means of blocks of pixels, if the image is a whole number of times as large as `shape`; else the image."""
    down, across = image.shape[0] // shape[0], image.shape[1] // shape[1]
    if down != across or down < 2 or image.shape[0] != down * shape[0] or image.shape[1] != across * shape[1]:
        return image
    return image.reshape(shape[0], down, shape[1], across, 3).mean(axis=(1, 3))


def relative_error(ours, theirs):
    """The mean squared error of regions, relative to the squared reference; regions of hardly any light count less."""
    a, b = regions_of(ours).mean(axis=2), regions_of(theirs).mean(axis=2)
    floor = 0.01 * b.mean()
    return float(numpy.mean(((a - b) / (b + floor)) ** 2))


def mean_of_neighbours(image):
    """The mean of 3 x 3 pixels around each; edges are repeated."""
    padded = numpy.pad(image, ((1, 1), (1, 1), (0, 0)), mode="edge")
    height, width = image.shape[:2]
    return sum(padded[y:y + height, x:x + width] for y in range(3) for x in range(3)) / 9


def variance_of_sample(images, spp):
    """The variance of a sample, from independent images of `spp` samples each."""
    return mean_of_neighbours(numpy.var(images, axis=0, ddof=1)) * spp if len(images) > 1 else 0


def passing_share(ours, samples, theirs, variance):
    """The share of values that pass the z-test, with the variance of a sample of both images."""
    z = numpy.abs(ours - theirs) * numpy.sqrt(samples / numpy.maximum(variance, LEAST_VARIANCE))
    p = numpy.vectorize(math.erfc)(z / math.sqrt(2))
    alpha = 1 - (1 - SIGNIFICANCE) ** (1 / ours.size)
    return float(numpy.mean(p > alpha))


def compare(tessera, scene, reference, variance, options):
    """Prints a row; returns whether the scene renders with the right mean."""
    name = os.path.splitext(os.path.relpath(scene, options.root))[0].replace(os.sep, "-")
    images, seconds, report = [], 0, ""
    for seed in range(options.seeds):
        path, text, spent = tessera.render(scene, name, options.spp, seed)
        if path is None:
            reason = text.strip().splitlines()[-1] if text.strip() else "no message"
            print(f"{name:44} does not render: {reason}")
            return False
        images.append(read_pfm(path))
        seconds += spent
        report = text
    with open(os.path.join(tessera.out, name + ".txt"), "w") as file:
        file.write(report)
    tessera.run("render", scene, "-o", os.path.join(tessera.out, name + ".png"), "--spp", options.spp)
    warnings = sum(WARNING in line for line in report.splitlines())
    ours = numpy.mean(images, axis=0)
    theirs = reduced(tessera.decoded(reference), ours.shape)
    if theirs.shape != ours.shape:
        print(f"{name:44} has the size {ours.shape[1::-1]}, the reference {theirs.shape[1::-1]}")
        return False
    ratio = float(ours.mean() / theirs.mean())
    samples = options.spp * options.seeds * ours.shape[0] * ours.shape[1]
    row = (f"{name:44} {warnings:3} told  mean {ratio:7.4f}  regions {relative_error(ours, theirs):9.2e}  "
           f"{seconds:7.1f} core-s  {samples / seconds:10.3g} samples/s")
    if variance and os.path.exists(variance):
        of_reference, count = tessera.decoded(variance), options.spp * options.seeds
        share = passing_share(ours, count, theirs, of_reference + variance_of_sample(images, options.spp))
        row += f"  z-test {100 * share:6.2f} % {'pass' if share >= PASSING_SHARE else 'FAIL'}"
        row += f", {100 * passing_share(ours, count, theirs, of_reference):6.2f} %"
    print(row, flush=True)
    return abs(ratio - 1) <= 0.01


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--tessera", default="tessera", help="the program")
    parser.add_argument("--out", default="out/scenes", help="the folder of images and reports")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel of each render")
    parser.add_argument("--seeds", type=int, default=4, help="renders of each scene, whose mean is compared")
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--only", default="", help="scenes whose path contains this")
    parser.add_argument("--strict", action="store_true")
    options = parser.parse_args()
    os.makedirs(options.out, exist_ok=True)
    tessera = Tessera(options.tessera, options.out, options.threads)
    rendered = right = 0
    for folder in options.folders:
        options.root = folder
        for scene, reference, variance in scenes_below(folder):
            if options.only not in scene:
                continue
            rendered += 1
            right += compare(tessera, scene, reference, variance, options)
    print(f"{right} of {rendered} scenes render with a mean within 1 % of the reference")
    return 1 if options.strict and right < rendered else 0


if __name__ == "__main__":
    sys.exit(main())
