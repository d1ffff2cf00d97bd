// What the rays of receivers met that look for bounced light: rows of a matrix of bounces before
// similar receivers share them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "prt/bounces/bounce_matrix.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"

namespace relumine::prt {

/// Lights that decide how many rays a receiver needs: a white sky, then suns along +X, -X, +Y, -Y,
/// +Z and -Z.
inline constexpr std::size_t NumProbeLights = 7;

/// Direct radiance of a receiver of albedo 1 under each probe light. The sky has radiance 1, so the
/// first value is the open part of the hemisphere. A sun has irradiance pi on a surface that faces
/// it.
using ProbeRadiance = std::array<float, NumProbeLights>;

struct BounceStatistics {
    std::uint64_t num_rays = 0;
    std::uint64_t num_hits = 0;
    /// Hits on surfaces that face the ray.
    std::uint64_t num_emitters = 0;
    /// Mean number of receivers that share their samples.
    double mean_averaged = 0.0;
    /// Mean part of the hemisphere that surfaces close, over all receivers.
    double mean_closure = 0.0;
    /// Estimated standard error of one bounce, RMS over all receivers, worst of the probe lights.
    double rms_error = 0.0;
    double seconds = 0.0;
};

/// The samples of a part's receivers, in the order of their places.
struct BounceSamples {
    /// [receivers of the part] the open part of the hemisphere.
    std::vector<float> open_parts = {};
    /// [receivers of the part] harmonic mean of the distances of surfaces over the hemisphere,
    /// after the first look; 0 where there are none.
    std::vector<float> distances = {};
    /// [receivers of the part] directions that each looked into. Empty: nothing will move.
    std::vector<std::uint32_t> num_directions = {};
    /// [receivers of the part] rays that met a surface, whether it radiates or not.
    std::vector<std::uint32_t> num_hits = {};
    /// What surfaces the rays met, by their places among all receivers.
    PlaceLists emitters = {};
    /// Who shares samples. Empty for parts that know nothing of each other: join_bounces() finds
    /// it.
    std::optional<PlaceLists> averaged = {};
    /// Rows of the points in space among the part's receivers.
    PointRows points = {};
    std::uint64_t num_rays = 0;
    /// Sum of the squared standard errors over the receivers.
    double squared_errors = 0.0;
};

/// Returns the part of the hemisphere that surfaces close.
[[nodiscard]] double closed_part(const glm::vec3& normal, float open_part);

/// Returns who shares samples with each of the wanted receivers: those that are similar, itself
/// among them (similar_receivers.h). Only receivers at the places `begin` to `end` count. Added
/// vertices share samples among themselves: they are lit again and again, the pixels or texels
/// before them once.
///
/// distances:  [end - begin]
/// wanted:     places, ascending
/// before:     lists of all receivers that are about the same, which make it quicker; or null
[[nodiscard]] PlaceLists shared_samples(const Receivers& receivers, const Transfer& transfer,
                                        std::size_t begin, std::size_t end,
                                        std::span<const float> distances,
                                        std::span<const std::uint32_t> wanted,
                                        const PlaceLists* before = nullptr);

/// Makes the matrix of the samples of all parts, in the order of their indices.
///
/// Throws:  std::invalid_argument for samples that do not fit the receivers.
[[nodiscard]] BounceMatrix join_bounces(const Receivers& receivers, const Transfer& transfer,
                                        std::vector<BounceSamples>&& parts,
                                        BounceStatistics* statistics = nullptr);

} // namespace relumine::prt
