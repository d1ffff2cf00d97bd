// relumine._core, the compiled part of the Python package. Its users are the Python sources beside
// it, which check arguments and say what everything means.
#include <optional>
#include <string>

#include <pybind11/pybind11.h>

#include "arrays.h"
#include "brdf.h"
#include "files/parallel.h"
#include "options.h"
#include "relumine/relumine.h"
#include "run.h"
#include "scene.h"

namespace relumine::python {

namespace {

/// 0: all.
void set_threads(unsigned count) {
    static std::optional<files::ThreadLimit> control;
    control.reset();
    if (count != 0)
        control.emplace(count);
}

} // namespace

} // namespace relumine::python

PYBIND11_MODULE(_core, module) {
    using namespace relumine::python;
    // pybind11 knows std::bad_alloc, std::invalid_argument (ValueError) and std::out_of_range
    // (IndexError); all other exceptions are RuntimeErrors.
    py::register_exception_translator([](std::exception_ptr error) {
        try {
            std::rethrow_exception(error);
        } catch (const relumine::MemoryLimitExceeded& limit) {
            PyErr_SetString(PyExc_MemoryError, limit.what());
        } catch (const relumine::OptionError& wrong) { // floor_albedo for --floor-albedo
            const std::string name = relumine::OptionRow{{}, wrong.option}.key();
            const std::string text = name.empty() ? wrong.what() : name + ": " + wrong.reason;
            PyErr_SetString(PyExc_ValueError, text.c_str());
        }
    });
    bind_arrays(module);
    bind_run(module);
    bind_options(module);
    bind_brdfs(module);
    bind_scenes(module);
    bind_environments(module);
    bind_lights(module);
    bind_relighters(module);
    module.def("set_threads", &set_threads);
    module.attr("__version__") = std::string(relumine::version());
}
