#include "app/options/eye_options.h"

#include <stdexcept>

#include <fmt/format.h>

#include "relumine/ask/questions.h"

namespace relumine::app {

OptionRow glossy_tolerance_row(EyeOptions& options) {
    return row("--glossy-tolerance", options.tolerance,
               "error of highlights that follow the eye, as a part of what a white matt surface "
               "sends",
               {.min = 1e-5, .max = 1});
}

void require_live_highlights(const Scene& scene, const std::filesystem::path& path) {
    if (!has_live_highlights(scene))
        throw std::runtime_error(fmt::format(
            "{}: expected vertices with glossy materials, precomputed without --view, got none",
            path.string()));
}

void warn_of_eye_inside(const LitScene& lit, const std::optional<glm::dvec3>& eye,
                        const Session& session) {
    if (eye && is_inside(lit, place_in(lit.scene().mesh, *eye)))
        session.warn(fmt::format("the eye {} is inside of the mesh: it sees the backs of surfaces",
                                 PointText::show(*eye)));
}

void warn_of_smooth_surfaces(std::size_t num_receivers, const Session& session) {
    if (num_receivers != 0)
        session.warn(fmt::format("{} receivers are smoother than roughness {:.2f}: highlights that "
                                 "follow the eye are wider there",
                                 num_receivers, relight::NarrowestLiveRoughness));
}

} // namespace relumine::app
