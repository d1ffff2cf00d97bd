// Finds light: an environment, distant lights, or the gains of given lights, under which a scene
// looks as it should.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "prt/work.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"

namespace relumine {

/// How a scene should look.
struct FitTarget {
    /// [num_receivers] the radiance() that receivers should have.
    std::vector<glm::vec3> radiance;
    /// [num_receivers] factors of squared errors; 0 where nothing is known.
    std::vector<float> weights;
};

/// Takes values of all receivers, as Painter::values() makes them: radiance times albedo.
///
/// Shape:   `values` and `albedo` are [num_receivers].
/// Throws:  std::invalid_argument for other numbers of values, values that are negative or not
///          finite, or nothing to fit to: all black, or no receiver that reflects light.
[[nodiscard]] FitTarget target_of_values(const Scene& scene, std::span<const glm::vec3> values,
                                         std::span<const glm::vec3> albedo);

/// Takes a picture of the scene, as draw() makes it with these options, of its camera and albedo.
/// Pixels that show the background, an added floor or the backs of surfaces say nothing. A vertex
/// gets the mean of the pixels around it, each with its part in them.
///
/// Throws:  std::invalid_argument for a picture of another size than the scene's pixels or texels,
///          and as target_of_values().
[[nodiscard]] FitTarget target_of_picture(const LitScene& lit, const Picture& picture,
                                          const OutputOptions& options);

/// Returns how far the scene's present light is from the target: relative L2.
[[nodiscard]] double distance_to(const FitTarget& target, const LitScene& lit);

/// Returns so many distant lights whose direct light on what a picture of a mesh shows comes
/// nearest to it: each pixel's point is a receiver of its own, so shadows are as sharp as the
/// picture's. The scene has vertices, and is lit with the lights afterwards. `distance` receives
/// how far the pixels are from the picture: relative L2.
///
/// Throws:  as target_of_picture() and fit_lights().
std::vector<lights::DistantLight> fit_lights_to_picture(LitScene& lit, const Picture& picture,
                                                        const OutputOptions& options,
                                                        std::size_t count, double& distance,
                                                        const prt::Work& work = {});

struct EnvironmentFit {
    /// R of the environment: 6 x R x R texels.
    std::uint32_t face_resolution = 16;
    /// How much the light of neighbouring texels resists to differ: the weight of the mean squared
    /// difference, relative to the mean light. 0: not at all.
    double smoothness = 1e-3;
    /// How much each texel resists to shine: the weight of the mean light. It leaves few texels.
    double sparsity = 0.0;
    std::size_t max_iterations = 300;
};

/// Returns the environment, nowhere negative, whose light comes nearest to the target in the least
/// squares, and lights the scene with it. After bounce() light that bounces counts. Scenes with
/// LightOptions::clusters_only suit it best: which lights are traced changes from step to step.
///
/// Cost:    a relight and its adjoint for each iteration.
/// Throws:  std::invalid_argument for another number of receivers, or receivers with highlights;
///          prt::Cancelled.
cubemap::CubeMap fit_environment(LitScene& lit, const FitTarget& target,
                                 const EnvironmentFit& options = {}, const prt::Work& work = {});

/// Returns so many distant lights, or fewer where more would not help, whose direct light comes
/// nearest to the target, and lights the scene with them. relight::fit_lights() says how.
///
/// Throws:  as relight::fit_lights(), and std::invalid_argument for receivers with highlights.
std::vector<lights::DistantLight> fit_lights(LitScene& lit, const FitTarget& target,
                                             std::size_t count, const prt::Work& work = {});

/// Returns how bright each of some lights has to be, >= 0, to come nearest to the target together.
/// After bounce() light that bounces counts. The scene is left in the light of the last one.
///
/// Throws:  std::invalid_argument for no lights or another number of receivers; as
///          LitScene::light().
std::vector<double> fit_gains(LitScene& lit, const FitTarget& target, std::span<const Light> lights,
                              const prt::Work& work = {});

} // namespace relumine
