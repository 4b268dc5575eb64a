"""What other people's metrics say of the pairs in image_pairs.h; writes metric_goldens.json. Not part of the test run. See README.md."""
import json
import platform
from importlib.metadata import version
from pathlib import Path

import flip_evaluator
import numpy as np
from skimage.metrics import peak_signal_noise_ratio, structural_similarity

HERE = Path(__file__).parent
PIXELS_PER_DEGREE = 67.02
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])


def uniform(n):
    state = (n.astype(np.uint64) * 747796405 + 2891336453) & 0xFFFFFFFF
    word = (((state >> ((state >> np.uint64(28)) + np.uint64(4))) ^ state) * 277803737) & 0xFFFFFFFF
    return ((word >> np.uint64(22)) ^ word) / 4294967296.0


def grid(width, height):
    y, x, c = np.meshgrid(np.arange(height), np.arange(width), np.arange(3), indexing="ij")
    return x, y, c, (y * width + x) * 3 + c


def read_pfm(file):
    with open(file, "rb") as f:
        assert f.readline().strip() == b"PF"
        width, height = map(int, f.readline().split())
        assert float(f.readline()) < 0
        return np.frombuffer(f.read(), "<f4").reshape(height, width, 3)[::-1].copy()


def board(x, y, c):
    return np.where(((x // 9 + y // 7) % 2 == 0) == (c == 0), 0.85, 0.1 + 0.2 * c)


def light(x, y, c, n):
    spike = np.where(uniform(n // 3 + 9000) > 0.99, 60.0, 0.0)
    return (0.05 + x / 40.0 * (c + 1) / 3.0) * np.where(y < 24, 0.2, 1.0) + spike


def light_range(x, y, c):
    return np.exp2(x / 4.0 - 8) * (0.4 + 0.3 * c) * np.where(y % 16 < 8, 1.0, 1.3)


def pairs():
    """id, value, reference, exposure, curve; curve None where the pictures hold display values."""
    x, y, c, n = grid(61, 47)
    base = 0.1 + 0.7 * np.where(c == 0, x / 60.0, np.where(c == 1, y / 46.0, (x + y) / 106.0))
    yield "ldr_noise", np.clip(base + 0.3 * (uniform(n) - 0.5), 0, 1), np.clip(base, 0, 1), 0, None
    x, y, c, n = grid(64, 48)
    yield "ldr_edges", board(x + 2, y + 1, c), board(x, y, c), 0, None
    n7 = grid(7, 5)[3]
    yield "ldr_small", uniform(n7 + 77), uniform(n7), 0, None
    reference = light(x, y, c, n)
    value = reference * (0.7 + 0.6 * uniform(n + 555))
    yield "hdr_spikes", value, reference, 0, "linear"
    yield "hdr_aces", value, reference, 1.5, "aces"
    x, y, c, n = grid(72, 40)
    yield "hdr_range", light_range(x, y + 3, c) * np.where(y < 20, 1.2, 0.9), light_range(x, y, c), 0, "reinhard"
    yield "render", read_pfm(HERE / "data/cornell_value.pfm"), read_pfm(HERE / "data/cornell_reference.pfm"), 0, "linear"


def signal(image, exposure, curve):
    if curve is None:
        return image
    x = np.maximum(image * 2.0**exposure, 0)
    if curve == "aces":
        x = x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
    if curve == "reinhard":
        x = x / (1 + x)
    x = np.clip(x, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def places(shape):
    """Sixteen pixels at which maps are compared."""
    height, width = shape
    return [(i * 7919 % height, i * 104729 % width) for i in range(16)]


def record(map_, places_):
    return {"value": float(np.mean(map_, dtype=np.float64)), "map": [float(map_[p]) for p in places_]}


def goldens():
    for name, value, reference, exposure, curve in pairs():
        value, reference = value.astype(np.float32), reference.astype(np.float32)
        v, r = (np.asarray(signal(i.astype(np.float64), exposure, curve), np.float32) for i in (value, reference))
        where = places(value.shape[:2])
        out = {"width": value.shape[1], "height": value.shape[0], "places": [[x, y] for y, x in where], "metrics": {}}
        metrics = out["metrics"]
        flip, _, _ = flip_evaluator.evaluate(r, v, "LDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE})
        metrics["flip"] = record(flip[..., 0], where)
        if curve is not None:
            flip, _, used = flip_evaluator.evaluate(reference, value, "HDR", applyMagma=False, parameters={"ppd": PIXELS_PER_DEGREE})
            metrics["flip_hdr"] = record(flip[..., 0], where)
            out["exposures"] = [used["startExposure"], used["stopExposure"], used["numExposures"]]
        if min(value.shape[:2]) >= 11:
            _, ssim = structural_similarity(v.astype(np.float64) @ LUMINANCE, r.astype(np.float64) @ LUMINANCE, data_range=1.0, gaussian_weights=True,
                                            sigma=1.5, use_sample_covariance=False, full=True)
            metrics["ssim"] = record(ssim, where)
        metrics["psnr"] = {"value": float(peak_signal_noise_ratio(reference.astype(np.float64), value.astype(np.float64), data_range=float(reference.max())))}
        yield name, out


judges = {name: version(name) for name in ("flip-evaluator", "scikit-image", "numpy", "scipy")} | {"python": platform.python_version()}
text = json.dumps({"judges": judges, "pixels_per_degree": PIXELS_PER_DEGREE, "pairs": dict(goldens())}, separators=(",", ":"))
(HERE / "data/metric_goldens.json").write_text(text.replace("},", "},\n") + "\n")
