// A few lights that together light receivers as a given radiance does.
// Based on: Chen, Billings, Luo, "Orthogonal Least Squares Methods and Their Application to
// Non-linear System Identification", 1989, with non-negative weights and exchanges.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "files/parallel.h"
#include "relight/light_fit/transfer_matrix.h"

namespace relumine::relight {

/// The chosen lights, each a candidate (a column of the matrix), and their fit. The Gram-Schmidt
/// basis q_k of the chosen columns tells how much of every candidate is new. So the next light is
/// the candidate that lowers the error most once all other lights are fitted anew.
class LightPursuit {
public:
    /// `matrix` must outlive this object. `radiance` is the goal for the receivers, [receivers].
    LightPursuit(const TransferMatrix& matrix, std::span<const glm::vec3> radiance);

    /// Takes these candidates.
    void take(std::span<const std::size_t> lights);

    /// Takes the candidate that lowers the error most. Returns false where none does.
    bool take_best();

    /// Takes every light away once and puts it where it lowers the error most. Returns whether any
    /// light moved.
    bool exchange();

    struct Light {
        std::size_t candidate = 0;
        glm::dvec3 irradiance{0.0};
    };

    [[nodiscard]] std::span<const Light> lights() const { return chosen_; }

    /// Returns the squared error minus the squared error without lights.
    [[nodiscard]] double error() const;

private:
    void push_back(std::size_t candidate, const glm::dvec3& irradiance);
    void pop_back();
    /// Removes the first light: turns the basis until only its last vector has a part in that light
    /// (Givens), then drops both.
    void pop_front();
    /// Fits all irradiances to the radiance, none below zero.
    void fit();
    /// Computes each candidate's product with the remaining error.
    void correlate();
    /// Returns how much the squared error falls when the candidate is taken and all irradiances are
    /// fitted anew, whatever their sign.
    [[nodiscard]] double gain(std::size_t candidate) const;
    [[nodiscard]] std::size_t best_candidate() const;
    [[nodiscard]] glm::dvec3 target(std::size_t candidate) const;
    [[nodiscard]] files::IndexRange<std::size_t> candidates() const;

    const TransferMatrix& matrix_;
    /// [candidates] t_j.t_j
    std::vector<float> norms_;
    /// [candidates] the same for the part of t_j that no chosen column has.
    std::vector<float> new_norms_;
    /// [channel][candidates] t_j.B
    std::array<std::vector<float>, 3> targets_;
    /// [channel][candidates] products with the remaining error, B - sum E_l t_l.
    std::array<std::vector<float>, 3> correlations_;
    std::vector<Light> chosen_;
    /// [lights][candidates] t_l.t_j
    std::vector<std::vector<float>> products_;
    /// [lights][candidates] q_l.t_j
    std::vector<std::vector<float>> basis_;
};

} // namespace relumine::relight
