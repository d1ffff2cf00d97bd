#include "relumine/in/coarsen.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "prt/clusters/coarsening.h"

namespace relumine {

Scene coarsened(Scene scene, float tolerance, const prt::Work& work) {
    if (!has_clusters(scene))
        throw std::invalid_argument("coarsen: expected a scene with clusters");
    const float own = rms_tolerance(scene);
    if (!std::isfinite(tolerance) || tolerance < own)
        throw std::invalid_argument(fmt::format(
            "expected a tolerance of at least {}, which the scene was made with, got {}", own,
            tolerance));
    if (tolerance == own)
        return scene;
    scene.transfer = prt::coarsened(scene.transfer,
                                    {.tolerance = tolerance,
                                     .min_level = scene.settings.min_level,
                                     .face_resolution = scene.settings.face_resolution},
                                    work);
    scene.settings.tolerance = tolerance;
    scene.settings.epsilon.reset();
    if (scene.bounces)
        scene.bounces->rays = {}; // they were chosen by other clusters
    return scene;
}

} // namespace relumine
