#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(ply) {
    using namespace relumine;
    fuzz::read_mesh([&] { return mesh::read_ply(fuzz::bytes(data, size)); });
    return 0;
}
