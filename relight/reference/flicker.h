// How much an animation flickers compared with a reference, and how far its frames are from it.
// Based on: [S] Staton, Debattista, Bashford-Rogers, Chalmers, "Light clustering for Dynamic Image
// Based Lighting", Section 4.1, after Wan, Mak, Wong, Leung, "Spatiotemporal sampling of dynamic
// environment sequences", 2011.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

namespace relumine::relight {

struct FlickerReport {
    /// [frames - 1] E(t) between frames t and t + 1, in units of radiance; 0 for the reference
    /// itself.
    std::vector<double> inconsistency;
    /// [frames] ||X - X_ref|| / ||X_ref|| over all values and RGB; 0 where both are black.
    std::vector<double> relative_l2;
    /// 0 for fewer than two frames.
    double mean_inconsistency = 0.0;
    double mean_relative_l2 = 0.0;
    double worst_inconsistency = 0.0;
};

/// Takes the frames of an animation and of its reference one by one. Keeps one frame.
///
/// E(t) = 1/N sum_i w_i |dX_i(t) - dX'_i(t)| [S, Eq. 9], where X' is the reference, dX_i(t) =
/// X_i(t) - X_i(t + 1) and w_i = |X_i(t) - X'_i(t)| + 1. X is luminance with the weights (0.2125,
/// 0.7154, 0.0721). The 1 in w_i makes the number depend on the unit: choose the exposure so that
/// white is about 1.
class FlickerMeter {
public:
    /// Frames and reference are multiplied by `exposure` first.
    explicit FlickerMeter(double exposure = 1.0) : exposure_(exposure) {}

    /// Takes the next frame: radiance in the same places as in the reference and in all frames
    /// before.
    ///
    /// Throws:  std::invalid_argument for another number of values, none, or values that are not
    ///          finite; nothing has changed then.
    void add_frame(std::span<const glm::dvec3> frame, std::span<const glm::dvec3> reference);
    void add_frame(std::span<const glm::vec3> frame, std::span<const glm::vec3> reference);

    [[nodiscard]] FlickerReport report() const;

private:
    double exposure_;
    /// Luminance of the frame before.
    std::vector<double> last_;
    std::vector<double> last_reference_;
    /// Without the means.
    FlickerReport report_;
};

/// Measures two animations as arrays of radiance [frames][values].
///
/// Throws:  std::invalid_argument as add_frame() does, or for different numbers of frames.
[[nodiscard]] FlickerReport measure_flicker(std::span<const std::vector<glm::dvec3>> frames,
                                            std::span<const std::vector<glm::dvec3>> reference,
                                            double exposure = 1.0);

/// Measures two animations as .npy files, one after the other. Each file holds a frame, [values x
/// 3], or many, [frames x values x 3].
///
/// Throws:  std::runtime_error "path: expected X, got Y".
[[nodiscard]] FlickerReport measure_flicker(std::span<const std::filesystem::path> frames,
                                            std::span<const std::filesystem::path> reference,
                                            double exposure = 1.0);

} // namespace relumine::relight
