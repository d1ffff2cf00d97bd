"""A relight as a function of torch: torch_gradient.py SCENE.prt OUT.png

relumine.torch.relight() is the radiance under an environment, and torch finds its derivative by
adjoint(). Without torch (Debian's python3-torch) the program says so and ends.
"""

import sys

import relumine

if len(sys.argv) != 3:
    sys.exit("torch_gradient.py SCENE.prt OUT.png")
try:
    import torch

    from relumine.torch import relight
except ImportError:
    print("torch is not there: nothing to show")
    sys.exit(0)
relighter = relumine.Relighter(relumine.Scene.load(sys.argv[1]), clusters_only=True)


with torch.no_grad():
    target = relight(relighter, torch.rand(6, 8, 8, 3, generator=torch.Generator().manual_seed(1)))
logarithm = torch.full((6, 8, 8, 3), -1.0, requires_grad=True)
optimizer = torch.optim.Adam([logarithm], lr=0.1)
losses = []
for _ in range(60):
    optimizer.zero_grad()
    loss = ((relight(relighter, logarithm.exp()) - target) ** 2).sum()
    loss.backward()
    optimizer.step()
    losses.append(loss.item())
print(f"the loss fell from {losses[0]:.4g} to {losses[-1]:.4g}")
relighter.picture(size=(320, 240)).save(sys.argv[2])
sys.exit(0 if losses[-1] < 0.05 * losses[0] else 1)
