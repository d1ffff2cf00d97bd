// The colours of a screen by an OpenColorIO config, in place of a tone curve.
#pragma once

#include <memory>
#include <span>
#include <string>

#include <glm/vec3.hpp>

namespace relumine::relight {

/// A view of a display, as a config names them; empty: the config's own choice.
struct DisplayView {
    std::string config = {};
    std::string display = {};
    std::string view = {};
};

class DisplayTransform {
public:
    /// Throws:  std::runtime_error that names the config for one that cannot be read or does not
    ///          have the view, and in a build without OpenColorIO.
    explicit DisplayTransform(const DisplayView& view);
    ~DisplayTransform();
    DisplayTransform(const DisplayTransform&) = delete;
    DisplayTransform& operator=(const DisplayTransform&) = delete;

    /// Replaces exposed linear colours of Rec. 709 by the display's own values, from 0 to 1.
    ///
    /// Threads: any number at a time.
    void apply(std::span<glm::vec3> pixels) const;

private:
    struct Impl;
    std::unique_ptr<const Impl> impl_;
};

} // namespace relumine::relight
