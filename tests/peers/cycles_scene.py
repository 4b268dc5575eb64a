"""Draws an exported scene (peer_scene export) with Cycles:

    blender -b --factory-startup --python cycles_scene.py -- SCENE_DIR OUT_DIR WIDTH HEIGHT SAMPLES SEED [SEED...]

Writes OUT_DIR/cycles_SEED.exr (32-bit float, linear) and cycles_SEED.json with the seconds of the render call. Lambert, one-sided
surfaces and lamps, no caustic tricks, no clamps, every bounce, box filter: what MEASURES.md asks of a peer.
"""
import json
import math
import os
import sys
import time

import bpy
import numpy as np
from mathutils import Matrix, Vector


def load(folder):
    with open(os.path.join(folder, "scene.json")) as f:
        scene = json.load(f)
    read = lambda name, kind: np.fromfile(os.path.join(folder, name + ".bin"), dtype=kind)
    scene["positions"] = read("positions", "<f4").reshape(-1, 3)
    scene["uvs"] = read("uvs", "<f4").reshape(-1, 2)
    scene["indices"] = read("indices", "<u4").reshape(-1, 3).astype(np.int32)
    scene["material_ids"] = read("materials", "<u4").astype(np.int32)
    return scene


def srgb_to_linear(v):
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def image_of(folder, i, info):
    """As linear floats: Cycles filters 8-bit sRGB images before it undoes the curve, the engine after."""
    texels = np.fromfile(os.path.join(folder, f"texture_{i}.bin"), dtype=np.uint8).reshape(info["height"], info["width"], 4) / 255.0
    if info["srgb"]:
        texels[..., :3] = srgb_to_linear(texels[..., :3])
    image = bpy.data.images.new(f"texture_{i}", info["width"], info["height"], alpha=True, float_buffer=True)
    image.colorspace_settings.name = "Non-Color"
    image.alpha_mode = "CHANNEL_PACKED"
    image.pixels.foreach_set(np.ascontiguousarray(texels[::-1], dtype=np.float32).ravel())
    image.update()
    return image


def material_of(i, m, images, max_albedo):
    material = bpy.data.materials.new(f"material_{i}")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    nodes.clear()
    output = nodes.new("ShaderNodeOutputMaterial")
    diffuse = nodes.new("ShaderNodeBsdfDiffuse")
    diffuse.inputs["Roughness"].default_value = 0
    albedo = [min(c, max_albedo) for c in m["albedo"]]
    front = diffuse.outputs[0]
    texture = None
    if m["texture"] >= 0:
        texture = nodes.new("ShaderNodeTexImage")
        texture.image = images[m["texture"]]
        texture.interpolation, texture.extension = "Linear", "REPEAT"
        product = nodes.new("ShaderNodeMixRGB")
        product.blend_type = "MULTIPLY"
        cap = nodes.new("ShaderNodeMixRGB")
        cap.blend_type = "DARKEN"
        for node in (product, cap):
            node.inputs[0].default_value = 1
        product.inputs[2].default_value = (*m["albedo"], 1)
        cap.inputs[2].default_value = (max_albedo,) * 3 + (1,)
        links.new(texture.outputs["Color"], product.inputs[1])
        links.new(product.outputs[0], cap.inputs[1])
        links.new(cap.outputs[0], diffuse.inputs["Color"])
    else:
        diffuse.inputs["Color"].default_value = (*albedo, 1)

    geometry = nodes.new("ShaderNodeNewGeometry")

    def only_front(shader):
        mix = nodes.new("ShaderNodeMixShader")
        links.new(geometry.outputs["Backfacing"], mix.inputs[0])
        links.new(shader, mix.inputs[1])
        black = nodes.new("ShaderNodeBsdfDiffuse")
        black.inputs["Color"].default_value = (0, 0, 0, 1)
        links.new(black.outputs[0], mix.inputs[2])
        return mix.outputs[0]

    if not m["two_sided"]:
        front = only_front(front)
    if max(m["emission"]) > 0:
        # One strength and a colour up to 1: Cycles clamps no colour, but this is what its own files hold.
        strength = max(m["emission"])
        emission = nodes.new("ShaderNodeEmission")
        emission.inputs["Strength"].default_value = strength
        emission.inputs["Color"].default_value = (*[c / strength for c in m["emission"]], 1)
        add = nodes.new("ShaderNodeAddShader")
        links.new(front, add.inputs[0])
        links.new(only_front(emission.outputs[0]), add.inputs[1])
        front = add.outputs[0]
    if m["alpha_cutoff"] > 0 and texture:
        clear = nodes.new("ShaderNodeBsdfTransparent")
        below = nodes.new("ShaderNodeMath")
        below.operation = "LESS_THAN"
        below.inputs[1].default_value = m["alpha_cutoff"]
        mix = nodes.new("ShaderNodeMixShader")
        links.new(texture.outputs["Alpha"], below.inputs[0])
        links.new(below.outputs[0], mix.inputs[0])
        links.new(front, mix.inputs[1])
        links.new(clear.outputs[0], mix.inputs[2])
        front = mix.outputs[0]
    links.new(front, output.inputs["Surface"])
    return material


