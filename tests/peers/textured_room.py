#!/usr/bin/python3
"""Writes DIR/textured_room.{json,obj,mtl} and two small textures: a room with one of each thing that renderers may read differently.

Textures with no symmetry, repeated and offset by no whole number, enlarged so far that the filter shows; a textured panel seen from both sides; a
one-sided one seen from its back, which is black; a lamp of triangles, a point light, a sun through the open front and a sky.
"""
import json
import os
import sys

import numpy as np
import OpenImageIO as oiio

folder = sys.argv[1]
os.makedirs(folder, exist_ok=True)


def texture(name, seed, tint):
    """16 x 16 texels, sRGB codes from 30 to 235 (below the engine's albedo cap), with a dark L in one corner."""
    texels = np.random.default_rng(seed).integers(30, 236, (16, 16, 3)) * np.array(tint)
    texels[2:10, 2:4], texels[8:10, 2:8] = (30, 60, 20), (60, 20, 30)
    out = oiio.ImageOutput.create(os.path.join(folder, name))
    out.open(os.path.join(folder, name), oiio.ImageSpec(16, 16, 3, oiio.UINT8))
    out.write_image(texels.astype(np.uint8))
    out.close()


texture("floor.png", 1, (1, 0.8, 0.6))
texture("wall.png", 2, (0.7, 1, 0.9))

obj, vertices = ["mtllib textured_room.mtl"], 0


def quad(material, a, b, c, d, uv=((0, 0), (1, 0), (1, 1), (0, 1))):
    """Counter-clockwise as seen from its front."""
    global vertices
    obj.extend("v %g %g %g" % p for p in (a, b, c, d))
    obj.extend("vt %g %g" % t for t in uv)
    obj.append("usemtl " + material)
    i = [vertices + k for k in (1, 2, 3, 4)]
    obj.append("f " + " ".join(f"{k}/{k}" for k in i))
    vertices += 4


def box(material, lo, hi):
    (x, y, z), (X, Y, Z) = lo, hi
    quad(material, (x, Y, Z), (X, Y, Z), (X, Y, z), (x, Y, z))
    quad(material, (x, y, Z), (X, y, Z), (X, Y, Z), (x, Y, Z))
    quad(material, (X, y, z), (x, y, z), (x, Y, z), (X, Y, z))
    quad(material, (X, y, Z), (X, y, z), (X, Y, z), (X, Y, Z))
    quad(material, (x, y, z), (x, y, Z), (x, Y, Z), (x, Y, z))


quad("floor", (-2, 0, 2), (2, 0, 2), (2, 0, -2), (-2, 0, -2), ((-0.3, 0.2), (1.4, 0.2), (1.4, 1.9), (-0.3, 1.9)))
quad("ceiling", (-2, 3, -2), (2, 3, -2), (2, 3, 2), (-2, 3, 2))
quad("wall", (-2, 0, -2), (2, 0, -2), (2, 3, -2), (-2, 3, -2))
quad("red", (-2, 0, 2), (-2, 0, -2), (-2, 3, -2), (-2, 3, 2))
quad("ceiling", (2, 0, -2), (2, 0, 2), (2, 3, 2), (2, 3, -2))
quad("lamp", (-0.5, 2.98, -0.9), (0.3, 2.98, -0.9), (0.3, 2.98, -0.3), (-0.5, 2.98, -0.3))
box("floor", (0.5, 0, -1.2), (1.4, 0.9, -0.3))
quad("panel", (-1.5, 0.4, 0.2), (-0.7, 0.4, -0.5), (-0.7, 1.5, -0.5), (-1.5, 1.5, 0.2), ((0.1, 0), (0.7, 0), (0.7, 0.8), (0.1, 0.8)))
quad("red", (1.7, 1.2, -0.6), (1.1, 1.2, -0.4), (1.1, 1.9, -0.4), (1.7, 1.9, -0.6))  # its back is towards the camera

mtl = """newmtl floor
Kd 0.9 0.9 0.9
map_Kd floor.png
newmtl wall
Kd 1 1 1
map_Kd wall.png
newmtl panel
Kd 0.8 0.9 1
map_Kd wall.png
newmtl ceiling
Kd 0.8 0.78 0.75
newmtl red
Kd 0.7 0.15 0.1
newmtl lamp
Kd 0.3 0.3 0.3
Ke 6 5 4
"""
scene = {
    "version": 1,
    "label": "Textured room",
    "mesh": {"file": "textured_room.obj"},
    "materials": {"panel": {"two_sided": True}},
    "lights": [
        {"type": "point", "name": "bulb", "position": [-1.2, 2.2, 0.9], "intensity": [1.5, 1.2, 2.0]},
        {"type": "directional", "name": "sun", "direction": [0.3, -0.6, -0.74], "irradiance": [3, 2.8, 2.2]},
    ],
    "sky": [0.5, 0.7, 1.0],
    "cameras": [
        {"name": "front", "position": [0.2, 1.5, 5.2], "target": [0, 1.4, 0], "vertical_fov_degrees": 50},
        {"name": "shaded wall", "position": [0.2, 1.5, 5.2], "target": [1.77, 1.76, 0], "vertical_fov_degrees": 5},
    ],
}
for name, text in (("textured_room.obj", "\n".join(obj) + "\n"), ("textured_room.mtl", mtl), ("textured_room.json", json.dumps(scene, indent=1))):
    with open(os.path.join(folder, name), "w") as f:
        f.write(text)
