#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Renders scenes with Cycles and with Tessera, interleaved on one core, and prints tables of both as Markdown.

Needs Blender (Debian's 3.4.1: apt install blender) and a release build with -DTESSERA_BENCH=ON whose targets tessera,
scene_files and tessera_peer_files are built. docs/notebook/peers.md says what is compared, and how.

  compare.py --size 0.5 --spp 32 --runs 2          all scenes in some ten minutes
  compare.py --images DIR principled               one scene; DIR gets the images, and both side by side in a PNG file
"""

import argparse
import json
import math
import os
import shutil
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field

import noise_scenes
from images import mean_image, noise, read_pfm, region_ratios, write_side_by_side

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
BIN = os.environ.get("TESSERA_BIN", os.path.join(ROOT, "build/profiled/bin"))
TESSERA = os.path.join(BIN, "tessera")
SCENES_FOLDER = os.path.join(os.path.dirname(BIN), "share/tessera/scenes")


class Failed(Exception):
    pass


@dataclass(frozen=True)
class Scene:
    """A scene file of the build folder, and a file that it needs of the target tessera_peer_files."""

    name: str
    file: str
    width: int
    height: int
    generated: str = ""

    def write(self, _folder):
        """The scene file's path."""
        path = os.path.join(SCENES_FOLDER, self.file)
        needed = os.path.join(os.path.dirname(path), self.generated) if self.generated else path
        if not os.path.exists(needed):
            raise Failed(f"there is no {needed}; 'cmake --build build/profiled --target scene_files "
                         "tessera_peer_files' makes it")
        return path


@dataclass(frozen=True)
class NoiseScene:
    """A scene of noise_scenes.py, which is written when it is needed."""

    name: str
    width: int = 480
    height: int = 360

    def write(self, folder):
        return noise_scenes.write_scene(self.name, os.path.join(folder, self.name))


SCENES = [
    Scene("cornell", "cornell/scene.json", 512, 512),
    Scene("veach_mis", "veach_mis/scene.json", 768, 512),
    Scene("go", "go/scene.json", 832, 512),
    Scene("glass_and_water", "glass_and_water/fresnel.json", 640, 480),
    Scene("field", "peers/field/scene.json", 960, 540, "generated/blobs.obj"),
    Scene("strands", "peers/strands/scene.json", 480, 360, "generated/strands.obj"),
    Scene("strand_curves", "peers/strands/curves.json", 480, 360, "generated/strands.ply"),
    *map(NoiseScene, noise_scenes.SCENES),
]


@dataclass
class Measured:
    """What one renderer made of one scene, run by run."""

    core_seconds: list = field(default_factory=list)
    images: list = field(default_factory=list)


def run_pinned(command, core):
    """Output of a command that has one core of the machine."""
    done = subprocess.run(command, capture_output=True, text=True, preexec_fn=lambda: os.sched_setaffinity(0, {core}))
    if done.returncode != 0:
        output = (done.stdout + done.stderr).strip().splitlines()
        raise Failed("\n".join([f"failed: {' '.join(command)}", *output[-12:]]))
    return done.stdout


def render_with_cycles(path, size, spp, seed, image, core):
    script = os.path.join(HERE, "cycles_render.py")
    output = run_pinned(
        ["blender", "--background", "--factory-startup", "--threads", "1", "--python-exit-code", "1", "--python", script,
         "--", path, str(size[0]), str(size[1]), str(spp), str(seed), image], core)
    line = next(line for line in output.splitlines() if line.startswith("CYCLES "))
    return json.loads(line.removeprefix("CYCLES "))["core_seconds"]


def render_with_tessera(path, size, spp, seed, image, core):
    stats = image + ".json"
    run_pinned([TESSERA, "render", path, "--size", f"{size[0]}x{size[1]}", "--spp", str(spp), "--seed", str(seed),
                "--threads", "1", "--quiet", "-o", image, "--stats", stats], core)
    with open(stats, encoding="utf-8") as file:
        return json.load(file)["render_core_seconds"]


RENDERERS = {"Cycles": render_with_cycles, "Tessera": render_with_tessera}


def measure(scene, size, options, folder):
    """Each renderer's runs of the scene, interleaved."""
    path = scene.write(folder)
    results = {name: Measured() for name in RENDERERS}
    for seed in range(1, options.runs + 1):
        for name, render in RENDERERS.items():
            image = os.path.join(folder, f"{scene.name}_{name.lower()}_{seed}.pfm")
            seconds = render(path, size, options.spp, seed, image, options.core)
            width, height, values = read_pfm(image)
            if (width, height) != size:
                raise Failed(f"{image} has {width}x{height} pixels instead of {size[0]}x{size[1]}")
            results[name].core_seconds.append(seconds)
            results[name].images.append(values)
            print(f"{scene.name}: {name}, run {seed} of {options.runs}: {seconds:.2f} core seconds", file=sys.stderr)
    return results


def summarize(scene, size, spp, results):
    """The numbers of one scene, by renderer, and the agreement of the two."""
    means = {name: mean_image(result.images) for name, result in results.items()}
    expected = mean_image(list(means.values()))
    summary = {"scene": scene.name, "width": size[0], "height": size[1], "spp": spp}
    for name, result in results.items():
        seconds = statistics.median(result.core_seconds)
        mse, relative_mse = noise(result.images, expected)
        summary[name] = {"core_seconds": seconds, "samples_per_second": size[0] * size[1] * spp / seconds, "mse": mse,
                         "relative_mse": relative_mse, "efficiency": 1 / (mse * seconds),
                         "relative_efficiency": 1 / (relative_mse * seconds)}
    ratio, regions = region_ratios(means["Cycles"], means["Tessera"], *size)
    summary["brightness"] = {"mean": ratio, "regions": sorted(regions)}
    return summary


COLUMNS = ("samples_per_second", "relative_mse", "efficiency", "relative_efficiency")


def advantage(summary, column):
    """By which factor Tessera is better."""
    cycles, tessera = summary["Cycles"][column], summary["Tessera"][column]
    return cycles / tessera if column == "relative_mse" else tessera / cycles


def cells(summary):
    """The table's cells of one scene: of each column Cycles' number, Tessera's, and by which factor that is better."""
    row = [f"{summary['scene']}, {summary['width']} × {summary['height']}"]
    for column in COLUMNS:
        unit, digits = (1e6, ".2f") if column == "samples_per_second" else (1, ".3g")
        suffix = " M" if unit > 1 else ""
        row += [f"{summary[name][column] / unit:{digits}}{suffix}" for name in RENDERERS]
        row.append(f"**{advantage(summary, column):.2f}**")
    return row


MEANS = {"geometric mean": lambda values: math.exp(statistics.mean(map(math.log, values))), "median": statistics.median,
         "least": min}


def cells_of_all(name, summaries):
    row = [f"{name} of {len(summaries)}"]
    for column in COLUMNS:
        row += ["", "", f"**{MEANS[name]([advantage(summary, column) for summary in summaries]):.2f}**"]
    return row


def table(summaries, spp):
    head = ["scene"]
    for title in ("samples/s of a core", f"relative MSE at {spp} spp", "1/(MSE × core-seconds)",
                  "1/(relative MSE × core-seconds)"):
        head += [f"{title}: Cycles", "Tessera", "better by"]
    lines = [head, ["---"] * len(head)] + [cells(summary) for summary in summaries]
    if len(summaries) > 1:
        lines += [cells_of_all(name, summaries) for name in MEANS]
    text = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    return text + "\n\n" + agreement(summaries)


def agreement(summaries):
    lines = ["| scene | brightness, Tessera's over Cycles' | of the 64 regions of the image, all but the outermost 3 on either side |",
             "|---|---|---|"]
    for summary in summaries:
        ratios = summary["brightness"]["regions"]
        inner = ratios[3:-3] if len(ratios) > 6 else ratios
        lines.append(f"| {summary['scene']} | {summary['brightness']['mean']:.3f} | {inner[0]:.3f} to {inner[-1]:.3f} |")
    return "\n".join(lines)


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenes", metavar="SCENE", nargs="*", help="of " + ", ".join(s.name for s in SCENES) + " [all]")
    parser.add_argument("--size", type=float, default=1, help="of the images, as a factor of their sides [1]")
    parser.add_argument("--runs", type=int, default=4, help="of each renderer, with different seeds; at least 2 [4]")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel; at least 2 [64]")
    parser.add_argument("--core", type=int, default=max(os.sched_getaffinity(0)), help="to run on [the last]")
    parser.add_argument("--images", metavar="DIR", help="keep the images there, and pairs as NAME.png: Cycles, Tessera")
    parser.add_argument("--output", metavar="FILE", help="write the tables there too")
    parser.add_argument("--json", metavar="FILE", help="write the numbers there")
    options = parser.parse_args()
    unknown = set(options.scenes) - {scene.name for scene in SCENES}
    if unknown or options.runs < 2 or options.spp < 2 or options.size <= 0:
        parser.error(f"there is no scene '{sorted(unknown)[0]}'" if unknown else
                     "--runs and --spp must be at least 2, and --size above 0")
    return options


def check_requirements():
    if not shutil.which("blender"):
        raise Failed("there is no blender to compare with; 'apt install blender' installs it on Debian")
    if not os.access(TESSERA, os.X_OK):
        raise Failed(f"there is no {TESSERA}; build it (./run.sh does), or say in which folder it is with TESSERA_BIN")


def compare_scene(scene, options, folder):
    size = (round(scene.width * options.size), round(scene.height * options.size))
    results = measure(scene, size, options, folder)
    if options.images:
        pair = [mean_image(results[name].images) for name in RENDERERS]
        write_side_by_side(os.path.join(folder, f"{scene.name}.png"), *pair, *size)
    return summarize(scene, size, options.spp, results)


def compare(options):
    check_requirements()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.images or scratch
        os.makedirs(folder, exist_ok=True)
        chosen = [scene for scene in SCENES if not options.scenes or scene.name in options.scenes]
        summaries = [compare_scene(scene, options, folder) for scene in chosen]
    text = table(summaries, options.spp)
    print(text)
    if options.output:
        with open(options.output, "w", encoding="utf-8") as file:
            file.write(text + "\n")
    if options.json:
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(summaries, file, indent=2)


def main():
    try:
        compare(parse_options())
    except Failed as failure:
        sys.exit(f"compare.py: {failure}")


if __name__ == "__main__":
    main()