def build(folder):
    scene = load(folder)
    bpy.ops.wm.read_factory_settings(use_empty=True)
    images = [image_of(folder, i, t) for i, t in enumerate(scene["textures"])]
    mesh = bpy.data.meshes.new("scene")
    corners, triangles = scene["indices"].ravel(), len(scene["indices"])
    mesh.vertices.add(len(scene["positions"]))
    mesh.vertices.foreach_set("co", scene["positions"].ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", corners)
    mesh.polygons.add(triangles)
    mesh.polygons.foreach_set("loop_start", np.arange(0, 3 * triangles, 3, dtype=np.int32))
    mesh.polygons.foreach_set("loop_total", np.full(triangles, 3, dtype=np.int32))
    mesh.polygons.foreach_set("material_index", scene["material_ids"])
    mesh.polygons.foreach_set("use_smooth", np.zeros(triangles, dtype=bool))
    if len(scene["uvs"]):
        mesh.uv_layers.new(name="uv").data.foreach_set("uv", scene["uvs"][corners].ravel())
    for i, m in enumerate(scene["materials"]):
        mesh.materials.append(material_of(i, m, images, scene["max_albedo"]))
    mesh.update()
    collection = bpy.context.scene.collection
    collection.objects.link(bpy.data.objects.new("scene", mesh))

    def lamp(name, kind, matrix):
        data = bpy.data.lights.new(name, kind)
        thing = bpy.data.objects.new(name, data)
        thing.matrix_world = matrix
        collection.objects.link(thing)
        return data

    for i, l in enumerate(scene["point_lights"]):
        data = lamp(f"point_{i}", "POINT", Matrix.Translation(l["position"]))
        strength = max(l["intensity"])
        data.color = [c / strength for c in l["intensity"]]
        data.energy = 4 * math.pi * strength  # watts over the sphere; checked with point_light_cube
        data.shadow_soft_size = 0
    for i, l in enumerate(scene["directional_lights"]):
        data = lamp(f"sun_{i}", "SUN", Vector(l["direction"]).to_track_quat("-Z", "Y").to_matrix().to_4x4())
        strength = max(l["irradiance"])
        data.color = [c / strength for c in l["irradiance"]]
        data.energy, data.angle = strength, 0

    world = bpy.data.worlds.new("sky")
    bpy.context.scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs[0].default_value = (*scene["sky"], 1)
    world.node_tree.nodes["Background"].inputs[1].default_value = 1

    c = scene["camera"]
    forward = (Vector(c["target"]) - Vector(c["position"])).normalized()
    right = forward.cross(Vector(c["up"])).normalized()
    up = right.cross(forward)
    data = bpy.data.cameras.new("camera")
    data.sensor_fit, data.angle = "VERTICAL", c["vertical_fov"]
    extent = float(np.linalg.norm(np.ptp(scene["positions"], axis=0)))
    data.clip_start, data.clip_end = 1e-5 * extent, 1e4 * extent
    camera = bpy.data.objects.new("camera", data)
    camera.matrix_world = Matrix.Translation(c["position"]) @ Matrix((right, up, -forward)).transposed().to_4x4()
    collection.objects.link(camera)
    bpy.context.scene.camera = camera
    return scene


def settings(width, height, samples):
    s = bpy.context.scene
    s.render.engine = "CYCLES"
    s.render.resolution_x, s.render.resolution_y, s.render.resolution_percentage = width, height, 100
    s.render.film_transparent = False
    s.render.image_settings.file_format = "OPEN_EXR"
    s.render.image_settings.color_mode, s.render.image_settings.color_depth = "RGB", "32"
    s.view_settings.view_transform = "Raw"
    s.render.dither_intensity = 0
    c = s.cycles
    c.device = "CPU"
    c.samples, c.use_adaptive_sampling, c.use_denoising, c.time_limit = samples, False, False, 0
    c.max_bounces = c.diffuse_bounces = c.transparent_max_bounces = 1024
    c.min_light_bounces = 0
    c.sample_clamp_direct = c.sample_clamp_indirect = 0
    c.light_sampling_threshold = 0
    c.blur_glossy = 0
    c.pixel_filter_type, c.filter_width = "BOX", 1
    c.use_fast_gi = False


def main():
    folder, out, width, height, samples, *seeds = sys.argv[sys.argv.index("--") + 1:]
    build(folder)
    settings(int(width), int(height), int(samples))
    os.makedirs(out, exist_ok=True)
    for seed in map(int, seeds):
        bpy.context.scene.cycles.seed = seed
        bpy.context.scene.render.filepath = os.path.join(os.path.abspath(out), f"cycles_{seed}.exr")
        start = time.time()
        bpy.ops.render.render(write_still=True)
        with open(os.path.join(out, f"cycles_{seed}.json"), "w") as f:
            json.dump({"seconds": time.time() - start, "samples": int(samples), "version": "Blender " + bpy.app.version_string}, f)


if __name__ == "__main__":
    try:
        main()
    except Exception:
        import traceback

        traceback.print_exc()
        sys.exit(1)
