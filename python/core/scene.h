// What each source of the module binds.
#pragma once

#include <memory>
#include <mutex>
#include <string>

#include <pybind11/pybind11.h>

#include "relumine/in/move.h"
#include "relumine/relumine.h"

namespace relumine::python {

/// An image as a cube map that was not turned, once a turn has asked for it.
struct Resampled {
    std::mutex mutex;
    std::shared_ptr<const cubemap::CubeMap> map;
};

/// An image and what was made of it. Never changes.
struct EnvironmentHandle {
    Environment made;
    /// Shared with all turns of one resolution.
    std::shared_ptr<Resampled> resampled = std::make_shared<Resampled>();
    EnvironmentOptions options;
};

/// `to`: a matrix, 16 doubles, row by row; or "away" or "back".
[[nodiscard]] GroupMove group_move(const std::string& name, const pybind11::object& to);
/// The same of a dict: {name: to}.
[[nodiscard]] std::vector<GroupMove> group_moves(const pybind11::dict& moves);
[[nodiscard]] pybind11::dict move_figures(const MoveReport& report);

void bind_scenes(pybind11::module_& module);
void bind_environments(pybind11::module_& module);
void bind_lights(pybind11::module_& module);
void bind_relighters(pybind11::module_& module);

} // namespace relumine::python
