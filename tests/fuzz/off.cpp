#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(off) {
    using namespace relumine;
    fuzz::read_mesh([&] { return mesh::read_off(fuzz::bytes(data, size)); });
    return 0;
}
