// Lights an octahedron under an even sky: every vertex sees the sky above it, and nothing else.
#include <algorithm>
#include <cmath>
#include <cstdio>

// An engine's own header, which has the name of one of Relumine's.
#include "mesh/triangle_mesh.h"
#include "relumine/cubemap/resample/save_environment.h"
#include "relumine/relumine.h"

static_assert(RELUMINE_VERSION >= 100, "the first version");

int main(int argc, char** argv) {
    using namespace relumine;
    if (argc != 2)
        return 2;
    LitScene lit(precompute(load_mesh(argv[1]), {.face_resolution = 16, .no_refine = true}));
    lit.light(cubemap::CubeMap(16, glm::vec3(1.0f)));
    // A vertex of a convex mesh sees all of the sky above it: radiance 1, up to the size of
    // clusters.
    float error = 0.0f;
    for (const glm::vec3& color : lit.radiance())
        error = std::max(error, std::abs(color.g - 1.0f));
    std::printf("%s, version %s: %zu vertices, error %.4f\n", engine::name, version().data(),
                lit.radiance().size(), static_cast<double>(error));
    return lit.radiance().size() == 6 && error < 0.01f ? 0 : 1;
}
