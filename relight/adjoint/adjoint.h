// Relighting backwards: from a derivative by radiance to the derivative by the environment.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/bounces/bounce_light.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// The derivative of a number by the light of clusters and of sharp lights, and what they give to
/// the number at present: weights times radiance, for each channel.
struct LightDerivative {
    /// [num_clusters] by each cluster's vector irradiance without its sharp lights.
    std::vector<VectorIrradiance> clusters;
    /// [num_sharp_lights] by each sharp light's.
    std::vector<VectorIrradiance> sharp;
    /// [num_clusters]
    std::vector<glm::dvec3> given_by_clusters;
    /// [num_sharp_lights]
    std::vector<glm::dvec3> given_by_sharp;
};

/// Adds the derivatives by light, not what is given by it. A sum of nothing may be empty.
void add(const LightDerivative& part, LightDerivative& sum);

/// Returns the derivative by light, given the derivative by diffuse_radiance() of surfaces: the
/// walk of a relight, backwards. Weights of points in space count nothing here. docs/operator.md
/// says where light is not linear, and what counts there.
///
/// Shape:   weights is [num_receivers] in the receivers' own order.
/// Cost:    about a relight without the binning.
/// Threads: parallel; the same bits for any number of threads.
/// Throws:  std::invalid_argument for another number of weights, and weights that are not finite.
[[nodiscard]] LightDerivative light_derivative(const Relighter& relighter,
                                               std::span<const glm::vec3> weights);

/// Returns the derivative by the texels of the relighter's environment, given the derivative by its
/// clusters and sharp lights.
[[nodiscard]] cubemap::CubeMap by_texels(const Relighter& relighter,
                                         const LightDerivative& derivative);

/// Throws std::invalid_argument for another number of weights than `count`, and for weights that
/// are not finite.
void require_weights(std::span<const glm::vec3> weights, std::size_t count);

/// Throws std::invalid_argument for a relighter that no environment lights.
void require_environment(const Relighter& relighter);

/// Returns the derivative by the texels of the relighter's environment, given the derivative by
/// radiance(): T* w for the T of the present environment. <T e, w> = <e, T* w> for this environment
/// e. With `bounces`, radiance() with the light that reaches receivers from surfaces.
///
/// Shape:   weights is [num_receivers] in the receivers' own order.
/// Cost:    about a relight, and with bounces as many products with their matrix as light has
///          bounces.
/// Threads: parallel; the same bits for any number of threads.
/// Throws:  std::invalid_argument as light_derivative(), without an environment, and for receivers
///          with highlights.
[[nodiscard]] cubemap::CubeMap adjoint(const Relighter& relighter,
                                       std::span<const glm::vec3> weights,
                                       const SurfaceBounces* bounces = nullptr);

} // namespace relumine::relight
