"""Bakes total irradiance (direct and indirect) into the engine's lightmap layout with Cycles:

    blender -b --factory-startup --python cycles_bake.py -- SCENE_DIR OUT_DIR RESOLUTION SEED SAMPLES [SAMPLES...]

SCENE_DIR is from `peer_scene export` and `peer_scene atlas`. Writes OUT_DIR/bake_SAMPLES_SEED.npy (RESOLUTION^2 x 4, row 0 at v = 0; RGB is E, A is 1
where Cycles baked) and .json with the seconds, wall and of the processor, of the bake call.
"""
import json
import math
import os
import sys
import time

import bpy
import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import cycles_scene


def main():
    folder, out, resolution, seed, *all_samples = sys.argv[sys.argv.index("--") + 1:]
    resolution = int(resolution)
    cycles_scene.build(folder)
    cycles_scene.settings(16, 16, 1)
    thing = bpy.data.objects["scene"]
    layer = thing.data.uv_layers.new(name="lightmap")
    layer.data.foreach_set("uv", np.fromfile(os.path.join(folder, "corner_uvs.bin"), dtype="<f4"))
    # Textures name no UV set and read the one that renders; the bake writes along the active one.
    thing.data.uv_layers.active = layer
    image = bpy.data.images.new("lightmap", resolution, resolution, alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    for material in thing.data.materials:
        node = material.node_tree.nodes.new("ShaderNodeTexImage")
        node.image = image
        material.node_tree.nodes.active = node
    bpy.context.view_layer.objects.active = thing
    thing.select_set(True)
    bake = bpy.context.scene.render.bake
    # Not indirect light alone: with that pass filter Cycles 3.4 returned a thousandth of it on this scene.
    bake.margin, bake.use_clear = 0, True
    bake.use_pass_direct, bake.use_pass_indirect, bake.use_pass_color = True, True, False
    bpy.context.scene.cycles.seed = int(seed)
    os.makedirs(out, exist_ok=True)
    for samples in map(int, all_samples):
        bpy.context.scene.cycles.samples = samples
        wall, processor = time.time(), time.process_time()
        bpy.ops.object.bake(type="DIFFUSE")
        wall, processor = time.time() - wall, time.process_time() - processor
        pixels = np.empty(4 * resolution * resolution, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(-1, 4)
        pixels[:, :3] *= math.pi  # the pass is E / pi
        name = os.path.join(out, f"bake_{samples}_{seed}")
        np.save(name + ".npy", pixels)
        with open(name + ".json", "w") as f:
            json.dump({"seconds": wall, "processor_seconds": processor, "samples": samples}, f)


try:
    main()
except Exception:
    import traceback

    traceback.print_exc()
    sys.exit(1)
