# SPDX-License-Identifier: Apache-2.0
"""Renders a Tessera scene file with Cycles and prints how long the samples took, as one line of JSON.

blender --background --factory-startup --threads 1 --python-exit-code 1 --python cycles_render.py --
        SCENE WIDTH HEIGHT SPP SEED IMAGE.pfm
"""

import array
import json
import os
import sys
import time

import bpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from cycles_scene import SceneBuilder  # noqa: E402


def settings():
    """Nothing that biases the image or shapes its noise afterwards; paths as deep as Cycles allows."""
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.use_persistent_data = True
    scene.render.film_transparent = False
    scene.view_settings.view_transform = "Raw"
    image = scene.render.image_settings
    image.file_format, image.color_depth, image.exr_codec, image.color_mode = "OPEN_EXR", "32", "NONE", "RGB"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = False
    cycles.use_adaptive_sampling = False
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    cycles.caustics_reflective = cycles.caustics_refractive = True
    cycles.pixel_filter_type = "BOX"
    cycles.film_exposure = 1
    for kind in ("max", "diffuse", "glossy", "transmission", "transparent_max"):
        setattr(cycles, kind + "_bounces", 1024)
    scene.cycles_curves.shape = "THICK"
    return cycles


def render(cycles, spp, seed):
    """CPU seconds of all threads, those that go by before the first sample among them."""
    cycles.samples, cycles.seed = spp, seed
    bpy.context.scene.update_tag()  # else a scene that stays in place keeps its settings as well
    begin = time.process_time()
    bpy.ops.render.render()
    return time.process_time() - begin


def write_pfm(path):
    """The image of the last render, by way of a file, as Blender gives out the floats of no other."""
    exr = path + ".exr"
    bpy.data.images["Render Result"].save_render(exr)
    image = bpy.data.images.load(exr)
    image.colorspace_settings.name = "Non-Color"
    width, height = image.size
    values = array.array("f", bytes(4 * width * height * image.channels))
    image.pixels.foreach_get(values)
    pixels = array.array("f", bytes(4 * width * height * 3))
    for channel in range(3):
        pixels[channel::3] = values[channel :: image.channels]
    with open(path, "wb") as file:
        file.write(f"PF\n{width} {height}\n-1.0\n".encode())
        pixels.tofile(file)
    os.remove(exr)


def main():
    arguments = sys.argv[sys.argv.index("--") + 1 :]
    scene, (width, height, spp, seed), path = arguments[0], map(int, arguments[1:5]), arguments[5]
    cycles = settings()
    SceneBuilder(scene).build(width, height)
    render(cycles, 1, seed)  # builds what further renders find in place
    one = render(cycles, 1, seed)
    seconds = (render(cycles, spp, seed) - one) * spp / (spp - 1)
    write_pfm(path)
    print("CYCLES " + json.dumps({"core_seconds": seconds}))


main()
