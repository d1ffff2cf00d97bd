// What all mesh formats have in common for fuzzing.
#pragma once

#include "mesh/formats/polygon_soup.h"
#include "tests/fuzz/fuzz.h"

namespace relumine::fuzz {

/// Requires what mesh::TriangleMesh promises.
void require_sound(const mesh::TriangleMesh& mesh);

/// Reads a mesh the way mesh::load() does; `read` is one of the readers of
/// mesh/formats/polygon_soup.h.
template<typename Read>
void read_mesh(const Read& read) {
    if (const auto mesh = accepted([&] { return mesh::to_mesh(read(), mesh::NormalSource::File); }))
        require_sound(*mesh);
}

} // namespace relumine::fuzz
