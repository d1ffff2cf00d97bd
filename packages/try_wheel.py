"""README's lines in an environment that has the wheel and numpy alone: the same light as the program's."""

import numpy as np

import relumine

scene = relumine.precompute(relumine.Mesh.load("knot.ply"))
relighter = relumine.Relighter(scene)
relighter.set_environment(relumine.Environment.load("soft_boxes_latlong.exr"))
assert relighter.picture().png()
radiance = np.load("program.npy")
difference = np.linalg.norm(relighter.radiance - radiance) / np.linalg.norm(radiance)
print(f"relumine {relumine.__version__}: {scene.num_receivers} receivers, {difference:.1e} from the program's light")
assert difference < 1e-6
