#include "relight/binned_environment.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/seconds.h"
#include "relight/kernels/band_sums.h"

namespace relumine::relight {

BinnedEnvironment EnvironmentBinner::bin(std::shared_ptr<const cubemap::CubeMap> map) {
    using Clock = std::chrono::steady_clock;
    if (!map)
        throw std::invalid_argument("expected an environment");
    const std::size_t r = map->resolution;
    if (r == 0 || map->texels.size() != cubemap::NumFaces * r * r)
        throw std::invalid_argument(
            fmt::format("expected 6 x {0} x {0} texels, got {1}", r, map->texels.size()));

    BinnedEnvironment result;
    auto start = Clock::now();
    const std::span<const prt::Cell> cells = transfer_.quadtree.leaves();
    if (!binning_ || binning_->resolution() != map->resolution) {
        binning_ = std::make_shared<const LightBinning>(map->resolution);
        bands_ = std::make_shared<const BandSums>(map->resolution, cells);
    }
    result.binning = binning_;
    result.map = std::move(map);
    result.sums = binning_->sums(*result.map, *bands_, LightBinning::Texels::Unchecked);
    result.powers.resize(result.sums.size());
    std::transform(result.sums.begin(), result.sums.end(), result.powers.begin(),
                   std::mem_fn(&VectorIrradiance::power));
    result.seconds_bin = files::seconds_since(start);

    start = Clock::now();
    if (sharp_tolerance_ > 0.0f)
        result.sharp_lights =
            find_sharp_lights(*result.map, *binning_, transfer_, result.powers, sharp_tolerance_);
    result.seconds_sharp = files::seconds_since(start);
    return result;
}

} // namespace relumine::relight
