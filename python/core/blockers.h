// Blockers that Python answers for.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "relumine/light/lit_scene.h"

namespace relumine::python {

namespace py = pybind11;

/// Returns blockers that call `function(origins, directions)`, arrays of [N, 3], which returns N
/// bytes: not 0 where a ray is blocked. None: null. Whatever thread asks takes Python's lock for
/// the call; what the function raises passes through the work. Call with Python's lock.
[[nodiscard]] std::shared_ptr<const prt::Blockers> blockers_of(const py::object& function);

} // namespace relumine::python
