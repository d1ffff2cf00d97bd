// A few distant lights chosen for one scene: they light its receivers nearly as the whole
// environment does.
#pragma once

#include <cstddef>
#include <vector>

#include "lights/light_list.h"
#include "prt/work.h"
#include "relight/light_fit/scaled_receivers.h"
#include "relight/relighter.h"

namespace relumine::relight {

/// Chooses `count` lights, each anywhere in the sky, that light receivers as they should be.
/// Directions are traced on a grid of 2.8 degrees, then moved by small steps; irradiances are never
/// negative. Returns fewer lights where more would not help. Deterministic for any number of
/// threads.
///
/// Cost:    as transfer_lights().
/// Throws:  std::invalid_argument for a relighter without shadow rays, a goal for other receivers,
///          or count 0; prt::Cancelled when stopped.
[[nodiscard]] std::vector<lights::DistantLight> fit_lights(const Relighter& relighter,
                                                           const LightGoal& goal, std::size_t count,
                                                           const prt::Work& work = {});

/// Chooses `count` lights for the scene of a relighter that has an environment and shadow rays.
/// Returns fewer lights where more would not help. Deterministic for any number of threads.
///
/// t_j(x) = V(x, w_j) max(n.w_j, 0)/pi is the traced transfer from a direction w_j to the chosen
/// receivers. The squared error of sum E_j t_j against the relighter's radiance is minimised over
/// directions and irradiances E_j >= 0.
///
/// Orthogonal least squares (Chen, Billings and Luo 1989) takes one direction after the other: the
/// one that lowers the error most once all irradiances are fitted anew (Lawson and Hanson 1974).
/// Then single lights are exchanged, and moved by small steps, where it pays.
///
/// Candidate directions are denser where there is much light. Most of the squared error is at few
/// receivers, at borders of shadows and in creases. So receivers that median cut and variance
/// minimisation light badly are chosen more often and count less
/// (relight/light_fit/scaled_receivers.h). Lights fitted to evenly chosen receivers would fit only
/// those.
///
/// The lights' total power is whatever fits the scene: light that no receiver sees is left out.
///
/// Cost:    docs/light-lists.md has time and memory.
/// Throws:  std::invalid_argument without environment or shadow rays, or for count 0;
///          prt::Cancelled when stopped.
[[nodiscard]] std::vector<lights::DistantLight>
transfer_lights(const Relighter& relighter, std::size_t count, const prt::Work& work = {});

} // namespace relumine::relight
