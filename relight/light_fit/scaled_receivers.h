// Some receivers of a scene that stand for all of it in a sum of squares, more of them where the
// terms are large.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/relighter.h"

namespace relumine::relight {

/// Chosen receivers with scales s_i: the sum of (s_i e_i)^2 over them estimates the sum of e^2 over
/// all receivers that have a normal.
struct ScaledReceivers {
    /// Places in the transfer, ascending.
    std::vector<std::size_t> places;
    /// [places]
    std::vector<float> scales;
};

/// How receivers should be lit.
struct LightGoal {
    /// [num_receivers] radiance for albedo 1, in the receivers' order.
    std::span<const glm::vec3> radiance;
    /// [num_receivers] factors of their squared errors, >= 0. Empty: all 1.
    std::span<const float> weights = {};
};

/// Chooses about `count` receivers, or all of them where there are no more. Each is chosen with a
/// probability p, then scaled by 1/sqrt(p).
///
/// One part of p is the same for all receivers. The rest follows `expected`, averaged over a few
/// neighbours: the share that a receiver is expected to have in the sum. p is at most 1. The choice
/// is systematic sampling along the places, which follow each other in space. Deterministic.
///
/// Shape:   expected is [num_receivers] by place.
[[nodiscard]] ScaledReceivers choose_receivers(const prt::Transfer& transfer,
                                               std::span<const double> expected, std::size_t count);

/// Adds to `errors`, by place, the squared difference between the lights' radiance and the goal's,
/// divided by the sum of all differences where it is not 0. The relighter needs shadow rays.
void add_squared_errors(const Relighter& relighter, const LightGoal& goal,
                        std::span<const lights::DistantLight> lights, std::span<double> errors);

} // namespace relumine::relight
