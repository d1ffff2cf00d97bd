// Lights an octahedron under an even sky: every vertex sees the sky above it, and nothing else.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "mesh/load.h"
#include "prt/precompute.h"
#include "prt/visibility/ray_scene.h"
#include "relight/relighter.h"

int main(int argc, char** argv) {
    using namespace relumine;
    if (argc != 2)
        return 2;
    const mesh::TriangleMesh mesh = mesh::load(argv[1]);
    const prt::RayScene rays(mesh);
    const prt::Transfer transfer =
        prt::precompute(prt::vertex_receivers(mesh), rays,
                        {.face_resolution = 16, .bias = prt::automatic_bias(mesh)});
    const std::vector<glm::vec3> radiance =
        relight::relight(transfer, cubemap::CubeMap(16, glm::vec3(1.0f)));
    // A vertex of a convex mesh sees all of the sky above it: radiance 1, up to the size of
    // clusters.
    float error = 0.0f;
    for (const glm::vec3& color : radiance)
        error = std::max(error, std::abs(color.g - 1.0f));
    std::printf("%zu vertices, error %.4f\n", radiance.size(), static_cast<double>(error));
    return radiance.size() == 6 && error < 0.01f ? 0 : 1;
}
