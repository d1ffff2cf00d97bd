#include "tests/fuzz/mesh_target.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace relumine;
    fuzz::read_mesh(
        [&] { return mesh::read_gltf(fuzz::bytes(data, size), fuzz::folder(), {}, 1u << 28); });
    return 0;
}
