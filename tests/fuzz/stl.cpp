#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(stl) {
    using namespace relumine;
    fuzz::read_mesh([&] { return mesh::read_stl(fuzz::bytes(data, size)); });
    return 0;
}
