// Inter-reflection at relighting time: X = rho (B + A X), diffuse.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/bounces/bounce_matrix.h"
#include "prt/team.h"
#include "prt/transfer/transfer.h"

namespace relumine::relight {

struct BounceLimits {
    /// Exactly so many bounces; empty: as many as `tolerance` asks for.
    std::optional<std::uint32_t> num_bounces = {};
    /// Relative error of the sum of all bounces, L2 over all receivers, as the steps of the solver
    /// tell. Light that fills a nearly closed gap over hundreds of bounces is not waited for.
    double tolerance = 1e-3;

    bool operator==(const BounceLimits&) const = default;
};

/// The rows of a matrix that processes share. Each has its own in the matrix (prt::has_row()); the
/// others are empty.
struct SharedRows {
    /// Null: this process has all rows.
    prt::Team* team = nullptr;
    /// prt::first_emitter() of all rows
    std::size_t first = 0;
    /// [num_rows] emitters of all rows
    std::span<const std::uint32_t> num_emitters = {};
};

/// A surface that passes light on diffusely: what a receiver sends of the light of another one, on
/// its other side.
struct PassedOn {
    std::uint32_t receiver = 0, other = 0;
    /// Times the radiance that the other one has for albedo 1
    glm::vec3 part{0.0f};
    bool operator==(const PassedOn&) const = default;
};

/// What the light of a scene needs to bounce.
struct SurfaceBounces {
    /// Must outlive its users. Null: light does not bounce.
    const prt::BounceMatrix* matrix = nullptr;
    /// [num_receivers] diffuse reflectance, in the receivers' order.
    std::vector<glm::vec3> albedo = {};
    std::vector<PassedOn> passed_on = {};
    BounceLimits limits = {};
};

/// The effect of a call that bounces light.
struct BounceReport {
    /// Products with the matrix; without a number of bounces a product stands for several.
    std::uint32_t num_bounces = 0;
    /// Estimated relative error of what further bounces would add.
    double error = 0.0;
    double seconds = 0.0;
};

/// Keeps the light that a scene's receivers get from each other.
///
/// X is the diffuse radiance that a receiver sends on, B its direct light for albedo 1, A the
/// bounces of the scene, rho the albedo, and what surfaces pass on from behind them.
/// indirect() is A X: what other surfaces add to B.
///
/// Threads: parallel inside (TBB); every result is the same bit by bit for any number of threads.
///          One thread at a time may call functions that are not const.
class BounceLight {
public:
    /// Matrix and transfer must outlive this object. Albedo is 0 at first.
    ///
    /// Memory:  some 100 bytes per receiver, and 32 for each of the last ten steps.
    /// Throws:  std::invalid_argument for a matrix of other receivers.
    ///
    /// Where processes share the rows, all call the same functions in the same order, with the same
    /// light of all receivers, and get the same result. They exchange what each product finds.
    BounceLight(const prt::BounceMatrix& matrix, const prt::Transfer& transfer,
                const SharedRows& shared = {});
    ~BounceLight();
    BounceLight(BounceLight&&) noexcept;
    BounceLight& operator=(BounceLight&&) noexcept;

    /// Sets the diffuse reflectance, [num_receivers] in the receivers' order, and what is passed
    /// on. Both are dimmed where they come to more than is safe.
    ///
    /// Cost:    O(receivers). The next solve() without a number of bounces, or step(), makes the
    ///          groups of receivers for it: some ten products with the matrix.
    /// Throws:  std::invalid_argument for another number of albedos, one that is negative or not
    ///          finite, or above 1 and so large that light would grow for ever. The message names
    ///          the largest albedo that is safe. Nothing has changed then. In a closed white room
    ///          light would stay for ever; 0.1 % of it is lost there at each bounce.
    void set_albedo(std::span<const glm::vec3> albedo, std::span<const PassedOn> passed_on = {});

    /// Finds the bounces from nothing, so that equal light gives equal bits whatever came before.
    /// Without a number of bounces, each product with the matrix is followed by the bounces between
    /// groups of receivers (coarse_bounces.h), and steps are combined [Anderson 1965].
    ///
    /// Shape:   `direct` is [num_receivers], Relighter::diffuse_radiance().
    /// Cost:    a product with the matrix for each bounce, milliseconds: docs/measurements.md.
    BounceReport solve(std::span<const glm::vec3> direct, const BounceLimits& limits = {});

    /// Goes one product on from the present state, with the bounces between groups: for light that
    /// changes while it is looked at. The report's error is the size of the step.
    BounceReport step(std::span<const glm::vec3> direct);

    /// What other surfaces add to a receiver's direct light, for albedo 1. Of points in space, it
    /// is the mean radiance over the sphere.
    ///
    /// Shape:   [num_receivers] in the receivers' order.
    [[nodiscard]] std::span<const glm::vec3> indirect() const;

    /// Returns the light that points in space get from surfaces, as spherical harmonics
    /// (docs/harmonics.md).
    ///
    /// Shape:   [num_points][order^2] by place.
    [[nodiscard]] std::vector<glm::vec3> point_harmonics(std::uint32_t order) const;

private:
    class Impl;
    std::unique_ptr<Impl> impl_;
};

/// Returns the derivative of a number by each receiver's direct light, as far as this light reaches
/// receivers from other surfaces, given the derivative by their indirect(): the transpose of
/// BounceLight. All bounces are found to the limits' tolerance. Of points in space it takes the
/// derivative by their point_harmonics(); their indirect() is a multiple of the first.
///
/// Shape:   weights and result are [num_receivers] in the receivers' order; `of_points` is
///          [num_points][order^2] by place, or empty: then `weights` counts for points as well.
/// Cost:    as many products with the matrix as light has bounces.
/// Threads: parallel; the same bits for any number of threads.
/// Throws:  std::invalid_argument for bounces or weights of other receivers.
[[nodiscard]] std::vector<glm::vec3> bounce_adjoint(const SurfaceBounces& bounces,
                                                    const prt::Transfer& transfer,
                                                    std::span<const glm::vec3> weights,
                                                    std::span<const glm::vec3> of_points = {});

} // namespace relumine::relight
