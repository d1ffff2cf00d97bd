// Lit scenes as files: which options they take and how they are written.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "app/command_line.h"
#include "app/lit_scene.h"
#include "relumine/output.h"

namespace relumine::app {

class Session;

/// -o and everything that shapes the output: camera, size, exposure, albedo.
struct OutputOptions {
    std::string path;
    std::string albedo = "1";
    double exposure_ev = 0.0;
    /// Camera position X,Y,Z. Empty: automatic.
    std::string eye;
    /// Point X,Y,Z that the camera looks at. Empty: automatic.
    std::string target;
    float fov_degrees = 35.0f;
    std::string size = "1024x768";
    /// Pictures of pixel receivers have alpha and no environment behind them.
    bool transparent = false;
    /// Texel receivers: texels around the charts
    std::uint32_t gutter = 16;

    /// Adds -o and the others; returns -o, which is required until its caller says otherwise.
    Option add_to(Command& command);

    /// Refuses what cannot be written, or is one of the inputs, before any work is done.
    void check(const std::vector<std::string>& inputs) const;

    /// Refuses outputs and options that the scene's receivers have no use for: meshes of pixels and
    /// texels, a camera where there is none to choose. Throws std::runtime_error.
    void check_fits(const Scene& scene) const;

    /// The same for the library: camera and colours as this scene has them. Throws
    /// std::runtime_error for colours that its mesh does not have.
    [[nodiscard]] relumine::OutputOptions for_scene(const Scene& scene) const;

    /// Writes by extension: .png .exr pictures (of texel receivers: their lightmap), .ply .glb
    /// meshes with vertex colours, .npy numbers.
    void save(const LitScene& lit, std::span<const glm::vec3> radiance,
              const cubemap::CubeMap& environment) const;

    /// What to tell the user where a .png comes out far too bright or too dark and no exposure was
    /// chosen: "; --exposure -3 suits it better", else nothing, as where the session is silent.
    [[nodiscard]] std::string exposure_hint(const Scene& scene, std::span<const glm::vec3> radiance,
                                            const Session& session) const;

private:
    Option exposure_option_;
    /// --eye, --target, --fov, --size
    std::vector<Option> camera_options_;
};

/// A path's extension in small letters, with the dot.
[[nodiscard]] std::string extension_of(const std::string& path);

/// Throws UsageError unless an option's path has one of these extensions (capital letters are
/// allowed).
void require_extension(const std::string& option, const std::string& path,
                       const std::vector<std::string>& extensions);

/// The same for environments: .exr or .hdr.
void require_environment_name(const std::string& option, const std::string& path);

/// Throws std::runtime_error when `path` cannot be written or is one of the inputs, under whatever
/// name.
void check_output(const std::string& path, const std::vector<std::string>& inputs);

} // namespace relumine::app
