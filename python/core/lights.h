// Light lists as arrays.
#pragma once

#include <tuple>
#include <vector>

#include <pybind11/pybind11.h>

#include "arrays.h"
#include "relumine/light/light_lists.h"

namespace relumine::python {

/// Directions [n, 3], irradiances [n, 3], solid angles [n].
using LightArrays = std::tuple<Array, Array, Array>;

[[nodiscard]] LightArrays arrays_of(const std::vector<lights::DistantLight>& lights);
[[nodiscard]] std::vector<lights::DistantLight> lights_of(const py::buffer& directions,
                                                          const py::buffer& irradiances,
                                                          const py::buffer& solid_angles);

} // namespace relumine::python
