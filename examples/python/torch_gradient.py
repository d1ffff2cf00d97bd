"""A relight as a function of torch: torch_gradient.py SCENE.prt OUT.png

Relight.apply(texels) is the radiance under an environment, and torch finds its derivative by
adjoint(). Without torch (Debian's python3-torch) the program says so and ends.
"""

import sys

import numpy as np

import relumine

if len(sys.argv) != 3:
    sys.exit("torch_gradient.py SCENE.prt OUT.png")
try:
    import torch
except ImportError:
    print("torch is not there: nothing to show")
    sys.exit(0)
relighter = relumine.Relighter(relumine.Scene.load(sys.argv[1]), clusters_only=True)


class Relight(torch.autograd.Function):
    """(6, R, R, 3) radiance of texels -> (num_receivers, 3)."""

    @staticmethod
    def forward(context, texels):
        cube = np.maximum(texels.detach().numpy(), 0)
        relighter.set_environment(relumine.Environment(cube, face_resolution=cube.shape[1]))
        return torch.from_numpy(relighter.radiance.copy())

    @staticmethod
    def backward(context, weights):
        return torch.from_numpy(relighter.adjoint(weights.numpy()).copy())


with torch.no_grad():
    target = Relight.apply(torch.rand(6, 8, 8, 3, generator=torch.Generator().manual_seed(1)))
logarithm = torch.full((6, 8, 8, 3), -1.0, requires_grad=True)
optimizer = torch.optim.Adam([logarithm], lr=0.1)
losses = []
for _ in range(60):
    optimizer.zero_grad()
    loss = ((Relight.apply(logarithm.exp()) - target) ** 2).sum()
    loss.backward()
    optimizer.step()
    losses.append(loss.item())
print(f"the loss fell from {losses[0]:.4g} to {losses[-1]:.4g}")
relighter.picture(size=(320, 240)).save(sys.argv[2])
sys.exit(0 if losses[-1] < 0.05 * losses[0] else 1)
