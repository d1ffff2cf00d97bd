// The lights that decide how many rays a receiver's bounces need.
#pragma once

#include <vector>

#include "prt/bounces/bounce_precompute.h"
#include "prt/transfer/transfer.h"

namespace relumine::relight {

/// Returns the direct radiance of all receivers, for albedo 1, under each of the probe lights,
/// through the clusters.
///
/// Shape:   [num_receivers] by place.
/// Cost:    seven relightings.
[[nodiscard]] std::vector<prt::ProbeRadiance> probe_radiance(const prt::Transfer& transfer);

} // namespace relumine::relight
