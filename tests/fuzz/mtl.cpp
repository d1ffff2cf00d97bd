// A material library, through an OBJ that names it and two of its materials.
#include "tests/fuzz/mesh_target.h"

RELUMINE_FUZZ_TARGET(mtl) {
    using namespace relumine;
    static constexpr std::string_view Obj =
        "mtllib input.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt "
        "0 1\nusemtl red\nf 1/1 2/2 3/3\nusemtl shiny\nf 1/1 3/3 2/2\n";
    static_cast<void>(fuzz::file("input.mtl", fuzz::bytes(data, size)));
    fuzz::read_mesh([&] { return mesh::read_obj(std::as_bytes(std::span(Obj)), fuzz::folder()); });
    return 0;
}
