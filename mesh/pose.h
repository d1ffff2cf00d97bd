// A moment of a file's animation.
#pragma once

#include <string>

namespace relumine::mesh {

/// Which pose of its moving parts a file is read in.
struct Pose {
    /// The name of an animation of the file, or its number from 0.
    std::string animation;
    /// Before the first key and after the last one, the animation stands still.
    double seconds = 0.0;

    bool operator==(const Pose&) const = default;
};

} // namespace relumine::mesh
