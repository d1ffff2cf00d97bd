// Harmonics backwards: from a derivative by coefficients to the derivative by the environment.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "relight/adjoint/adjoint.h"

namespace relumine::relight {

/// Returns the derivative by light, given the derivative by the coefficients as they are summed,
/// before they are bound to a surface. What is given by lights is left empty.
///
/// Shape:   weights is [num_receivers][order^2] in the receivers' own order.
/// Cost:    a few times a relight with harmonics.
/// Threads: parallel; the same bits for any number of threads.
[[nodiscard]] LightDerivative unbound_derivative(const Relighter& relighter,
                                                 std::span<const glm::vec3> weights);

/// Returns the derivative by the texels of the relighter's environment, given the derivative by
/// harmonics(): adjoint() of the coefficients. With `bounces`, by the coefficients that are bound
/// to the light with its bounces.
///
/// Shape:   weights is [num_receivers][order^2] in the receivers' own order.
/// Throws:  std::invalid_argument for another number of weights, weights that are not finite, a
///          Relighter without harmonics or without an environment.
[[nodiscard]] cubemap::CubeMap harmonics_adjoint(const Relighter& relighter,
                                                 std::span<const glm::vec3> weights,
                                                 const SurfaceBounces* bounces = nullptr);

/// Returns the derivative by light, given the derivative by diffuse_radiance() of points in space,
/// which is a mean over the sphere. Weights of surfaces count nothing here.
///
/// Shape:   weights is [num_receivers] in the receivers' own order.
[[nodiscard]] LightDerivative points_derivative(const Relighter& relighter,
                                                std::span<const glm::vec3> weights);

} // namespace relumine::relight
