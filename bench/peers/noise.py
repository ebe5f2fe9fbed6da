#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Compares the noise and the cost of two builds of Tessera on scenes of noise_scenes.py, or on scene files.

  noise.py --old FOLDER/bin/tessera --new build/release/bin/tessera [SCENE...]

Renders each scene with each program and several seeds on one thread, and prints a table: relative MSE and MSE of both at equal
samples, from the variance between seeds; instructions of a sample (or CPU seconds, where no counter is available), and
efficiency, which is 1 / (error x cost), as the ratio of new over old. With one program only, prints its numbers. Means that
differ by more than four standard errors are told: a build must change noise, not the image.
"""

import argparse
import math
import os
import resource
import subprocess
import sys
import tempfile

from noise_scenes import SCENES, write_scene
from images import mean_image, noise, read_pfm


class Failed(Exception):
    pass


def run(command):
    """Runs a command on one thread; its processor seconds."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        raise Failed("\n".join([f"failed: {' '.join(command)}", *(done.stdout + done.stderr).strip().splitlines()[-12:]]))
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def instructions_of(command, folder):
    """The instructions of a command, or None where processors or kernels do not count them."""
    counts = os.path.join(folder, "counts")
    try:
        run(["perf", "stat", "-x", ",", "-e", "instructions:u", "-o", counts, "--", *command])
    except (Failed, FileNotFoundError):
        return None
    with open(counts, encoding="utf-8") as file:
        for line in file:
            fields = line.split(",")
            if len(fields) > 2 and fields[2].startswith("instructions") and fields[0].isdigit():
                return int(fields[0])
    return None


def measure(program, scene, name, options, folder):
    """(images, cost) of one program: the cost of the first render's samples, without loading the scene."""
    images, costs = [], []

    def command(spp, seed, path):
        return [program, "render", scene, "--size", options.size, "--spp", str(spp), "--seed", str(seed), "--threads", "1",
                "--quiet", "-o", path]

    for seed in range(1, options.runs + 1):
        path = os.path.join(folder, f"{name}_{seed}.pfm")
        costs.append(run(command(options.spp, seed, path)))
        images.append(read_pfm(path)[2])
    most, least = (instructions_of(command(spp, 1, os.path.join(folder, "counted.pfm")), folder) for spp in (9, 1))
    if most and least:
        return images, (most - least) / 8
    return images, sorted(costs)[len(costs) // 2]


def different_means(a, b):
    """By how many standard errors the mean of two sets of images differs."""
    def mean_and_error2(images):
        means = [sum(image) / len(image) for image in images]
        mean = sum(means) / len(means)
        return mean, sum((m - mean) ** 2 for m in means) / (len(means) - 1) / len(means)

    (mean_a, error_a), (mean_b, error_b) = mean_and_error2(a), mean_and_error2(b)
    return abs(mean_a - mean_b) / math.sqrt(error_a + error_b + 1e-30)


def row_of(name, results):
    expected = mean_image([image for images, _ in results for image in images])
    errors = [noise(images, expected) for images, _ in results]
    cells = [name] + [f"{relative:.4g}" for _, relative in errors] + [f"{mse:.4g}" for mse, _ in errors]
    if len(results) == 2:
        (mse_old, relative_old), (mse_new, relative_new) = errors
        cost = results[1][1] / results[0][1]
        cells += [f"{cost:.3f}", f"**{relative_old / relative_new / cost:.2f}**", f"{mse_old / mse_new / cost:.2f}"]
        apart = different_means(results[0][0], results[1][0])
        if apart > 4:
            print(f"{name}: the means differ by {apart:.1f} standard errors", file=sys.stderr)
    return "| " + " | ".join(cells) + " |"


def compare(options):
    programs = [program for program in (options.old, options.new) if program]
    titles = ["scene", *(f"relative MSE, {p}" for p in ("old", "new")[-len(programs):]),
              *(f"MSE, {p}" for p in ("old", "new")[-len(programs):])]
    if len(programs) == 2:
        titles += ["cost, new over old", "efficiency by relative MSE", "efficiency by MSE"]
    print("| " + " | ".join(titles) + " |\n" + "|---" * len(titles) + "|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        for name in options.scenes or SCENES:
            scene = write_scene(name, folder) if name in SCENES else os.path.abspath(name)
            results = [measure(program, scene, str(i), options, folder) for i, program in enumerate(programs)]
            print(row_of(os.path.basename(name), results), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", metavar="SCENE", nargs="*", help=f"of {', '.join(SCENES)}, or a file [all of these]")
    parser.add_argument("--old", help="the program to compare with")
    parser.add_argument("--new", required=True, help="the program")
    parser.add_argument("--size", default="160x120", help="of the images [160x120]")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel [64]")
    parser.add_argument("--runs", type=int, default=4, help="seeds of each; at least 2 [4]")
    options = parser.parse_args()
    try:
        compare(options)
    except Failed as failure:
        sys.exit(f"noise.py: {failure}")


if __name__ == "__main__":
    main()
