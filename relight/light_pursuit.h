// A few lights whose sum lights receivers like a given radiance.
// Based on: Chen, Billings, Luo, "Orthogonal Least Squares Methods and Their Application to
// Non-linear System Identification", 1989, with non-negative weights and exchanges.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>
#include <tbb/blocked_range.h>

#include "relight/transfer_matrix.h"

namespace relumine::relight {

/// The lights so far, each a candidate (a column of the matrix), and their fit. With the
/// Gram-Schmidt basis q_k of the chosen columns at hand it is known of every candidate how much of
/// it is new, so the next light is the one that lowers the error most after all others have been
/// fitted anew to it.
class LightPursuit {
public:
    /// `matrix` must outlive it; `radiance`: what the receivers shall get, [receivers].
    LightPursuit(const TransferMatrix& matrix, std::span<const glm::vec3> radiance);

    /// Takes these candidates.
    void take(std::span<const std::size_t> lights);

    /// Takes the candidate that lowers the error most; false where none does.
    bool take_best();

    /// Takes every light away once and puts it where it lowers the error most. Returns whether any
    /// moved.
    bool exchange();

    struct Light {
        std::size_t candidate = 0;
        glm::dvec3 irradiance{0.0};
    };

    [[nodiscard]] std::span<const Light> lights() const { return chosen_; }

    /// Squared error, less that without lights.
    [[nodiscard]] double error() const;

private:
    void push_back(std::size_t candidate, const glm::dvec3& irradiance);
    void pop_back();
    /// Turns the basis until only its last vector has a part in the first light (Givens), then lets
    /// both go.
    void pop_front();
    /// Fits all irradiances to the radiance, none below zero.
    void fit();
    /// What each candidate has in common with the error that is left.
    void correlate();
    /// How much the squared error falls when the candidate is taken and all irradiances are fitted
    /// anew, whatever their sign.
    [[nodiscard]] double gain(std::size_t candidate) const;
    [[nodiscard]] std::size_t best_candidate() const;
    [[nodiscard]] glm::dvec3 target(std::size_t candidate) const;
    [[nodiscard]] tbb::blocked_range<std::size_t> candidates() const;

    const TransferMatrix& matrix_;
    /// [candidates] t_j.t_j
    std::vector<float> norms_;
    /// The same of the part of t_j that no chosen column has
    std::vector<float> new_norms_;
    /// [channel][candidates] t_j.B
    std::array<std::vector<float>, 3> targets_;
    /// The same of the error that is left, B - sum E_l t_l
    std::array<std::vector<float>, 3> correlations_;
    std::vector<Light> chosen_;
    /// [lights][candidates] t_l.t_j
    std::vector<std::vector<float>> products_;
    /// [lights][candidates] q_l.t_j
    std::vector<std::vector<float>> basis_;
};

} // namespace relumine::relight
