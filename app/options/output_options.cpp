#include "app/options/output_options.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/session.h"
#include "files/joined.h"
#include "files/output_file.h"

namespace relumine::app {

namespace {

/// "CONFIG" or "CONFIG,VIEW"
struct DisplayViewText {
    static constexpr const char* Type = "TEXT";
    static relight::DisplayView read(const std::string& text) {
        const std::size_t comma = text.find(',');
        const std::string view = comma == std::string::npos ? "" : text.substr(comma + 1);
        if (comma == 0 || comma + 1 == text.size())
            refuse_text("CONFIG or CONFIG,VIEW", text);
        return {.config = text.substr(0, comma), .view = view};
    }
    static std::string show(const relight::DisplayView& display) {
        return display.view.empty() ? display.config : display.config + "," + display.view;
    }
};

} // namespace

Option OutputOptions::add_to(Command& command) {
    const Option output =
        command.add(row("-o,--output", path,
                        "what to write: .png .exr (picture), .ply .glb (mesh with vertex colours), "
                        ".npy (numbers)",
                        {.file = true, .required = true}));
    options_ = command.add_all(options_of(picture));
    command.add(row<DisplayViewText>(
        "--ocio", picture.display,
        "CONFIG[,VIEW]: an OpenColorIO config, whose view shows .png in place of --tone-map",
        {.file = true, .excludes = "--tone-map"}));
    return output;
}

void OutputOptions::check(const std::vector<std::string>& inputs) const {
    require_extension("--output", path, {".png", ".exr", ".ply", ".glb", ".npy"});
    check_output(path, inputs);
    relumine::check(picture);
    if (!picture.display.config.empty())
        relight::DisplayTransform{picture.display};
}

void OutputOptions::check_fits(const Scene& scene) const {
    const std::string extension = extension_of(path);
    const bool on_vertices = prt::on_vertices(scene.layout);
    if (!on_vertices && (extension == ".ply" || extension == ".glb"))
        throw OptionError(
            "--output",
            fmt::format("expected .png, .exr or .npy for a scene whose receivers are {}, got '{}'",
                        prt::description(scene.layout), path));
    const unsigned receivers = on_vertices                           ? OptionRow::OnVertices
                               : prt::kind_of(scene.layout).are_seen ? OptionRow::OnPixels
                               : std::holds_alternative<prt::TexelLayout>(scene.layout)
                                   ? OptionRow::OnTexels
                                   : OptionRow::OnPoints;
    for (const Option& option : options_)
        if (option.is_given() && (option.row().receivers & receivers) == 0)
            throw OptionError(option.name(),
                              fmt::format("expected no {} for a scene whose receivers are {}, "
                                          "got one",
                                          option.row().part, prt::description(scene.layout)));
}

const relumine::OutputOptions& OutputOptions::for_scene(const Scene& scene) const {
    if (std::holds_alternative<MeshColors>(picture.albedo) && scene.mesh.colors.empty())
        throw OptionError("--albedo",
                          "expected a mesh with vertex colours for `mesh`, got one without");
    try {
        require_lamps(scene, picture.emission);
    } catch (const std::invalid_argument& error) {
        throw OptionError("--emission", error.what());
    }
    return picture;
}

void OutputOptions::warn_of_picture(const Scene& scene, const Session& session) const {
    const std::string extension = extension_of(path);
    if (extension != ".png" && extension != ".exr")
        return;
    if (picture.floor != FloorLook::Automatic && !first_floor_vertex(scene))
        session.warn("--floor: no floor was added to this scene; the mesh's own is drawn as it is");
    if (is_other_eye(scene, picture))
        session.warn("highlights are those that the eye of the precompute's --view sees; this "
                     "camera stands elsewhere");
}

std::string OutputOptions::exposure_text(const Painter& painter) const {
    const std::string extension = extension_of(path);
    if (extension == ".npy" || extension == ".exr")
        return "";
    return fmt::format("; exposure {:.2f}{}", painter.exposure_ev(path),
                       picture.exposure_ev ? "" : " (auto)");
}

void require_part_name(const std::string& path) {
    constexpr std::array<std::string_view, 9> OfWholes = {".prt", ".plan", ".png", ".npy", ".exr",
                                                          ".hdr", ".ply",  ".glb", ".obj"};
    const std::string extension = extension_of(path);
    if (std::find(OfWholes.begin(), OfWholes.end(), extension) != OfWholes.end())
        throw UsageError("--output",
                         fmt::format("expected a name for a part, such as {}.part.1, "
                                     "got that of a whole, '{}'",
                                     std::filesystem::path(path).stem().string(), path));
}

void require_extension(const std::string& option, const std::string& path,
                       const std::vector<std::string>& extensions) {
    const std::string extension = extension_of(path);
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end())
        throw UsageError(option, fmt::format("expected a name that ends in {}, got '{}'",
                                             files::joined_by_or(extensions), path));
}

void require_environment_name(const std::string& option, const std::string& path) {
    require_extension(option, path, {".exr", ".hdr"});
}

cubemap::FramePattern frame_names(const std::string& path) {
    const auto pattern = cubemap::FramePattern::parse(path);
    if (!pattern)
        throw UsageError("--output",
                         fmt::format("expected a place for the frame's number as in lit.%04d.png, "
                                     "got '{}'",
                                     path));
    return *pattern;
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
