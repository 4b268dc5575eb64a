#!/usr/bin/python3
"""Lightmaps of the Cornell box, ours and Cycles', in one run, in turn: error against samples and time.

    bake_compare.py OUT [--resolution 64] [--truth 1024] [--ladder 64,256,1024,2048]

Three bakes into the same texels: Cycles (total irradiance), our reference (total irradiance), our radiosity (indirect irradiance, its own
bounces to 32). Error: root of the mean over texels, weighted by area, of (v - A)(v - B) / (r^2 + e^2), r = (A + B) / 2, e = 0.01 of its mean, luminance; A
and B are two independent runs of our reference, so the truth's own noise does not count (MEASURES.md). Cycles takes points all over a texel, we its centroid;
the standard error (+-) is over texels. Texels with a neighbour outside their chart, or inside another thing, are left out of the first two bakes, and Cycles is measured against two long bakes of its own, too. Radiosity's error is what
`halflight-cli render` says, over all texels. Seconds: wall clock of the bake itself, and of the processor: of the bake call for Cycles, of the whole program (start-up, scene,
for radiosity the picture and the measuring too) for ours. Times to an error are the processor's: wall clocks of a shared machine do not compare.
Environment: PEER_SCENE, HALFLIGHT_CLI, BLENDER; HALFLIGHT_CACHE is set to OUT/cache so that nothing is found done.
"""
import argparse
import json
import math
import os
import re
import resource
import subprocess
import sys

import numpy as np
import OpenImageIO as oiio

HERE = os.path.dirname(os.path.abspath(__file__))
BUILD = os.path.join(HERE, "../../build/release")
PEER_SCENE = os.environ.get("PEER_SCENE", os.path.join(BUILD, "tests/peer_scene"))
CLI = os.environ.get("HALFLIGHT_CLI", os.path.join(BUILD, "app/halflight-cli"))
PRESET = os.path.join(HERE, "../../presets/cornell_radiosity.json")
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def call(*command):
    """Standard output and the seconds of processor time it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"bake_compare.py: {' '.join(map(str, command))}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def picture(file):
    source = oiio.ImageInput.open(file)
    pixels = source.read_image(oiio.FLOAT)[::-1, :, :3].astype(np.float64)
    source.close()
    return pixels.reshape(-1, 3)


def reference(out, name, samples, seed, resolution):
    file = os.path.join(out, name + ".pfm")
    text, processor = call(CLI, "reference", PRESET, "--lightmap", "--spp", samples, "--set", f"lightmap.resolution={resolution}", "--set", f"reference.seed={seed}",
                           "--set", f"reference.direct_samples={min(samples, 256)}", "--out", file)
    seconds = float(re.search(r", ([0-9.]+) s\n", text).group(1))
    return picture(file) + picture(file.replace(".pfm", "_direct_irradiance.pfm")), seconds, processor


def cycles(out, samples, seed, resolution):
    call(os.environ.get("BLENDER", "blender"), "-b", "--factory-startup", "--python-exit-code", 1, "--python", os.path.join(HERE, "cycles_bake.py"), "--", out, out,
         resolution, seed, 1, samples)  # one sample first: Cycles loads its kernels then
    name = os.path.join(out, f"bake_{samples}_{seed}")
    with open(name + ".json") as f:
        note = json.load(f)
    return np.load(name + ".npy").astype(np.float64), note["seconds"], note["processor_seconds"]


def radiosity(samples, truth, resolution):
    text, processor = call(CLI, "render", PRESET, "--json", "--resolution", "32x18", "--metrics", "relmse,bias", "--errors-of", "lightmap", "--set",
                           f"lightmap.resolution={resolution}", "--set", f"radiosity.samples={samples}", "--set", "radiosity.bounces=32", "--set",
                           "radiosity.residual=1e-4", "--set", f"reference.samples={truth}", "--set", "reference.direct_samples=256", "--set", "reference.seed=1")
    result = json.loads(text)
    errors = {e["metric"]: e for e in result["errors"]}
    return *root(errors["relmse"]["value"], errors["relmse"]["standard_error"]), errors["bias"]["value"], result["work"]["ms"] / 1000, processor


def interior(lumels, resolution):
    """Those whose eight neighbours are of the same chart."""
    chart = np.full((resolution + 2, resolution + 2), -1, dtype=np.int64)
    y, x = lumels["texel"] // resolution, lumels["texel"] % resolution
    chart[y + 1, x + 1] = lumels["chart"]
    inside = np.ones(len(lumels), dtype=bool)
    for dy in (0, 1, 2):
        for dx in (0, 1, 2):
            inside &= chart[y + dy, x + dx] == lumels["chart"]
    return inside


def root(square, standard_error):
    """And its own standard error; 0 where the square's estimate is negative, which a truth too noisy for it makes it."""
    value = math.sqrt(max(square, 0))
    return value, standard_error / (2 * value) if value else float("inf")


