// Lights an octahedron under an even sky. Prints the brightest vertex: 1 where nothing is in the way of the sky.
#include <algorithm>
#include <cstdio>

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
    const float brightest =
        std::ranges::max(radiance, {}, [](const glm::vec3& color) { return color.g; }).g;
    std::printf("%zu vertices, radiance %.3f\n", radiance.size(), static_cast<double>(brightest));
    return brightest > 0.5f && brightest < 1.001f ? 0 : 1;
}
