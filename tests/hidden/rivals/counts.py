"""The two effects that no residual's mean shows: frames that are missing, and a picture noisier than declared.

Neither is a matter of regression, so both rivals share this: a count of gaps, and the scatter of circle 1's area, which
hardly feels an error of the pose, against that of as many frames rendered with the declared noise.
"""

import math

import numpy as np

from ..effects import BY_NAME
from . import image

FACTORS = (1.0, 1.12, 1.25, 1.4, 1.6, 2.0, 2.7, 4.0, 7.0, 12.0)
WORTH = 1.94  # second differences of n samples say as much about a variance as n / 1.94 independent ones
REPEATS = 3  # as many rendered frames per real one


def _variance(pieces):
    bent = np.concatenate([p[2:] - 2.0 * p[1:-1] + p[:-2] for p in pieces if len(p) > 2])
    bent = bent[np.isfinite(bent)]
    return float(np.mean(bent**2)) / 6.0, len(bent) / WORTH


def noise_level(data, camera):
    """(sigma, fall of the criterion) if the pictures are noisier than the camera given has them, else None."""
    runs = [r for r in data.runs if len(r.frames) > 10]
    if not runs:
        return None
    poses = [image.fit_poses(r.frames, r.frame_time, camera, data.world) for r in runs]
    clean = [data.world.rendered(p, camera)[:, 0] for p in poses]
    seen, worth = _variance([r.frames[:, 0, 0] - c for r, c in zip(runs, clean)])
    worth /= 1.0 + 1.0 / REPEATS  # what is expected is drawn too
    misfits = []
    for factor in FACTORS:
        true = {**camera, "sigma": factor * camera["sigma"]}
        drawn = [data.world.noisy(p, true, 100 * i + k + 1)[:, 0] - c
                 for i in range(REPEATS) for k, (p, c) in enumerate(zip(poses, clean))]
        expected, _ = _variance(drawn)
        misfits.append(worth * (math.log(expected) + seen / expected))
        if len(misfits) > 2 and misfits[-1] > misfits[-2]:
            break
    best = int(np.argmin(misfits))
    fall = misfits[0] - misfits[best] - math.log(worth)
    return (FACTORS[best] * camera["sigma"], fall) if best > 0 and fall > 0.0 else None


def lost(data):
    """[(effect, value, fall of the criterion)] if frames are missing."""
    gone, rows = sum(r.lost for r in data.runs), sum(r.rows for r in data.runs)
    if not gone or all(e.name != "camera.drop_rate" for e in data.candidates):
        return []
    rate = gone / (gone + rows)
    return [(BY_NAME["camera.drop_rate"], rate, -2.0 * (gone * math.log(rate) + rows * math.log(1.0 - rate)))]


def extras(data, camera):
    """The same of both effects, as far as they may be named."""
    level = None
    if camera["sigma"] > 0.0 and any(e.name == "camera.sigma" for e in data.candidates):
        level = noise_level(data, camera)
    return lost(data) + ([(BY_NAME["camera.sigma"], *level)] if level else [])
