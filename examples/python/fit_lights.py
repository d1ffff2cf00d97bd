"""Finds the lights of a picture: fit_lights.py MESH OUT.png

Relighting is linear: a picture is the sum of the pictures of its lights, each times an intensity.
So the intensities that come nearest to a target picture are one small least-squares problem, solved
in milliseconds. Here the target is a picture of three lights out of twelve, with noise; a real one
may be a photograph from the same view.
"""

import sys
import time

import numpy as np

import relumine

if len(sys.argv) != 3:
    sys.exit("fit_lights.py MESH OUT.png")
path, output = sys.argv[1:]
mesh = relumine.Mesh.load(path, floor=33)
scene = relumine.precompute(mesh, tolerance=0.05, receivers="pixels:320x240", view="auto")
relighter = relumine.Relighter(scene, clusters_only=True)  # soft boxes need no shadow rays
relighter.set_environment(relumine.Environment(np.zeros((6, 64, 64, 3))))

# Twelve soft boxes: two rings and one above.
azimuths = np.radians(np.arange(11) * 360 / 11)
heights = np.where(np.arange(11) % 2, 0.35, 1.0)
directions = [(np.sin(a), h, np.cos(a)) for a, h in zip(azimuths, heights)] + [(0, 1, 0)]


def boxes(intensities):
    """One layer for each direction, of a colour."""
    return [
        relumine.Layer(f"box {i}", relumine.Rectangle(w, 25, 25, softness=0.3),
                       relumine.Emit(tuple(map(float, color))))
        for i, (w, color) in enumerate(zip(directions, intensities))
    ]  # fmt: skip


def picture():
    return relighter.picture(background="none", albedo=0.6)


def non_negative_fit(basis, target):
    """Least squares with x >= 0: lights that come out negative are left out, one by one."""
    products, right = basis.T @ basis, basis.T @ target
    used = list(range(len(right)))
    while True:
        x = np.linalg.solve(products[np.ix_(used, used)], right[used])
        if not used or x.min() >= 0:
            result = np.zeros(len(right))
            result[used] = x
            return result
        del used[int(np.argmin(x))]


hidden = np.zeros((12, 3))
hidden[2], hidden[7], hidden[11] = (20, 14, 8), (3, 6, 12), (2, 2, 2)
relighter.set_layers(boxes(hidden))
target = picture()
noise = np.random.default_rng(1).normal(0, 0.01, (*target.shape[:2], 3))
noisy = np.asarray(target)[..., :3] + noise

start = time.perf_counter()
basis = []
for i in range(12):
    relighter.set_layers(boxes(np.eye(12)[:, [i]] * np.ones(3)))
    basis.append(np.asarray(picture())[..., :3].copy())
drawn = time.perf_counter()
basis = np.stack(basis, axis=-1)  # [height, width, RGB, light]
found = np.stack(
    [non_negative_fit(basis[:, :, c].reshape(-1, 12), noisy[:, :, c].ravel()) for c in range(3)],
    axis=-1,
)
solved = time.perf_counter()

relighter.set_layers(boxes(found))
fitted = picture()
error = np.linalg.norm(fitted - target) / np.linalg.norm(target)
print(f"{1e3 * (drawn - start):.0f} ms for 12 pictures, {1e3 * (solved - drawn):.0f} ms to fit")
for i, (true, color) in enumerate(zip(hidden, found)):
    print(f"box {i:2}: {np.round(true, 2)} found {np.round(color, 2)}")
print(f"relative difference of the pictures {error:.4f}")
both = np.concatenate([np.dstack([noisy, np.asarray(target)[..., 3]]), fitted], axis=1)
relumine.Picture(np.maximum(both, 0), exposure=target.exposure).save(output)
sys.exit(0 if error < 0.02 else 1)
