#include "prt/tolerance.h"

#include <cmath>

namespace relumine::prt {

float rms_tolerance(float tolerance, std::optional<float> epsilon, std::size_t num_receivers) {
    return epsilon ? *epsilon * std::sqrt(static_cast<float>(num_receivers)) : tolerance;
}

} // namespace relumine::prt
