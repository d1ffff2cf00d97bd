// Precomputes the view-dependent part of light transfer, on top of the visible counts of the
// diffuse part.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <stdexcept>
#include <stop_token>

#include "prt/checkpoint.h"
#include "prt/glossy/glossy_transfer.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

struct GlossyOptions {
    /// A block's cut is fine enough when the error of its lobe, T_C - T over all directions, is at
    /// most this part of the lobe itself without blockers: sqrt(sum over cells of dw mean (T -
    /// T_C)^2) < tolerance sqrt(sum of dw T^2). It is the relative L2 error under a small light
    /// that may stand anywhere. Highlights narrower than that of roughness 0.3 are held to less.
    /// For the grazing part of the diffuse lobe the whole diffuse lobe is what counts.
    float tolerance = 0.07f;
    /// As PrecomputeOptions
    std::uint32_t face_resolution = 1024;
    /// As PrecomputeOptions
    float bias = 0.0f;
    /// Of all blocks' entries, BytesPerEntry each. Beyond it TooManyEntries is thrown.
    std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();
    /// Where finished blocks are left now and then, and taken up
    Checkpoint* checkpoint = nullptr;
    std::stop_token stop = {};
    /// Fraction in [0, 1], one call at a time
    std::function<void(double)> on_progress = {};
};

/// A cell's index, its scale and 16 values.
inline constexpr std::uint64_t BytesPerEntry = 24;

struct GlossyStatistics {
    /// (block, cell) pairs of all lobes
    std::uint64_t num_entries = 0;
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
};

/// Thrown by precompute_glossy() when the entries take more than max_bytes; a checkpoint is left.
struct TooManyEntries : std::runtime_error {
    explicit TooManyEntries(std::uint64_t entries);
    /// At least
    std::uint64_t num_entries;
};

/// Whether any receiver has a highlight that an eye sees: whether there is a glossy part to
/// compute.
[[nodiscard]] bool has_highlights(const Receivers& receivers);

/// glTF's roughness below which the finest cells (single texels, or of MaxGlossyLevel) cannot hold
/// the lobe: its width, 2 alpha, is less than two cells. Highlights come out wider than they are.
[[nodiscard]] float narrowest_roughness(std::uint32_t face_resolution);

/// Cuts of all blocks, for receivers with to_eye and surfaces. Each block refines the cell with the
/// largest error first, nine samples to a cell [JN, Section 4.1], T with the BRDF [JN, Eq. 3].
/// Where the transfer's counts say that a receiver sees all of a cluster or nothing, that is taken
/// for its visibility; only in between rays are traced. Parallel over blocks (TBB); the same bits
/// for any number of threads, and whether or not a checkpoint was taken up. set_surfaces() gives
/// the transfer what relighting needs of the receivers. Throws std::invalid_argument for receivers
/// that do not fit the transfer, Cancelled when stopped, TooManyEntries.
[[nodiscard]] GlossyTransfer precompute_glossy(const Receivers& receivers, const Blockers& blockers,
                                               const Transfer& transfer,
                                               const GlossyOptions& options = {},
                                               GlossyStatistics* statistics = nullptr);

/// About how many entries that will be, from some hundred blocks. Throws as precompute_glossy().
[[nodiscard]] std::uint64_t estimate_glossy_entries(const Receivers& receivers,
                                                    const Blockers& blockers,
                                                    const Transfer& transfer,
                                                    const GlossyOptions& options);

} // namespace relumine::prt
