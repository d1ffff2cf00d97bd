#include "app/output_options.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/session.h"
#include "app/size_text.h"
#include "cubemap/resample/resample.h"
#include "files/output_file.h"
#include "mesh/save.h"
#include "relight/pictures/array_file.h"
#include "relight/pictures/exposure.h"
#include "relight/pictures/picture.h"
#include "relight/pictures/receiver_picture.h"

namespace relumine::app {

namespace {

relight::PictureOptions parse_size(const std::string& text) {
    const std::optional<SizeText> size = parse_size_text(text);
    if (!size)
        throw CLI::ValidationError("--size", fmt::format("expected WIDTHxHEIGHT, got '{}'", text));
    relight::PictureOptions options;
    options.width = size->width;
    options.height = size->height;
    return options;
}

/// The options', or else the view that the scene's highlights are for, or one that shows the mesh.
relight::Camera camera_of(const OutputOptions& options, const prt::Scene& scene) {
    relight::Camera camera =
        scene.settings.view
            ? *scene.settings.view
            : relight::automatic_camera(scene.mesh, parse_size(options.size), options.fov_degrees);
    if (!options.target.empty()) {
        const glm::vec3 target = parse_vec3("--target", options.target);
        camera.eye += target - camera.target;
        camera.target = target;
    }
    if (!options.eye.empty())
        camera.eye = parse_vec3("--eye", options.eye);
    return camera;
}

/// The factor of --albedo, nothing for the mesh's own colours.
std::optional<glm::vec3> parse_albedo(const std::string& text) {
    if (text == "mesh")
        return std::nullopt;
    return parse_color("--albedo", text);
}

/// Radiance times albedo: one factor for all, or the mesh's own colours.
std::vector<glm::vec3> coloured(const std::string& albedo, const prt::Scene& scene,
                                std::span<const glm::vec3> radiance) {
    std::vector<glm::vec3> result(radiance.begin(), radiance.end());
    const std::optional<glm::vec3> factor = parse_albedo(albedo);
    if (!factor) {
        if (scene.mesh.colors.empty())
            throw std::runtime_error(
                "--albedo mesh: expected a mesh with vertex colours, got one without");
        const std::vector<glm::vec3> colors = prt::colors_at(scene.mesh, scene.receivers);
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] *= colors[i];
        return result;
    }
    for (glm::vec3& value : result)
        value *= *factor;
    return result;
}

bool is_picture(const std::string& extension) {
    return extension == ".png" || extension == ".exr";
}

/// What the receivers show: the mesh from the camera of the options, their own view, or their
/// lightmap.
relight::Picture picture_of(const OutputOptions& options, const LitScene& lit,
                            std::span<const glm::vec3> colors,
                            const cubemap::CubeMap& environment) {
    const prt::Scene& scene = lit.scene();
    if (const auto* pixels = std::get_if<prt::PixelLayout>(&scene.layout))
        return options.transparent ? relight::compose_cut_out(*pixels, colors)
                                   : relight::compose(*pixels, colors, environment);
    if (const auto* texels = std::get_if<prt::TexelLayout>(&scene.layout))
        return relight::compose(*texels, colors, options.gutter);
    return relight::draw(scene.mesh, lit.rays(), colors, environment, camera_of(options, scene),
                         parse_size(options.size));
}

} // namespace

void OutputOptions::add_to(CLI::App& command) {
    command
        .add_option("-o,--output", path,
                    "what to write: .png .exr (picture), .ply .glb (mesh with vertex colours), "
                    ".npy (numbers)")
        ->required();
    command
        .add_option("--albedo", albedo,
                    "reflectance: a number, R,G,B, or `mesh` for the mesh's vertex colours")
        ->capture_default_str();
    exposure_option_ = command
                           .add_option("--exposure", exposure_ev,
                                       "brighten pictures and colours by this many stops")
                           ->check(number_between(-100.0, 100.0))
                           ->capture_default_str();
    camera_options_ = {
        command.add_option("--eye", eye, "camera position X,Y,Z (automatic)"),
        command.add_option("--target", target, "point that the camera looks at, X,Y,Z (automatic)"),
        command.add_option("--fov", fov_degrees, "vertical field of view in degrees")
            ->capture_default_str(),
        command.add_option("--size", size, "picture size WIDTHxHEIGHT")->capture_default_str()};
    command.add_flag("--transparent", transparent,
                     "scenes of pixels: no environment behind, but alpha (premultiplied in .exr)");
    command.add_option("--gutter", gutter, "lightmaps: texels filled around the charts")
        ->check(CLI::Range(0, 16384))
        ->capture_default_str();
}

