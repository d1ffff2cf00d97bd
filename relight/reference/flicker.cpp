#include "relight/reference/flicker.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "lights/lat_long_grid.h"
#include "relight/pictures/array_file.h"

namespace relumine::relight {

namespace {

double mean(std::span<const double> values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

std::vector<double> luminances(std::span<const glm::dvec3> radiance, double exposure) {
    std::vector<double> result;
    result.reserve(radiance.size());
    for (const glm::dvec3& value : radiance)
        result.push_back(exposure * lights::luminance(value));
    return result;
}

void require_finite(std::span<const glm::dvec3> radiance, const char* what) {
    for (std::size_t i = 0; i < radiance.size(); ++i)
        if (!std::isfinite(radiance[i].r) || !std::isfinite(radiance[i].g) ||
            !std::isfinite(radiance[i].b))
            throw std::invalid_argument(
                fmt::format("{}: expected finite radiance, got ({}, {}, {}) at {}", what,
                            radiance[i].r, radiance[i].g, radiance[i].b, i));
}

double relative_l2(std::span<const glm::dvec3> frame, std::span<const glm::dvec3> reference) {
    double errors = 0.0;
    double all = 0.0;
    for (std::size_t i = 0; i < frame.size(); ++i) {
        const glm::dvec3 error = frame[i] - reference[i];
        errors += glm::dot(error, error);
        all += glm::dot(reference[i], reference[i]);
    }
    return errors > 0.0 ? std::sqrt(errors / all) : 0.0;
}

std::vector<glm::dvec3> in_double(std::span<const glm::vec3> values) {
    return {values.begin(), values.end()};
}

void require_equal_counts(std::size_t frames, std::size_t reference) {
    if (frames != reference)
        throw std::invalid_argument(
            fmt::format("expected {} frames as in the reference, got {}", reference, frames));
}

/// The frames of files, one after the other. One file is in memory.
class FileFrames {
public:
    explicit FileFrames(std::span<const std::filesystem::path> paths) : paths_(paths) {}

    /// Returns the values of the next frame, valid until the next call; empty at the end.
    std::span<const glm::vec3> next() {
        while (frame_ == num_frames_) {
            if (file_ == paths_.size()) {
                at_end_ = true;
                return {};
            }
            array_ = load_npy(paths_[file_]);
            if (array_.shape.size() != 1 && array_.shape.size() != 2)
                throw std::runtime_error(
                    fmt::format("{}: expected [values x 3] or [frames x values x 3], got {} axes",
                                paths_[file_].string(), array_.shape.size() + 1));
            num_frames_ = array_.shape.size() == 2 ? array_.shape[0] : 1;
            frame_ = 0;
            ++file_;
        }
        const std::size_t size = array_.values.size() / num_frames_;
        return std::span(array_.values).subspan(size * frame_++, size);
    }
    [[nodiscard]] bool at_end() const { return at_end_; }
    /// Returns the name of the last frame's file.
    [[nodiscard]] std::string name() const {
        return file_ > 0 ? paths_[file_ - 1].string() : "no files";
    }

private:
    std::span<const std::filesystem::path> paths_;
    VectorArray array_;
    /// File to read next.
    std::size_t file_ = 0;
    std::size_t frame_ = 0;
    /// Frames in array_.
    std::size_t num_frames_ = 0;
    bool at_end_ = false;
};

} // namespace

void FlickerMeter::add_frame(std::span<const glm::dvec3> frame,
                             std::span<const glm::dvec3> reference) {
    const std::size_t wanted = report_.relative_l2.empty() ? reference.size() : last_.size();
    if (frame.size() != wanted || reference.size() != wanted)
        throw std::invalid_argument(
            fmt::format("expected {} values of a frame and its reference, got {} and {}", wanted,
                        frame.size(), reference.size()));
    if (wanted == 0)
        throw std::invalid_argument("expected a frame of at least 1 value, got 0");
    require_finite(frame, "frame");
    require_finite(reference, "reference");

    std::vector<double> now = luminances(frame, exposure_);
    std::vector<double> now_reference = luminances(reference, exposure_);
    if (!last_.empty()) {
        double sum = 0.0;
        for (std::size_t i = 0; i < wanted; ++i) { // [S, Eq. 9]
            const double weight = std::abs(last_[i] - last_reference_[i]) + 1.0;
            sum += weight * std::abs((last_[i] - now[i]) - (last_reference_[i] - now_reference[i]));
        }
        report_.inconsistency.push_back(sum / static_cast<double>(wanted));
    }
    report_.relative_l2.push_back(relative_l2(frame, reference));
    last_ = std::move(now);
    last_reference_ = std::move(now_reference);
}

void FlickerMeter::add_frame(std::span<const glm::vec3> frame,
                             std::span<const glm::vec3> reference) {
    add_frame(in_double(frame), in_double(reference));
}

FlickerReport FlickerMeter::report() const {
    FlickerReport report = report_;
    report.mean_inconsistency = mean(report.inconsistency);
    report.mean_relative_l2 = mean(report.relative_l2);
    for (const double value : report.inconsistency)
        report.worst_inconsistency = std::max(report.worst_inconsistency, value);
    return report;
}

FlickerReport measure_flicker(std::span<const std::vector<glm::dvec3>> frames,
                              std::span<const std::vector<glm::dvec3>> reference, double exposure) {
    require_equal_counts(frames.size(), reference.size());
    FlickerMeter meter(exposure);
    for (std::size_t t = 0; t < frames.size(); ++t)
        meter.add_frame(frames[t], reference[t]);
    return meter.report();
}

FlickerReport measure_flicker(std::span<const std::filesystem::path> frames,
                              std::span<const std::filesystem::path> reference, double exposure) {
    FileFrames wanted(reference);
    FileFrames got(frames);
    FlickerMeter meter(exposure);
    std::size_t count = 0;
    while (true) {
        const std::span<const glm::vec3> frame = got.next();
        const std::span<const glm::vec3> reference_frame = wanted.next();
        if (got.at_end() && wanted.at_end())
            break;
        if (got.at_end() || wanted.at_end())
            throw std::runtime_error(
                fmt::format("{}: expected as many frames as the other animation, got {}",
                            (got.at_end() ? got : wanted).name(), count));
        try {
            meter.add_frame(frame, reference_frame);
        } catch (const std::invalid_argument& error) {
            throw std::runtime_error(fmt::format("{}: frame {} against {}: {}", got.name(), count,
                                                 wanted.name(), error.what()));
        }
        ++count;
    }
    return meter.report();
}

} // namespace relumine::relight