def error(value, a, b, area):
    v, a, b = value @ LUMINANCE, a @ LUMINANCE, b @ LUMINANCE
    r = (a + b) / 2
    e = 0.01 * np.average(r, weights=area)
    squares = (v - a) * (v - b) / (r * r + e * e)
    mean, weights = np.average(squares, weights=area), area / area.sum()
    return *root(mean, math.sqrt((weights**2 * (squares - mean) ** 2).sum())), np.average(v - r, weights=area) / np.average(r, weights=area)


def time_to(goal, rows):
    """Rows of (seconds, error) by rising samples: between the two round the goal, along a straight line of logarithms; past the last by the inverse root of time."""
    for (t0, e0), (t1, e1) in zip(rows, rows[1:]):
        if e0 > goal >= e1 > 0:
            return t0 * (t1 / t0) ** (math.log(e0 / goal) / math.log(e0 / e1)), ""
    t, e = rows[-1]
    return (t * (e / goal) ** 2, f" (extrapolated from {100 * e:.2f} % at {t:.2f} s)") if e > goal else (rows[0][0], " or less")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("out")
    parser.add_argument("--resolution", type=int, default=64)
    parser.add_argument("--truth", type=int, default=1024)
    parser.add_argument("--ladder", default="64,256,1024,2048")
    o = parser.parse_args()
    os.makedirs(o.out, exist_ok=True)
    os.environ["HALFLIGHT_CACHE"] = os.path.join(os.path.abspath(o.out), "cache")
    call(PEER_SCENE, "export", "cornell_box", "front", o.out)
    call(PEER_SCENE, "atlas", "cornell_box", o.resolution, o.out)
    lumels = np.fromfile(os.path.join(o.out, "lumels.bin"), dtype=[("texel", "<u4"), ("chart", "<u4"), ("area", "<f4")])
    a, b = (reference(o.out, f"truth_{s}", o.truth, s, o.resolution)[0] for s in (1, 2))
    ca, cb = (cycles(o.out, 2 * o.truth, 100 + s, o.resolution)[0] for s in (1, 2))
    lumels = lumels[a[lumels["texel"]].sum(axis=1) > 0]  # the engine leaves out texels inside other geometry
    keep = interior(lumels, o.resolution) & (ca[lumels["texel"], 3] > 0)
    texels, area = lumels["texel"][keep], lumels["area"][keep]
    print(f"{len(lumels)} texels, {len(texels)} compared; long bakes apart by {100 * error(ca[texels, :3], a[texels], b[texels], area)[0]:.3f} % "
          f"(mean {100 * error((ca + cb)[texels, :3] / 2, a[texels], b[texels], area)[2]:+.3f} %)")
    print(f"{'samples':>8} {'bake':<10} {'error %':>8} {'+-':>7} {'own truth %':>12} {'bias %':>8} {'wall s':>8} {'proc. s':>8}")
    rows = {"Cycles": [], "reference": [], "radiosity": []}
    own, bake_alone = [], []
    for samples in map(int, o.ladder.split(",")):
        value, wall, processor = cycles(o.out, samples, 1, o.resolution)
        e, se, bias = error(value[texels, :3], a[texels], b[texels], area)
        mine = error(value[texels, :3], ca[texels, :3], cb[texels, :3], area)[0]
        print(f"{samples:8} {'Cycles':<10} {100 * e:8.3f} {100 * se:7.3f} {100 * mine:12.3f} {100 * bias:8.3f} {wall:8.2f} {processor:8.2f}", flush=True)
        rows["Cycles"].append((processor, e)), own.append((processor, mine))
        value, wall, processor = reference(o.out, "ours", samples, 10, o.resolution)
        e, se, bias = error(value[texels], a[texels], b[texels], area)
        print(f"{samples:8} {'reference':<10} {100 * e:8.3f} {100 * se:7.3f} {'':12} {100 * bias:8.3f} {wall:8.2f} {processor:8.2f}", flush=True)
        rows["reference"].append((processor, e))
        e, se, bias, wall, processor = radiosity(samples, o.truth, o.resolution)
        print(f"{samples:8} {'radiosity':<10} {100 * e:8.3f} {100 * se:7.3f} {'':12} {100 * bias:8.3f} {wall:8.2f} {processor:8.2f}", flush=True)
        rows["radiosity"].append((processor, e)), bake_alone.append((wall, e))
    for goal in (0.02, 0.01):
        for name, table in list(rows.items()) + [("Cycles, own truth", own), ("radiosity, wall clock of the bake", bake_alone)]:
            seconds, how = time_to(goal, table)
            print(f"to {100 * goal:g} %: {name:<34} {seconds:8.2f} s{how}")


main()
