"""Finds an environment by gradients: gradient.py SCENE.prt ENV OUT.png

The adjoint of a relight gives the derivative of a loss by every texel at once. Here the loss is the
squared distance to the radiance under another environment, which is thrown away; descent along the
gradient, never below zero, finds light that looks the same.
"""

import sys

import numpy as np

import relumine

if len(sys.argv) != 4:
    sys.exit("gradient.py SCENE.prt ENV OUT.png")
scene_path, environment_path, output = sys.argv[1:]
relighter = relumine.Relighter(relumine.Scene.load(scene_path), clusters_only=True)
relighter.set_environment(relumine.Environment.load(environment_path, face_resolution=16))
target = relighter.radiance.copy()


def loss_and_gradient(light):
    relighter.set_environment(relumine.Environment(light, face_resolution=16))
    error = relighter.radiance - target
    return np.sum(error.astype(float) ** 2), 2 * relighter.adjoint(error).astype(float)


light = np.full((6, 16, 16, 3), target.mean())
loss, gradient = loss_and_gradient(light)
first_loss, step = loss, 0.1 * light.mean() / np.abs(gradient).max()
for iteration in range(60):
    following = np.maximum(light - step * gradient, 0)
    new_loss, new_gradient = loss_and_gradient(following)
    # The step of Barzilai and Borwein: how the gradient changed along the last one.
    moved, turned = following - light, new_gradient - gradient
    step = np.sum(moved**2) / max(np.sum(moved * turned), 1e-30)
    light, loss, gradient = following, new_loss, new_gradient
    if iteration % 20 == 19:
        print(f"step {iteration + 1}: {np.sqrt(loss / np.sum(target.astype(float) ** 2)):.4f} off")
relighter.picture(size=(320, 240)).save(output)
sys.exit(0 if loss < 1e-2 * first_loss else 1)
