// Measured BRDFs, and profiles of lamps.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "relumine/in/mesh_files.h"

namespace relumine::python {

/// relumine.Brdf's table.
struct Brdf {
    std::shared_ptr<const mesh::BrdfTable> table;
};

void bind_brdfs(pybind11::module_& module);

} // namespace relumine::python
