#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(obj) {
    using namespace relumine;
    fuzz::read_mesh([&] { return mesh::read_obj(fuzz::bytes(data, size), fuzz::folder()); });
    return 0;
}
