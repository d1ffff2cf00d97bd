// Lit scenes as files: which options they take and how they are written.
#pragma once

#include <string>
#include <vector>

#include "app/command_line/command_line.h"
#include "app/session.h"
#include "files/extension.h"
#include "relumine/in/environment_files.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"

namespace relumine::app {

/// -o and everything that shapes the output: camera, size, exposure, albedo, background.
struct OutputOptions {
    std::string path;
    relumine::OutputOptions picture;

    /// Adds -o and the others; returns -o, which is required until its caller says otherwise.
    Option add_to(Command& command);

    /// Refuses what cannot be written, or is one of the inputs, before any work is done.
    void check(const std::vector<std::string>& inputs) const;

    /// Refuses outputs and options that the scene's receivers have no use for: meshes of pixels and
    /// texels, a camera where there is none to choose. Throws OptionError.
    void check_fits(const Scene& scene) const;

    /// The options of the picture. Throws OptionError for colours that the scene's mesh does not
    /// have.
    [[nodiscard]] const relumine::OutputOptions& for_scene(const Scene& scene) const;

    /// Warns of a floor that the scene does not have, and where a picture looks from elsewhere than
    /// the eye that the highlights are for.
    void warn_of_picture(const Scene& scene, const Session& session) const;

    /// What to tell the user of the exposure of a picture or of colours: "; exposure -1.37 (auto)";
    /// nothing for numbers.
    [[nodiscard]] std::string exposure_text(const Painter& painter) const;

private:
    std::vector<Option> options_;
};

using files::extension_of;

/// Throws UsageError unless an option's path has one of these extensions (capital letters are
/// allowed).
void require_extension(const std::string& option, const std::string& path,
                       const std::vector<std::string>& extensions);

/// Throws UsageError unless an environment's path ends in .exr or .hdr.
void require_environment_name(const std::string& option, const std::string& path);

/// Throws UsageError for a part's name that a whole scene, picture or array would have.
void require_part_name(const std::string& path);

/// The names of frames, from --output. Throws UsageError where `path` has no place for a number.
[[nodiscard]] cubemap::FramePattern frame_names(const std::string& path);

/// Throws std::runtime_error when `path` cannot be written or is one of the inputs, under whatever
/// name.
void check_output(const std::string& path, const std::vector<std::string>& inputs);

} // namespace relumine::app
