"""A ball that is no mesh throws its shadow on a floor: own_blockers.py OUT.png

Whatever can say which rays are blocked takes the place of the mesh's triangles: a formula, a
distance field, a voxel grid, a ray tracer of your own.
"""

import sys

import numpy as np

import relumine

if len(sys.argv) != 2:
    sys.exit("own_blockers.py: expected OUT.png")

CENTRE, RADIUS = np.array([0, 1, 0], np.float32), 0.7


def blocked(origins, directions):
    """Which of the rays meet the ball: (N, 3), (N, 3) -> (N,) booleans."""
    to_centre = CENTRE - origins
    along = (to_centre * directions).sum(axis=1)
    off = (to_centre**2).sum(axis=1) - along**2
    return (along > 0) & (off < RADIUS**2)


# A floor of 81 x 81 vertices.
side = np.linspace(-3, 3, 81)
x, z = np.meshgrid(side, side, indexing="ij")
vertices = np.stack([x, 0 * x, z], axis=-1).reshape(-1, 3)
i = np.arange(81 * 81).reshape(81, 81)
corners = [i[:-1, :-1], i[:-1, 1:], i[1:, 1:], i[1:, :-1]]
a, b, c, d = (corner.ravel() for corner in corners)
triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])

scene = relumine.precompute(
    vertices,
    triangles,
    tolerance=0.05,
    blockers_function=blocked,
    refine=False,
    bounces=False,
)
relighter = relumine.Relighter(scene)  # its sharp lights ask `blocked`, too

# An even sky: the ball takes away (radius / distance)^2 times the cosine towards it.
relighter.set_environment(relumine.Environment(np.ones((6, 16, 16, 3))))
to_centre = CENTRE - scene.positions
distance = np.sqrt((to_centre**2).sum(axis=1))
expected = 1 - to_centre[:, 1] / distance * (RADIUS / distance) ** 2
error = np.abs(relighter.radiance[:, 0] - expected).mean()
print(f"{scene}: {error:.4f} from the formula on average")

relighter.save(sys.argv[1], size=(640, 480))
