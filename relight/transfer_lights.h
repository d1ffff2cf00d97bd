// A few distant lights chosen for one scene: those that light its receivers most like the whole
// environment does.
#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>
#include <vector>

#include "lights/light_list.h"
#include "relight/relighter.h"

namespace relumine::relight {

struct TransferLightOptions {
    /// That the lights are chosen with; they are moved with twice as many
    std::size_t num_receivers = 16000;
    /// Polled after each light; prt::Cancelled is thrown
    std::stop_token stop = {};
    /// Fraction in [0, 1]
    std::function<void(double)> on_progress = {};
};

/// Chooses `count` lights for the scene of a relighter that has an environment and shadow rays.
///
/// With t_j(x) = V(x, w_j) max(n.w_j, 0)/pi the transfer from a direction w_j to the chosen
/// receivers, traced, it minimises over directions and irradiances E_j >= 0 the squared error of
/// sum E_j t_j against the relighter's radiance: orthogonal least squares (Chen, Billings and Luo
/// 1989) takes one direction after the other, always the one that lowers the error most once all
/// irradiances have been fitted anew (Lawson and Hanson 1974); then single lights are exchanged,
/// and moved by small steps, where it pays. Where there is much light, directions are looked for
/// more densely. Most of the squared error is at few receivers, at shadows' borders and in creases,
/// so those that the lists of median cut and variance minimisation light badly are chosen more
/// often and count less (relight/scaled_receivers.h): lights fitted to evenly chosen ones fit them,
/// and not the others. The lights' total power is whatever fits the scene: light that no receiver
/// sees is left out. Fewer lights come back where more would not help. Deterministic, for any
/// number of threads. Time and memory: docs/light-lists.md. Throws std::invalid_argument without
/// environment or shadow rays, or for count 0.
[[nodiscard]] std::vector<lights::DistantLight>
transfer_lights(const Relighter& relighter, std::size_t count,
                const TransferLightOptions& options = {});

} // namespace relumine::relight
