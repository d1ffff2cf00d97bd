// --split-sun: the sun of an environment as a file of its own.
#pragma once

#include <filesystem>
#include <string>

#include <glm/mat3x3.hpp>

#include "app/report.h"
#include "files/output_file.h"
#include "relumine/in/environment_files.h"

namespace relumine::app {

/// The file that takes the sun split off a map: "out.exr" has "out.sun.json", a light list of one
/// light (direction, irradiance, solid angle) in world axes.
class SunFile {
public:
    /// Creates a temporary file beside the map's, so that an unwritable folder is found before any
    /// work is done.
    explicit SunFile(const std::filesystem::path& map_path);

    /// The sun that was split off
    struct Split {
        Report report = {};
        /// Share of the whole map's light.
        double share_of_power = 0.0;
    };
    /// Takes the sun out of the map, the sky around it in its place, and writes it to the temporary
    /// file, its direction carried by `world_from_image`. Returns the sun's figures. Throws
    /// std::runtime_error "source: expected a sun to split off, got none: why"; `source` names the
    /// map.
    Split split(cubemap::EnvironmentImage& image, const glm::dmat3& world_from_image,
                const std::string& source);

    /// Lets the file appear. To be called when the map without the sun is written.
    void commit() { file_.commit(); }

    [[nodiscard]] std::string path() const { return file_.target().string(); }

private:
    files::OutputFile file_;
};

} // namespace relumine::app
