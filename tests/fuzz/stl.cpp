#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace relumine;
    fuzz::read_mesh([&] { return mesh::read_stl(fuzz::bytes(data, size)); });
    return 0;
}
