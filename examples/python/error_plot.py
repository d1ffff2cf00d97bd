"""Error against tolerance: error_plot.py MESH ENVIRONMENT PLOT.png [SAMPLES]"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import relumine

if len(sys.argv) < 4:
    sys.exit("error_plot.py MESH ENVIRONMENT PLOT.png [SAMPLES]")
mesh_path, environment_path, output = sys.argv[1:4]
samples = int(sys.argv[4]) if len(sys.argv) > 4 else 500
mesh = relumine.Mesh.load(mesh_path, floor=49)
environment = relumine.Environment.load(environment_path)
tolerances, errors, clusters = [0.16, 0.08, 0.04, 0.02], [], []
for tolerance in tolerances:
    scene = relumine.precompute(mesh, tolerance=tolerance, min_depth=1, bounces=False)
    # Without shadow rays of the sun's own, so that the clusters alone are measured.
    relighter = relumine.Relighter(scene, clusters_only=True)
    relighter.set_environment(environment)
    errors.append(100 * relighter.verify(samples, surface=0).relative_l2)
    clusters.append(relighter.scene.num_clusters)
    print(f"tolerance {tolerance}: {clusters[-1]} clusters, {errors[-1]:.2f} %")

figure, axes = plt.subplots(figsize=(6, 4), layout="constrained")
axes.loglog(tolerances, errors, "o-")
for point in zip(tolerances, errors, clusters):
    axes.annotate(f"{point[2]} clusters", point[:2], (6, -12), textcoords="offset points")
axes.set(xlabel="tolerance (1/sr)", ylabel="relative L2 error (%)",
         title="Relighting against exact integration")  # fmt: skip
axes.set_xticks(tolerances, [f"{t:g}" for t in tolerances])
axes.set_yticks(errors, [f"{e:.2g}" for e in errors])
axes.minorticks_off()
axes.margins(0.25, 0.15)
axes.grid(alpha=0.3)
figure.savefig(output, dpi=120)
