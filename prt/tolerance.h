// The two forms of the tolerance, and which of them a scene was clustered with.
#pragma once

#include <cstddef>
#include <optional>

#include "prt/precompute_options.h"

namespace relumine::prt {

/// The RMS form of a tolerance, 1/sr: `tolerance` itself, or the paper's `epsilon` where it is
/// given, which stands for epsilon * sqrt(num_receivers) [JN, Eq. 11].
[[nodiscard]] float rms_tolerance(float tolerance, std::optional<float> epsilon,
                                  std::size_t num_receivers);

/// Returns options that ask a sample for the RMS that `options` ask of all `num_receivers`.
[[nodiscard]] PrecomputeOptions for_sample(PrecomputeOptions options, std::size_t num_receivers);

} // namespace relumine::prt
