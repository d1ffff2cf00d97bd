// Precomputes the view-dependent part of light transfer. Starts from the visible counts of the
// diffuse part.
#pragma once

#include <cstdint>
#include <limits>

#include "prt/receivers/receivers.h"
#include "prt/transfer/glossy_transfer.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/blockers.h"
#include "prt/work.h"

namespace relumine::prt {

struct GlossyOptions {
    /// The error that is allowed of a block's lobe, relative to the lobe without blockers: sqrt(sum
    /// over cells of dw mean (T - T_C)^2) < tolerance sqrt(sum of dw T^2). The ratio is the
    /// relative L2 error under a small light that may stand anywhere.
    ///
    /// Highlights narrower than roughness 0.3 get a smaller tolerance. The grazing part of the
    /// specular lobe is measured against the specular lobe. The grazing part of the diffuse lobe is
    /// measured against the whole diffuse lobe.
    float tolerance = 0.07f;
    /// R: cells are no finer than texels of a 6 x R x R environment (PrecomputeOptions).
    std::uint32_t face_resolution = 1024;
    /// Lift of the rays' origins along the normal, in the mesh's unit (PrecomputeOptions).
    float bias = 0.0f;
    /// The limit on all blocks' entries, BytesPerEntry each. Beyond it TooLarge is thrown. For
    /// each of the processes that share the work.
    std::uint64_t max_bytes = std::numeric_limits<std::uint64_t>::max();
};

/// A cell's index, its scale and 16 values.
inline constexpr std::uint64_t BytesPerEntry = 24;

/// What all processes that share the work counted, and how long this one took.
struct GlossyStatistics {
    /// (block, cell) pairs of all lobes.
    std::uint64_t num_entries = 0;
    std::uint64_t num_rays = 0;
    double seconds = 0.0;
};

/// Whether there is a glossy part to compute: directions to the eye, and a receiver with a
/// highlight.
[[nodiscard]] bool has_highlights(const Receivers& receivers);

/// Returns glTF's roughness below which highlights come out wider than they are: the lobe's width,
/// 2 alpha, is less than two of the finest cells there. The finest cells are single texels, or
/// cells of MaxGlossyLevel.
[[nodiscard]] float narrowest_roughness(std::uint32_t face_resolution);

/// Returns the cuts of all blocks, for receivers with to_eye and surfaces. set_surfaces() then
/// gives the transfer what relighting needs of the receivers. Where processes share the work,
/// `transfer` has the counts of the process's receivers, order and normals of all, and the result
/// is for the process's receivers.
///
/// Each block refines the cell with the largest error first, nine samples to a cell [JN, Section
/// 4.1], T with the BRDF [JN, Eq. 3]. Where the transfer's counts say that a receiver sees all of a
/// cluster or nothing, its visibility comes from there. Elsewhere rays are traced.
///
/// Threads: parallel over blocks (TBB). The same bits for any number of threads, with or without a
///          checkpoint taken up.
/// Throws:  std::invalid_argument for options out of range or receivers that do not fit the
///          transfer; Cancelled when stopped; TooLarge.
[[nodiscard]] GlossyTransfer precompute_glossy(const Receivers& receivers, const Blockers& blockers,
                                               const Transfer& transfer,
                                               const GlossyOptions& options = {},
                                               const Work& work = {},
                                               GlossyStatistics* statistics = nullptr);

/// Estimates the number of entries from some hundred blocks.
///
/// Throws:  std::invalid_argument and Cancelled as precompute_glossy() does.
[[nodiscard]] std::uint64_t estimate_glossy_entries(const Receivers& receivers,
                                                    const Blockers& blockers,
                                                    const Transfer& transfer,
                                                    const GlossyOptions& options,
                                                    const Work& work = {});

} // namespace relumine::prt
