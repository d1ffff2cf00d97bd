// Pictures whose parts stand beside them in one file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "cubemap/image/picture.h"

namespace relumine::relight {

/// A picture and named parts of it, of the same size.
struct LayeredPicture {
    struct Layer {
        std::string name;
        /// [width * height]; may be negative.
        std::vector<glm::vec3> pixels;
    };
    cubemap::Picture whole;
    std::vector<Layer> layers;
};

/// Returns names that differ and that OpenEXR takes for layers: a dot, which would begin a layer in
/// a layer, becomes "_", and a name that was there before gets a number.
[[nodiscard]] std::vector<std::string> layer_names(std::vector<std::string> names);

/// Writes an .exr: the whole as channels R, G, B (and A), each part as NAME.R, NAME.G, NAME.B;
/// linear float, exposed. Whole or not at all.
///
/// Throws:  std::runtime_error that names the path; std::invalid_argument for a part of another
///          size.
void save_layered_picture(const std::filesystem::path& path, LayeredPicture picture,
                          double exposure_ev = 0.0);

} // namespace relumine::relight
