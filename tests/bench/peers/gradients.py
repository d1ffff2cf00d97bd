"""Gradients: the derivative of a picture's loss by the environment, Mitsuba's beside `adjoint()`."""
import numpy as np

import scenes
import truth

#: The environment's lat-long is derived in blocks of so many pixels, since Mitsuba's texels are bilinear and ours flat.
BLOCK = 4
HEIGHT = 32


def blocks(gradient):
    """(H, 2 H, 3) summed over blocks."""
    height, width, _ = gradient.shape
    return gradient.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK, 3).sum((1, 3))


def run(peers, quick):
    """Prints how far two derivatives differ, and what each took."""
    found = {peer.name: peer for peer in peers if peer.name in ("Relumine", "Mitsuba")}
    if len(found) < 2:
        return
    scene, _, _ = truth.box(0)
    scene["light"] = scenes.light(scenes.lobes(scenes.dome_directions(HEIGHT)))
    size = scene["camera"]["size"]
    weights = np.random.default_rng(1).uniform(0, 1, (size, size, 3)).astype(np.float32)
    print("\n### Gradients\n\n| of | samples a pixel | processor seconds | peak MB | off a converged one (L2) | loss of the gradient over that of the picture |\n" + "|---" * 6 + "|")
    rows = []
    own = found["Relumine"]
    own.build({**scene, "pixels": True, "gradient": True, "background": "none"})
    rows.append(("Relumine", "-", own, own.gradient(weights, HEIGHT)))
    peer = found["Mitsuba"]
    peer.build(scene)
    counts = (16, 256) if quick else (16, 256, 4096)
    for samples in counts:
        rows.append(("Mitsuba", samples, peer, peer.gradient(weights, samples)))
        rows[-1] += (peer.processor, peer.peak)
    wanted = blocks(rows[-1][3])
    rows[0] += (own.processor, own.peak)
    loss = float((own.picture(64) * weights).sum())
    for name, samples, _, gradient, processor, peak in rows:
        off = np.linalg.norm(blocks(gradient) - wanted) / np.linalg.norm(wanted)
        share = float((gradient * scene["light"]["dome"]).sum()) / loss
        print(f"| {name} | {samples} | {processor:.3f} | {peak / 1e6:.0f} | {off:.4f} | {share:.4f} |", flush=True)
