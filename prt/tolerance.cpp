#include "prt/tolerance.h"

#include <cmath>

namespace relumine::prt {

float rms_tolerance(float tolerance, std::optional<float> epsilon, std::size_t num_receivers) {
    return epsilon ? *epsilon * std::sqrt(static_cast<float>(num_receivers)) : tolerance;
}

PrecomputeOptions for_sample(PrecomputeOptions options, std::size_t num_receivers) {
    options.tolerance = rms_tolerance(options.tolerance, options.epsilon, num_receivers);
    options.epsilon = {};
    return options;
}

} // namespace relumine::prt
