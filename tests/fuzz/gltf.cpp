#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(gltf) {
    using namespace relumine;
    fuzz::read_mesh([&] {
        return mesh::read_gltf(fuzz::bytes(data, size), fuzz::folder(), {.max_bytes = 1u << 28});
    });
    // Animations and variants, for files that have them.
    fuzz::read_mesh([&] {
        return mesh::read_gltf(
            fuzz::bytes(data, size), fuzz::folder(),
            {.pose = mesh::Pose{"0", 0.5}, .variant = "0", .max_bytes = 1u << 28});
    });
    return 0;
}
