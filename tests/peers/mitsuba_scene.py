"""Draws an exported scene (peer_scene export) with Mitsuba 3 (pip install mitsuba):

    mitsuba_scene.py SCENE_DIR OUT_DIR WIDTH HEIGHT SAMPLES SEED [SEED...]

Writes OUT_DIR/mitsuba_SEED.exr (32-bit float, linear) and mitsuba_SEED.json with the seconds of the render call. Its diffuse surfaces and
area lights are one-sided as the engine's; cut-outs are masks.
"""
import json
import os
import sys
import time

import mitsuba as mi
import numpy as np

mi.set_variant(os.environ.get("MITSUBA_VARIANT", "scalar_rgb"))


def srgb_to_linear(v):
    return np.where(v <= 0.04045, v / 12.92, ((v + 0.055) / 1.055) ** 2.4)


def rgb(c):
    return {"type": "rgb", "value": [float(x) for x in c]}


def material(m, texels, max_albedo):
    if m["texture"] < 0:
        reflectance = rgb([min(c, max_albedo) for c in m["albedo"]])
    else:  # the cap comes before the filter here, after it in the engine: the same wherever no texel is above it
        colour = np.minimum(texels[m["texture"]][..., :3] * np.array(m["albedo"]), max_albedo).astype(np.float32)
        reflectance = {"type": "bitmap", "bitmap": mi.Bitmap(colour), "raw": True, "filter_type": "bilinear", "wrap_mode": "repeat"}
    bsdf = {"type": "diffuse", "reflectance": reflectance}
    if m["two_sided"]:
        bsdf = {"type": "twosided", "bsdf": bsdf}
    if m["alpha_cutoff"] > 0 and m["texture"] >= 0:
        raise SystemExit("mitsuba_scene.py: cut-outs are not compared (a mask filters the cut, the engine cuts the filtered alpha)")
    return bsdf


def mesh(name, positions, uvs, triangles, description):
    props = mi.Properties()
    props["bsdf"] = mi.load_dict(description["bsdf"])
    if "emitter" in description:
        props["emitter"] = mi.load_dict(description["emitter"])
    props["face_normals"] = True
    used, renumbered = np.unique(triangles.ravel(), return_inverse=True)
    m = mi.Mesh(name, len(used), len(triangles), has_vertex_normals=False, has_vertex_texcoords=len(uvs) > 0, props=props)
    p = mi.traverse(m)
    p["vertex_positions"] = positions[used].ravel()
    p["faces"] = renumbered.astype(np.uint32).ravel()
    if len(uvs):
        p["vertex_texcoords"] = (uvs[used] * [1, -1] + [0, 1]).astype(np.float32).ravel()  # its row 0 is at v = 0
    p.update()
    return m


def build(folder, width, height):
    with open(os.path.join(folder, "scene.json")) as f:
        scene = json.load(f)
    read = lambda name, kind: np.fromfile(os.path.join(folder, name + ".bin"), dtype=kind)
    positions, uvs = read("positions", "<f4").reshape(-1, 3), read("uvs", "<f4").reshape(-1, 2)
    indices, ids = read("indices", "<u4").reshape(-1, 3), read("materials", "<u4")
    texels = []
    for i, t in enumerate(scene["textures"]):
        a = np.fromfile(os.path.join(folder, f"texture_{i}.bin"), dtype=np.uint8).reshape(t["height"], t["width"], 4) / 255.0
        if t["srgb"]:
            a[..., :3] = srgb_to_linear(a[..., :3])
        texels.append(a)
    c = scene["camera"]
    d = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": -1, "rr_depth": 1000},
        "sensor": {
            "type": "perspective",
            "fov_axis": "y",
            "fov": float(np.degrees(c["vertical_fov"])),
            "near_clip": 1e-4,
            "far_clip": 1e6,
            "to_world": mi.ScalarTransform4f().look_at(c["position"], c["target"], c["up"]),
            "film": {"type": "hdrfilm", "width": width, "height": height, "rfilter": {"type": "box"}, "pixel_format": "rgb", "component_format": "float32"},
            "sampler": {"type": "independent"},
        },
    }
    for i, m in enumerate(scene["materials"]):
        triangles = indices[ids == i]
        if not len(triangles):
            continue
        description = {"bsdf": material(m, texels, scene["max_albedo"])}
        if max(m["emission"]) > 0:
            description["emitter"] = {"type": "area", "radiance": rgb(m["emission"])}
        d[f"mesh_{i}"] = mesh(f"mesh_{i}", positions, uvs, triangles, description)
    for i, l in enumerate(scene["point_lights"]):
        d[f"point_{i}"] = {"type": "point", "position": l["position"], "intensity": rgb(l["intensity"])}
    for i, l in enumerate(scene["directional_lights"]):
        d[f"sun_{i}"] = {"type": "directional", "direction": l["direction"], "irradiance": rgb(l["irradiance"])}
    if max(scene["sky"]) > 0:
        d["sky"] = {"type": "constant", "radiance": rgb(scene["sky"])}
    return mi.load_dict(d)


def main():
    folder, out, width, height, samples, *seeds = sys.argv[1:]
    scene = build(folder, int(width), int(height))
    os.makedirs(out, exist_ok=True)
    for seed in map(int, seeds):
        start = time.time()
        image = mi.render(scene, spp=int(samples), seed=seed)
        mi.Bitmap(image).write(os.path.join(out, f"mitsuba_{seed}.exr"))
        with open(os.path.join(out, f"mitsuba_{seed}.json"), "w") as f:
            json.dump({"seconds": time.time() - start, "samples": int(samples), "version": "Mitsuba " + mi.__version__ + " " + mi.variant()}, f)


main()
