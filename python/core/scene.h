// What each source of the module binds.
#pragma once

#include <memory>

#include <pybind11/pybind11.h>

#include "relumine/relumine.h"

namespace relumine::python {

/// An image and what was made of it. Never changes.
struct EnvironmentHandle {
    Environment made;
    /// As the image had it, for turns anew.
    std::string from;
    EnvironmentOptions options;
};

void bind_scenes(pybind11::module_& module);
void bind_environments(pybind11::module_& module);
void bind_lights(pybind11::module_& module);
void bind_relighters(pybind11::module_& module);

} // namespace relumine::python
