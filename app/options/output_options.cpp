#include "app/options/output_options.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "app/options/size_text.h"
#include "app/session.h"
#include "files/output_file.h"
#include "relight/pictures/framing.h"

namespace relumine::app {

namespace {

relight::PictureOptions picture_size(const std::string& text) {
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

/// Numbers with commas between; an empty one is allowed where `may_be_empty` says so.
std::vector<std::optional<double>> numbers_of(const std::string& text) {
    std::vector<std::optional<double>> numbers;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        numbers.push_back(parse_number(text.substr(begin, end - begin)));
        if (!numbers.back() && end != begin)
            return {};
        begin = end + 1;
    }
    return numbers;
}

/// What --camera, --front and --fov say.
relight::Framing parse_framing(const OutputOptions& options) {
    relight::Framing framing;
    const std::string& front = options.front;
    const double sign = front.front() == '-' ? -1.0 : 1.0;
    framing.front = front.back() == 'x' ? glm::dvec3(sign, 0, 0) : glm::dvec3(0, 0, sign);
    if (options.fov_degrees)
        framing.fov_degrees = *options.fov_degrees;
    if (options.camera.empty())
        return framing;
    const auto refuse = [&](const std::string& expected) {
        throw UsageError("--camera",
                         fmt::format("expected {}, got '{}'", expected, options.camera));
    };
    const std::vector<std::optional<double>> numbers = numbers_of(options.camera);
    if (numbers.size() < 2 || numbers.size() > 4 || !numbers[0] || !numbers[1] ||
        (numbers.size() == 4 && !numbers[3]) || (numbers.size() == 3 && !numbers[2]))
        refuse("AZIMUTH,ELEVATION[,DISTANCE][,FOV]");
    framing.angles = {.azimuth = *numbers[0], .elevation = *numbers[1]};
    if (!(std::abs(framing.angles.azimuth) <= 36000.0))
        refuse("an azimuth within 36000 degrees");
    if (!(std::abs(framing.angles.elevation) <= 90.0))
        refuse("an elevation from -90 to 90 degrees");
    if (numbers.size() > 2 && numbers[2]) {
        framing.angles.distance = numbers[2];
        if (!(*numbers[2] > 0.0 && *numbers[2] <= 1e18))
            refuse("a distance above 0");
    }
    if (numbers.size() == 4) {
        if (options.fov_degrees)
            refuse("either a field of view here or --fov");
        framing.fov_degrees = static_cast<float>(*numbers[3]);
    }
    if (!(framing.fov_degrees > 0.0f && framing.fov_degrees < 180.0f))
        refuse("a field of view between 0 and 180 degrees");
    return framing;
}

/// The scene's own camera, moved as the options say.
Camera camera_for(const OutputOptions& options, const Scene& scene,
                  const relight::PictureOptions& size) {
    relight::Framing framing = parse_framing(options);
    framing.aspect = size.aspect();
    const bool is_plain = options.camera.empty() && options.front == OutputOptions{}.front;
    Camera camera = is_plain && scene.settings.view ? *scene.settings.view
                                                    : relight::framed(scene.mesh, framing);
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
    if (text == "auto")
        return AutomaticAlbedo{};
    if (text == "mesh")
        return MeshColors{};
    return parse_color("--albedo", text);
}

Background parse_background(const OutputOptions& options) {
    const std::string& text = options.background;
    if (options.transparent && text != OutputOptions{}.background && text != "none")
        throw UsageError("--transparent", "expected no --background beside it");
    if (options.transparent || text == "none")
        return NothingBehind{};
    if (text == "sharp")
        return EnvironmentBehind{};
    constexpr std::string_view Blur = "blur=";
    if (text.starts_with(Blur)) {
        const std::optional<double> degrees = parse_number(text.substr(Blur.size()));
        if (!degrees || !(*degrees > 0.0 && *degrees <= 180.0))
            throw UsageError("--background",
                             fmt::format("expected blur=DEG of up to 180 degrees, got '{}'", text));
        return EnvironmentBehind{.blur_degrees = *degrees};
    }
    if (text.empty() || std::isalpha(static_cast<unsigned char>(text.front())) != 0)
        throw UsageError(
            "--background",
            fmt::format("expected sharp, blur=DEG, none, R,G,B or one number, got '{}'", text));
    return parse_color("--background", text);
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
                    "reflectance: a number, R,G,B, `mesh` for the mesh's vertex colours, or auto: "
                    "the mesh's own, else 0.5 in pictures and 1 in .npy")
        .show_default();
    command.add_option("--floor-albedo", floor_albedo,
                       "reflectance of the floor of --floor: a number or R,G,B (0.3; 1 in .npy)");
    command
        .add_option("--floor-fade", floor_fade,
                    "outer part of the floor's radius over which it fades into the background")
        .between(0.0, 1.0)
        .show_default();
    add_exposure_options(command, exposure, tone_map);
    camera_options_ = {
        command.add_option("--camera", camera,
                           "AZIMUTH,ELEVATION[,DISTANCE][,FOV]: degrees to the right of the "
                           "front and above the horizon (24,20), distance (fills two thirds)"),
        command.add_option("--front", front, "the side that the mesh shows a camera of azimuth 0")
            .one_of({"+z", "-z", "+x", "-x"})
            .show_default(),
        command.add_option("--eye", eye, "camera position X,Y,Z in place of --camera"),
        command.add_option("--target", target, "point that the camera looks at, X,Y,Z (automatic)"),
        command.add_option("--fov", fov_degrees, "vertical field of view in degrees (35)")
            .between(0.01, 179.0),
        command.add_option("--size", size, "picture size WIDTHxHEIGHT").show_default()};
    background_options_ = {
        command
            .add_option("--background", background,
                        "behind the mesh: sharp or blur=DEG (the environment), none (alpha; "
                        "premultiplied in .exr), a number or R,G,B")
            .show_default(),
        command.add_flag("--transparent", transparent, "the same as --background none")};
    command.add_option("--sun", sun, "pictures of vertices: where shadows of the sun are traced")
        .one_of({"pixel", "vertex"})
        .show_default();
    command.add_option("--gutter", gutter, "lightmaps: texels filled around the charts")
        .between(0, 16384)
        .show_default();
    return output;
}

void OutputOptions::check(const std::vector<std::string>& inputs) const {
    require_extension("--output", path, {".png", ".exr", ".ply", ".glb", ".npy"});
    check_output(path, inputs);
    static_cast<void>(picture_size(size));
    static_cast<void>(parse_albedo(albedo));
    if (!floor_albedo.empty())
        static_cast<void>(parse_color("--floor-albedo", floor_albedo));
    static_cast<void>(exposure_ev());
    static_cast<void>(parse_framing(*this));
    if (!camera.empty() && !eye.empty())
        throw UsageError("--camera", "expected either --camera or --eye, got both");
    static_cast<void>(parse_background(*this));
    for (const auto& [option, text] : {std::pair{"--eye", &eye}, std::pair{"--target", &target}})
        if (!text->empty())
            static_cast<void>(parse_vec3(option, *text));
}

void OutputOptions::check_fits(const Scene& scene) const {
    if (prt::on_vertices(scene.layout))
        return;
    const std::string extension = extension_of(path);
    if (extension == ".ply" || extension == ".glb")
        throw UsageError(
            "--output",
            fmt::format("expected .png, .exr or .npy for a scene whose receivers are {}, got '{}'",
                        prt::description(scene.layout), path));
    const auto refuse = [&](const std::vector<Option>& options, const char* what) {
        for (const Option& option : options)
            if (option.is_given())
                throw UsageError(option.name(),
                                 fmt::format("expected no {} for a scene whose receivers are {}, "
                                             "got one",
                                             what, prt::description(scene.layout)));
    };
    refuse(camera_options_, "camera");
    if (!prt::kind_of(scene.layout).are_seen)
        refuse(background_options_, "background");
}

relumine::OutputOptions OutputOptions::for_scene(const Scene& scene) const {
    relumine::OutputOptions result{
        .albedo = parse_albedo(albedo),
        .floor_fade = floor_fade,
        .exposure_ev = exposure_ev(),
        .tone = relight::tone_curve(tone_map).value_or(ToneCurve::Neutral),
        .sun = sun == "pixel" ? SunShadows::Pixels : SunShadows::Receivers,
        .background = parse_background(*this),
        .gutter = gutter};
    if (!floor_albedo.empty())
        result.floor_albedo = parse_color("--floor-albedo", floor_albedo);
    if (std::holds_alternative<MeshColors>(result.albedo) && scene.mesh.colors.empty())
        throw UsageError("--albedo",
                         "expected a mesh with vertex colours for `mesh`, got one without");
    if (prt::on_vertices(scene.layout)) {
        const relight::PictureOptions picture = picture_size(size);
        result.width = picture.width;
        result.height = picture.height;
        result.camera = camera_for(*this, scene, picture);
    }
    return result;
}

std::string OutputOptions::settings() const {
    return fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} {}", albedo, floor_albedo,
                       floor_fade, exposure, tone_map, camera, front, eye, target,
                       fov_degrees.value_or(0.0f), size, background, transparent, sun, gutter);
}

std::optional<double> OutputOptions::exposure_ev() const {
    return parse_exposure(exposure);
}

std::string OutputOptions::exposure_text(const Painter& painter) const {
    const std::string extension = extension_of(path);
    if (extension == ".npy" || extension == ".exr")
        return "";
    return fmt::format("; exposure {:.2f}{}", painter.exposure_ev(path),
                       exposure_ev() ? "" : " (auto)");
}

void add_exposure_options(Command& command, std::string& exposure, std::string& tone_map) {
    command
        .add_option("--exposure", exposure,
                    "stops that brighten pictures and colours, or auto: what suits what is seen; 0 "
                    "for .exr and .npy")
        .show_default();
    command
        .add_option("--tone-map", tone_map,
                    "how a screen shows what is brighter than white, in .png and the window")
        .one_of({relight::ToneCurveNames.begin(), relight::ToneCurveNames.end()})
        .show_default();
}

std::optional<double> parse_exposure(const std::string& text) {
    if (text == "auto")
        return std::nullopt;
    const std::optional<double> stops = parse_number(text);
    if (!stops || !(std::abs(*stops) <= 100.0))
        throw UsageError("--exposure",
                         fmt::format("expected auto or stops from -100 to 100, got '{}'", text));
    return stops;
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
