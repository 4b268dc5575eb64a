#!/usr/bin/python3
"""Our pictures against another renderer's, of one scene and camera (numpy, OpenImageIO's Python):

    compare.py DIR PEER [--region NAME,X,Y,W,H]... [--scale F] [--map FILE.exr]

DIR has ours_SEED.pfm (peer_scene render) and PEER_SEED.exr, at least 5 seeds of each (10 for a claim). Per pixel and channel
z = (mean ours - mean peer) / sqrt(var_ours / n_ours + var_peer / n_peer), with variances over the seeds. A pixel passes where |z| is within the two-sided
bound of alpha 0.01, Sidak-corrected for all pixels and channels; the picture passes with 99.75 % of its pixels. Regions (fractions of the picture)
and the whole: the means' difference within 3 combined standard errors, from the seeds' own region means. Beside it, as a test with more power,
the share of single |z| below 2.576, which for equal renderers with 10 seeds each is that of Student's t at about 18 degrees of freedom.
Exit code 0 where all passes, 1 where not, 2 for bad input.
"""
import argparse
import glob
import json
import math
import os
import sys
from statistics import NormalDist

import numpy as np
import OpenImageIO as oiio

ALPHA, SHARE, SIGMAS, SMALL_Z = 0.01, 0.9975, 3.0, 2.576


def bad(message):
    print("compare.py: " + message, file=sys.stderr)
    sys.exit(2)


def pictures(folder, name):
    found = sorted(glob.glob(os.path.join(folder, name + "_*.exr")) + glob.glob(os.path.join(folder, name + "_*.pfm")))
    if len(found) < 5:
        bad(f"{folder} has {len(found)} pictures {name}_SEED; at least 5 are needed")
    images, seconds, samples = [], [], []
    for file in found:
        source = oiio.ImageInput.open(file)
        pixels = source.read_image(oiio.FLOAT)[..., :3].astype(np.float64)
        source.close()
        if not np.isfinite(pixels).all():
            bad(f"{file} has pixels that are not finite")
        images.append(pixels)
        with open(os.path.splitext(file)[0] + ".json") as f:
            note = json.load(f)
        seconds.append(note["seconds"])
        samples.append(note["samples"])
    return np.stack(images), float(np.median(seconds)), samples[0]


def region_rows(ours, peer, regions):
    height, width = ours.shape[1:3]
    for name, x, y, w, h in regions:
        rows = slice(round(y * height), max(round((y + h) * height), round(y * height) + 1))
        cols = slice(round(x * width), max(round((x + w) * width), round(x * width) + 1))
        a, b = ours[:, rows, cols].mean(axis=(1, 2)), peer[:, rows, cols].mean(axis=(1, 2))
        for c, channel in enumerate("RGB"):
            se = math.sqrt(a[:, c].var(ddof=1) / len(a) + b[:, c].var(ddof=1) / len(b))
            difference = a[:, c].mean() - b[:, c].mean()
            yield name, channel, a[:, c].mean(), b[:, c].mean(), difference, se


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder")
    parser.add_argument("peer")
    parser.add_argument("--region", action="append", default=[])
    parser.add_argument("--scale", type=float, default=1, help="multiplies ours: shows how small a difference the test sees")
    parser.add_argument("--map", help="writes |z| per pixel, the largest of its channels, as EXR")
    o = parser.parse_args()
    ours, our_seconds, our_samples = pictures(o.folder, "ours")
    ours *= o.scale
    peer, peer_seconds, peer_samples = pictures(o.folder, o.peer)
    if ours.shape[1:] != peer.shape[1:]:
        bad(f"ours is {ours.shape[2]} x {ours.shape[1]}, {o.peer} {peer.shape[2]} x {peer.shape[1]}")
    variance = ours.var(axis=0, ddof=1) / len(ours) + peer.var(axis=0, ddof=1) / len(peer)
    difference = ours.mean(axis=0) - peer.mean(axis=0)
    # Pixels without variance (a lamp seen whole, a miss) must agree to float rounding.
    flat = variance <= (1e-6 * np.maximum(np.abs(ours.mean(axis=0)), 1e-6)) ** 2
    z = np.where(flat, np.where(np.abs(difference) <= 1e-5 * np.abs(ours.mean(axis=0)) + 1e-9, 0, np.inf), difference / np.sqrt(np.where(flat, 1, variance)))
    bound = NormalDist().inv_cdf(1 - (1 - (1 - ALPHA) ** (1 / z.size)) / 2)
    worst = np.abs(z).max(axis=2)
    share = float((worst <= bound).mean())
    small = float((np.abs(z[~flat]) <= SMALL_Z).mean())
    relative = math.sqrt(variance.mean()) / ours.mean()
    print(f"ours: {len(ours)} seeds x {our_samples} samples, {our_seconds:.2f} s each; {o.peer}: {len(peer)} seeds x {peer_samples}, {peer_seconds:.2f} s each")
    print(f"pixels within |z| <= {bound:.2f}: {100 * share:.3f} % of {worst.size} (needed {100 * SHARE} %); worst {worst.max():.2f}")
    print(f"single |z| <= {SMALL_Z}: {100 * small:.2f} % (98.1 % expected of equal renderers); standard error of a pixel {100 * relative:.2f} % of the mean")
    ok = share >= SHARE
    regions = [("all", 0, 0, 1, 1)] + [(r.split(",")[0], *map(float, r.split(",")[1:])) for r in o.region]
    print(f"{'region':<24} c {'ours':>11} {o.peer:>11} {'difference':>11} {'SE':>10} {'rel. %':>8} {'/SE':>6}")
    for name, channel, a, b, d, se in region_rows(ours, peer, regions):
        within = abs(d) <= SIGMAS * se or abs(d) <= 1e-6 * abs(a)
        ok = ok and within
        print(f"{name:<24} {channel} {a:11.6f} {b:11.6f} {d:11.2e} {se:10.2e} {100 * d / b if b else 0:8.3f} {d / se if se else 0:6.2f}{'' if within else '  FAIL'}")
    if o.map:
        out = oiio.ImageOutput.create(o.map)
        out.open(o.map, oiio.ImageSpec(worst.shape[1], worst.shape[0], 1, oiio.FLOAT))
        out.write_image(np.ascontiguousarray(np.minimum(worst, 1e6), dtype=np.float32))
        out.close()
    print("PASS" if ok else "FAIL")
    return 0 if ok else 1


sys.exit(main())
