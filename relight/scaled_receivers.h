// Some receivers of a scene that stand for all of it in a sum of squares, more of them where the
// terms are large.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "relight/relighter.h"

namespace relumine::relight {

/// With scales s_i, the sum of (s_i e_i)^2 over these receivers estimates that of e^2 over all
/// receivers that have a normal.
struct ScaledReceivers {
    /// Ascending, of the transfer
    std::vector<std::size_t> places;
    /// [places]
    std::vector<float> scales;
};

/// About `count` receivers (all of them where there are no more), each chosen with a probability p
/// and then scaled by 1/sqrt(p): systematic sampling along the places, which follow each other in
/// space. A part of p is even, the rest as `expected` [num_receivers], by place, what the receiver
/// is expected to have in the sum, averaged over a few neighbours. Where p would be above 1 it
/// is 1. Deterministic.
[[nodiscard]] ScaledReceivers choose_receivers(const prt::Transfer& transfer,
                                               std::span<const double> expected, std::size_t count);

/// Adds the squared differences, by place, between the lights' radiance and the relighter's,
/// divided by their sum, where they have one. The relighter needs shadow rays.
void add_squared_errors(const Relighter& relighter, std::span<const lights::DistantLight> lights,
                        std::span<double> errors);

} // namespace relumine::relight
