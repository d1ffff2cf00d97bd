// Measured BRDFs.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "mesh/materials/brdf_table.h"

namespace relumine::python {

/// relumine.Brdf's table.
struct Brdf {
    std::shared_ptr<const mesh::BrdfTable> table;
};

void bind_brdfs(pybind11::module_& module);

} // namespace relumine::python
