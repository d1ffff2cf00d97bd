#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(gltf) {
    using namespace relumine;
    fuzz::read_mesh(
        [&] { return mesh::read_gltf(fuzz::bytes(data, size), fuzz::folder(), {}, 1u << 28); });
    return 0;
}
