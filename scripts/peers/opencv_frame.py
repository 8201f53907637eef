#!/usr/bin/env python3
"""One camera frame with OpenCV and numpy, tuned: what Acroscope's camera is measured against.

The same frames as `benches/src/frame.rs`: render three circles, defocus, noise, quantise, threshold, label, centroids;
512 x 512, one thread. Four pipelines, each as fast as it could be made:

* `labels`: as `operators`, with connected components and 16-bit labels of the whole frame instead of contours.
* `operators`: OpenCV's operators over the whole frame (threshold, contours, moments), circles rendered and
  defocused in boxes only, noise by `cv2.randn`.
* `boxes`: the whole frame is made as before, but the vision looks only into boxes that it knows from the renderer.
* `table`: as `boxes`, and the noise by our own method, a table of the inverse distribution, through the 16-bit
  `cv2.LUT` that is new in OpenCV 5 and numpy's fastest generator (SFC64). It draws at 8 bits and is right only
  because the background is one grey level.

Without arguments prints a table. With `--serve` it reads lines `CASE PIPELINE FIRST COUNT` and answers each with one
line of JSON: the times of the frames in microseconds and the centroids of the last one.
"""

import json
import sys
import time

import cv2
import numpy as np

cv2.setNumThreads(1)

SIZE, HALF = 512, 256.0
LINK1, LINK2, DRUM, GROUND = 6.19, 6.9, 1.0, -8.0
FIELD, RADIUS, FOCAL = 20.0, 0.2, 2.0
SCALE = SIZE / FIELD
LEVEL = 191
K1, P1, P2, S1, S2, BETA = 0.1, 0.002, 0.002, 0.02, 0.01, 1.0
MASK = np.array([[1, 2, 1], [2, 15, 2], [1, 2, 1]], np.float32) / 27

CASES = {  # sub-frames, sigma, passes of the defocus mask, lens and sensitivity
    "a": (1, 0.0, 0, False),
    "b16": (16, 0.0, 0, False),
    "c": (1, 15.0, 2, False),
    "d": (16, 15.0, 2, True),
}
PIPELINES = ("labels", "operators", "boxes", "table")


def distorted(u, v):
    """(3) to (8)."""
    r2 = u * u + v * v
    du = K1 * u * r2 + P1 * (3 * u * u + v * v) + 2 * P2 * u * v + S1 * r2
    dv = K1 * v * r2 + 2 * P1 * u * v + P2 * (u * u + 3 * v * v) + S2 * r2
    return u + du, v + dv


def stretch(u, v):
    """The inverse of the map's derivative at each circle, by differences: the circle becomes an ellipse."""
    h = 1e-3
    au, av = distorted(u + h, v)
    bu, bv = distorted(u - h, v)
    cu, cv = distorted(u, v + h)
    du, dv = distorted(u, v - h)
    a, c, b, d = (au - bu) / (2 * h), (av - bv) / (2 * h), (cu - du) / (2 * h), (cv - dv) / (2 * h)
    determinant = a * d - b * c
    return np.array([d, -b, -c, a]) / determinant, np.sqrt(np.abs(determinant))