void OutputOptions::check(const std::vector<std::string>& inputs) const {
    constexpr std::array<const char*, 5> Known = {".png", ".exr", ".ply", ".glb", ".npy"};
    const std::string extension = extension_of(path);
    if (std::find(Known.begin(), Known.end(), extension) == Known.end())
        throw std::runtime_error(
            fmt::format("{}: expected .png, .exr, .ply, .glb or .npy, got '{}'", path, extension));
    check_output(path, inputs);
    static_cast<void>(parse_size(size));
    static_cast<void>(parse_albedo(albedo));
    for (const auto& [option, text] : {std::pair{"--eye", &eye}, std::pair{"--target", &target}})
        if (!text->empty())
            static_cast<void>(parse_vec3(option, *text));
}

void OutputOptions::check_fits(const prt::Scene& scene) const {
    if (transparent && !std::holds_alternative<prt::PixelLayout>(scene.layout))
        throw std::runtime_error(
            fmt::format("--transparent: expected a scene whose receivers are pixels, got {}",
                        prt::description(scene.layout)));
    if (std::holds_alternative<prt::VertexLayout>(scene.layout))
        return;
    const std::string extension = extension_of(path);
    if (extension == ".ply" || extension == ".glb")
        throw std::runtime_error(fmt::format(
            "{}: expected .png, .exr or .npy for a scene whose receivers are {}, got '{}'", path,
            prt::description(scene.layout), extension));
    for (const CLI::Option* option : camera_options_)
        if (option->count() > 0)
            throw std::runtime_error(
                fmt::format("{}: expected no camera for a scene whose receivers are {}, got one",
                            option->get_name(), prt::description(scene.layout)));
}

void OutputOptions::save(const LitScene& lit, std::span<const glm::vec3> radiance,
                         const cubemap::CubeMap& environment) const {
    const prt::Scene& scene = lit.scene();
    std::vector<glm::vec3> colors = coloured(albedo, scene, radiance);
    const std::string extension = extension_of(path);
    if (is_picture(extension)) {
        relight::save_picture(path, picture_of(*this, lit, colors, environment), exposure_ev);
        return;
    }
    const auto scale = static_cast<float>(std::exp2(exposure_ev));
    for (glm::vec3& color : colors)
        color *= scale;
    if (extension == ".npy")
        relight::save_npy(path, colors);
    else
        mesh::save(path, scene.mesh, colors);
}

std::string OutputOptions::exposure_hint(const prt::Scene& scene,
                                         std::span<const glm::vec3> radiance,
                                         const Session& session) const {
    if (session.json || session.quiet || exposure_option_->count() > 0 ||
        extension_of(path) != ".png")
        return "";
    const float better = relight::suitable_exposure_ev(coloured(albedo, scene, radiance));
    return better == 0.0f ? "" : fmt::format("; --exposure {} suits it better", better);
}

void FrameWriter::save(const std::string& path, std::span<const glm::vec3> radiance,
                       const cubemap::CubeMap& environment) {
    const std::string extension = extension_of(path);
    const bool on_vertices = std::holds_alternative<prt::VertexLayout>(lit_.scene().layout);
    if (!is_picture(extension) || !on_vertices) {
        OutputOptions options = options_;
        options.path = path;
        options.save(lit_, radiance, environment);
        return;
    }
    const mesh::TriangleMesh& mesh = lit_.scene().mesh;
    if (!view_)
        view_ = std::make_unique<relight::PictureView>(
            mesh, lit_.rays(), camera_of(options_, lit_.scene()), parse_size(options_.size));
    relight::save_picture(
        path, view_->draw(coloured(options_.albedo, lit_.scene(), radiance), environment),
        options_.exposure_ev);
}

std::vector<glm::vec3> FrameWriter::values(std::span<const glm::vec3> radiance) const {
    std::vector<glm::vec3> values = coloured(options_.albedo, lit_.scene(), radiance);
    const auto scale = static_cast<float>(std::exp2(options_.exposure_ev));
    for (glm::vec3& value : values)
        value *= scale;
    return values;
}

std::string extension_of(const std::string& path) {
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
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

void save_map(const std::string& path, const cubemap::CubeMap& map, double exposure_ev) {
    const cubemap::EnvironmentImage image =
        cubemap::to_image(map, cubemap::Layout::LatLong, 4 * map.resolution, 2 * map.resolution);
    double white_ev = 0.0;
    if (extension_of(path) == ".png") {
        // One pixel in a thousand may be brighter than white: a sun must not leave the rest black.
        std::vector<float> brightness;
        for (const glm::vec3& pixel : image.pixels)
            brightness.push_back(std::max({pixel.r, pixel.g, pixel.b}));
        const auto white =
            brightness.end() - 1 - static_cast<std::ptrdiff_t>(brightness.size() / 1000);
        std::nth_element(brightness.begin(), white, brightness.end());
        white_ev = *white > 0.0f ? -std::log2(static_cast<double>(*white)) : 0.0;
    }
    relight::save_picture(path,
                          {.width = image.width, .height = image.height, .pixels = image.pixels},
                          exposure_ev + white_ev);
}

} // namespace relumine::app
