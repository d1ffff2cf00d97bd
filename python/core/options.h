// Options of calls: Python's keyword arguments, by the names of the command line.
#pragma once

#include <pybind11/pybind11.h>

#include "relumine/in/precompute_table.h"
#include "relumine/options/option_table.h"
#include "relumine/relumine.h"

namespace relumine::python {

namespace py = pybind11;

/// Sets options from keyword arguments. None is the same as not given. A list counts as its values
/// with commas between, so everything is read as the command line reads it.
///
/// Throws:  OptionError "--floor-albedo: expected X, got 'Y'"; py::type_error for a name that the
///          table does not have.
void take(const OptionTable& table, const py::dict& given);

template<typename Options>
[[nodiscard]] Options options_from(const py::dict& given) {
    Options options;
    take(options_of(options), given);
    return options;
}

/// The options of pictures for signatures, help and tests: [(name, default, help, another value)].
/// A default is None, a number, a truth value or text.
void bind_options(py::module_& module);

} // namespace relumine::python