class Camera:
    def __init__(self, case, pipeline):
        self.subframes, self.sigma, self.passes, self.lens = CASES[case]
        self.pipeline = pipeline
        self.frame = np.zeros((SIZE, SIZE), np.uint8)
        self.mask = np.zeros((SIZE, SIZE), np.uint8)
        self.noise = np.zeros((SIZE, SIZE), np.int16)
        self.shares = np.arange(self.subframes) / self.subframes * 0.02
        self.grid = np.arange(64, dtype=np.float32)
        self.bits = np.random.SFC64(1)
        cv2.setRNGSeed(1)
        if self.lens:
            axis = (np.arange(SIZE) + 0.5) / HALF - 1
            r2 = axis[None, :] ** 2 + axis[:, None] ** 2
            self.light = ((1 + r2 / FOCAL**2) ** (-BETA / 2)).astype(np.float32)
        if pipeline == "table" and self.sigma:
            from scipy.stats import norm

            deviates = norm.ppf((np.arange(65536) + 0.5) / 65536) * self.sigma
            self.fine = deviates.astype(np.float32)
            self.coarse = np.clip(np.rint(deviates), 0, 255).astype(np.uint8)
        self.dirty = []

    def centres(self, k):
        """Raster coordinates of the centres (sub-frames x 3), and image coordinates of the middle ones."""
        q2 = 1.2 * np.sin(k * 0.01)
        q1 = -0.3 * q2
        tip = q2 + self.shares
        jx, jy = DRUM * q1 + LINK1 * np.sin(q1), GROUND + DRUM + LINK1 * np.cos(q1)
        x, y = np.empty((2, self.subframes, 3))
        x[:, 0], y[:, 0], x[:, 1], y[:, 1] = DRUM * q1, GROUND + DRUM, jx, jy
        x[:, 2], y[:, 2] = jx + LINK2 * np.sin(tip), jy + LINK2 * np.cos(tip)
        if not self.lens:
            return HALF + SCALE * x, HALF - SCALE * y, None
        x *= 2 / FIELD
        y *= 2 / FIELD
        middle = self.subframes // 2
        u, v = distorted(x, y)
        return HALF + HALF * u, HALF - HALF * v, (x[middle], y[middle])

    def patches(self, k):
        """Base of the three boxes (grey levels, float32) and where they are."""
        x, y, middle = self.centres(k)
        radius = SCALE * RADIUS
        inverse = None
        reach = radius + 0.5
        if middle is not None:
            inverse, size = stretch(*middle)
            reach = radius * 1.3 + 0.5
        margin = reach + self.passes
        x0 = np.floor(x.min(0) - margin).astype(int)
        y0 = np.floor(y.min(0) - margin).astype(int)
        side = int(max((x.max(0) - x0).max(), (y.max(0) - y0).max()) + margin) + 1
        dx = self.grid[:side] - (x - x0 - 0.5).astype(np.float32)[:, :, None]
        dy = self.grid[:side] - (y - y0 - 0.5).astype(np.float32)[:, :, None]
        if inverse is None:
            dx *= dx
            dy *= dy
            grey = dx[:, :, None, :] + dy[:, :, :, None]
            np.sqrt(grey, out=grey)
            np.subtract(np.float32(radius + 0.5), grey, out=grey)
        else:
            # Raster y points down: the mixed terms change their sign.
            a, b, c, d = inverse.astype(np.float32)[:, None, :, None]
            s = (a * dx)[:, :, None, :] - (b * dy)[:, :, :, None]
            t = (d * dy)[:, :, :, None] - (c * dx)[:, :, None, :]
            s *= s
            t *= t
            s += t
            grey = np.sqrt(s, out=s)
            np.subtract(np.float32(radius), grey, out=grey)
            grey *= size.astype(np.float32)[:, None, None]
            grey += np.float32(0.5)
        np.clip(grey, 0, 1, out=grey)
        grey = grey[0] if self.subframes == 1 else np.add.reduce(grey, 0)
        grey *= np.float32(255 / self.subframes)
        boxes = [(slice(b, b + side), slice(a, a + side)) for a, b in zip(x0.tolist(), y0.tolist())]
        if self.lens:
            for base, box in zip(grey, boxes):
                base *= self.light[box]
        for _ in range(self.passes):
            for base in grey:
                cv2.filter2D(base, -1, MASK, dst=base)
        return grey, boxes, x0, y0

    def make(self, grey, boxes):
        """The whole quantised frame."""
        frame = self.frame
        if not self.sigma:
            for box in self.dirty:
                frame[box] = 0
            for base, box in zip(np.rint(grey).astype(np.uint8), boxes):
                frame[box] = base
            self.dirty = boxes
            return
        if self.pipeline == "table":
            words = self.bits.random_raw(SIZE * SIZE // 4).view(np.uint16).reshape(SIZE, SIZE)
            self.frame = frame = cv2.LUT(words, self.coarse)
            for base, box in zip(grey, boxes):
                base += self.fine[words[box]]
        else:
            cv2.randn(self.noise, 0, self.sigma)
            for base, box in zip(grey, boxes):
                base += self.noise[box]
            # Saturate: negative to 0; 255 is 17 standard deviations away. The low bytes are then the frame.
            np.maximum(self.noise, 0, out=self.noise)
            cv2.extractChannel(self.noise.view(np.uint8).reshape(SIZE, SIZE, 2), 0, frame)
        np.rint(grey, out=grey)
        np.clip(grey, 0, 255, out=grey)
        for base, box in zip(grey.astype(np.uint8), boxes):
            frame[box] = base

    def see(self, boxes, x0, y0):
        """Centroids, right and above of the image centre."""
        if self.pipeline in ("labels", "operators"):
            cv2.threshold(self.frame, LEVEL - 1, 255, cv2.THRESH_BINARY, dst=self.mask)
            if self.pipeline == "labels":
                count, _, stats, centroids = cv2.connectedComponentsWithStatsWithAlgorithm(
                    self.mask, 8, cv2.CV_16U, cv2.CCL_SPAGHETTI
                )
                found = zip(centroids[1:count].tolist(), stats[1:count, 4].tolist())
                return [(x + 0.5 - HALF, HALF - 0.5 - y) for (x, y), area in found if 40 <= area <= 130]
            # Contours find the regions in a tenth of the time of labels for the whole frame.
            contours, _ = cv2.findContours(self.mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
            seen = []
            for contour in contours:
                x, y, width, height = cv2.boundingRect(contour)
                moments = cv2.moments(self.mask[y : y + height, x : x + width], True)
                if 40 <= (area := moments["m00"]) <= 130:
                    seen.append((moments["m10"] / area + x + 0.5 - HALF, HALF - 0.5 - moments["m01"] / area - y))
            return seen
        seen = []
        for box, x, y in zip(boxes, x0.tolist(), y0.tolist()):
            _, mask = cv2.threshold(self.frame[box], LEVEL - 1, 255, cv2.THRESH_BINARY)
            count, _, stats, centroids = cv2.connectedComponentsWithStats(mask, connectivity=8, ltype=cv2.CV_16U)
            for i in range(1, count):
                if 40 <= stats[i, 4] <= 130:
                    seen.append((centroids[i, 0] + x + 0.5 - HALF, HALF - 0.5 - centroids[i, 1] - y))
        return seen

    def shoot(self, k):
        grey, boxes, x0, y0 = self.patches(k)
        self.make(grey, boxes)
        return self.see(boxes, x0, y0)

    def measure(self, first, count):
        times, seen = [], []
        for k in range(first, first + count):
            began = time.perf_counter()
            seen = self.shoot(k)
            times.append((time.perf_counter() - began) * 1e6)
        return times, seen


def main():
    if "--serve" not in sys.argv:
        for case in CASES:
            for pipeline in PIPELINES:
                times, seen = Camera(case, pipeline).measure(0, 500)
                print(f"{case:4} {pipeline:10} p10 {np.percentile(times, 10):8.1f}  median {np.median(times):8.1f}",
                      len(seen), "circles")
        return
    cameras = {}
    for line in sys.stdin:
        case, pipeline, first, count = line.split()
        key = case, pipeline
        if key not in cameras:
            cameras[key] = Camera(*key)
        times, seen = cameras[key].measure(int(first), int(count))
        print(json.dumps({"times_us": times, "values": [v for centre in sorted(seen, key=lambda c: c[1]) for v in centre]}), flush=True)


if __name__ == "__main__":
    main()
