#include "app/output_options.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/session.h"
#include "app/size_text.h"
#include "files/output_file.h"
#include "relight/pictures/exposure.h"

namespace relumine::app {

namespace {

relight::PictureOptions parse_size(const std::string& text) {
    const std::optional<SizeText> size = parse_size_text(text);
    if (!size)
        throw UsageError("--size", fmt::format("expected WIDTHxHEIGHT, got '{}'", text));
    const auto is_side = [](std::uint32_t side) {
        return side >= 1 && side <= prt::MaxPictureSize;
    };
    if (!is_side(size->width) || !is_side(size->height))
        throw UsageError("--size", fmt::format("expected 1 to {} pixels a side, got '{}'",
                                               prt::MaxPictureSize, text));
    relight::PictureOptions options;
    options.width = size->width;
    options.height = size->height;
    return options;
}

/// The scene's own camera, moved as the options say.
Camera camera_for(const OutputOptions& options, const Scene& scene,
                  const relight::PictureOptions& size) {
    Camera camera = camera_of(scene, size, options.fov_degrees);
    if (!options.target.empty()) {
        const glm::vec3 target = parse_vec3("--target", options.target);
        camera.eye += target - camera.target;
        camera.target = target;
    }
    if (!options.eye.empty())
        camera.eye = parse_vec3("--eye", options.eye);
    return camera;
}

Albedo parse_albedo(const std::string& text) {
    if (text == "mesh")
        return MeshColors{};
    return parse_color("--albedo", text);
}

} // namespace

Option OutputOptions::add_to(Command& command) {
    const Option output =
        command
            .add_option("-o,--output", path,
                        "what to write: .png .exr (picture), .ply .glb (mesh with vertex colours), "
                        ".npy (numbers)")
            .file()
            .required();
    command
        .add_option("--albedo", albedo,
                    "reflectance: a number, R,G,B, or `mesh` for the mesh's vertex colours")
        .show_default();
    exposure_option_ = command
                           .add_option("--exposure", exposure_ev,
                                       "brighten pictures and colours by this many stops")
                           .between(-100.0, 100.0)
                           .show_default();
    camera_options_ = {
        command.add_option("--eye", eye, "camera position X,Y,Z (automatic)"),
        command.add_option("--target", target, "point that the camera looks at, X,Y,Z (automatic)"),
        command.add_option("--fov", fov_degrees, "vertical field of view in degrees")
            .between(0.01, 179.0)
            .show_default(),
        command.add_option("--size", size, "picture size WIDTHxHEIGHT").show_default()};
    command.add_flag("--transparent", transparent,
                     "scenes of pixels: no environment behind, but alpha (premultiplied in .exr)");
    command.add_option("--gutter", gutter, "lightmaps: texels filled around the charts")
        .between(0, 16384)
        .show_default();
    return output;
}

void OutputOptions::check(const std::vector<std::string>& inputs) const {
    require_extension("--output", path, {".png", ".exr", ".ply", ".glb", ".npy"});
    check_output(path, inputs);
    static_cast<void>(parse_size(size));
    static_cast<void>(parse_albedo(albedo));
    for (const auto& [option, text] : {std::pair{"--eye", &eye}, std::pair{"--target", &target}})
        if (!text->empty())
            static_cast<void>(parse_vec3(option, *text));
}

void OutputOptions::check_fits(const Scene& scene) const {
    if (transparent && !std::holds_alternative<prt::PixelLayout>(scene.layout))
        throw UsageError("--transparent",
                         fmt::format("expected a scene whose receivers are pixels, got {}",
                                     prt::description(scene.layout)));
    if (std::holds_alternative<prt::VertexLayout>(scene.layout))
        return;
    const std::string extension = extension_of(path);
    if (extension == ".ply" || extension == ".glb")
        throw UsageError(
            "--output",
            fmt::format("expected .png, .exr or .npy for a scene whose receivers are {}, got '{}'",
                        prt::description(scene.layout), path));
    for (const Option& option : camera_options_)
        if (option.is_given())
            throw UsageError(
                option.name(),
                fmt::format("expected no camera for a scene whose receivers are {}, got one",
                            prt::description(scene.layout)));
}

relumine::OutputOptions OutputOptions::for_scene(const Scene& scene) const {
    relumine::OutputOptions result{.albedo = parse_albedo(albedo),
                                   .exposure_ev = exposure_ev,
                                   .transparent = transparent,
                                   .gutter = gutter};
    if (std::holds_alternative<MeshColors>(result.albedo) && scene.mesh.colors.empty())
        throw UsageError("--albedo",
                         "expected a mesh with vertex colours for `mesh`, got one without");
    if (std::holds_alternative<prt::VertexLayout>(scene.layout)) {
        const relight::PictureOptions picture = parse_size(size);
        result.width = picture.width;
        result.height = picture.height;
        result.camera = camera_for(*this, scene, picture);
    }
    return result;
}

void OutputOptions::save(const LitScene& lit, std::span<const glm::vec3> radiance,
                         const cubemap::CubeMap& environment) const {
    Painter(lit, for_scene(lit.scene())).save(path, radiance, environment);
}

std::string OutputOptions::exposure_hint(const Scene& scene, std::span<const glm::vec3> radiance,
                                         const Session& session) const {
    if (session.json || session.quiet || exposure_option_.is_given() ||
        extension_of(path) != ".png")
        return "";
    const float better =
        relight::suitable_exposure_ev(colors_of(scene, radiance, parse_albedo(albedo)));
    return better == 0.0f ? "" : fmt::format("; --exposure {} suits it better", better);
}

std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

void require_extension(const std::string& option, const std::string& path,
                       const std::vector<std::string>& extensions) {
    const std::string extension = extension_of(path);
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
        throw UsageError(option, fmt::format("expected a name that ends in {}, got '{}'",
                                             one_of_text(extensions), path));
}

void require_environment_name(const std::string& option, const std::string& path) {
    require_extension(option, path, {".exr", ".hdr"});
}

void check_output(const std::string& path, const std::vector<std::string>& inputs) {
    for (const std::string& input : inputs) {
        std::error_code missing;
        if (std::filesystem::equivalent(path, input, missing))
            throw std::runtime_error(
                fmt::format("{}: expected an output other than the input {}", path, input));
    }
    files::OutputFile{std::filesystem::path(path)};
}

} // namespace relumine::app
