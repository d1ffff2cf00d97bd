#include "relumine/out/output_options.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "relumine/options/option_table.h"

namespace relumine {

namespace {

/// A number above 0
bool is_in(const std::optional<double>& number, double max) {
    return number && *number > 0.0 && *number <= max;
}

constexpr std::string_view Blur = "blur=";

} // namespace

Albedo AlbedoText::read(const std::string& text) {
    if (text == "auto")
        return AutomaticAlbedo{};
    if (text == "mesh")
        return MeshColors{};
    return ColorText::read(text);
}

std::string AlbedoText::show(const Albedo& albedo) {
    if (const auto* color = std::get_if<glm::vec3>(&albedo))
        return ColorText::show(*color);
    return std::holds_alternative<MeshColors>(albedo) ? "mesh" : "auto";
}

Background BackgroundText::read(const std::string& text) {
    if (text == "none")
        return NothingBehind{};
    if (text == "sharp")
        return EnvironmentBehind{};
    if (text.starts_with(Blur)) {
        const std::optional<double> degrees = parse_number(text.substr(Blur.size()));
        if (!is_in(degrees, 180.0))
            refuse_text("blur=DEG of up to 180 degrees", text);
        return EnvironmentBehind{.blur_degrees = *degrees};
    }
    if (text.empty() || std::isalpha(static_cast<unsigned char>(text.front())) != 0)
        refuse_text("sharp, blur=DEG, none, R,G,B or one number", text);
    return ColorText::read(text);
}

std::string BackgroundText::show(const Background& background) {
    if (const auto* color = std::get_if<glm::vec3>(&background))
        return ColorText::show(*color);
    const auto* environment = std::get_if<EnvironmentBehind>(&background);
    if (environment == nullptr)
        return "none";
    return environment->blur_degrees > 0.0 ? fmt::format("{}{}", Blur, environment->blur_degrees)
                                           : "sharp";
}

std::optional<double> ExposureText::read(const std::string& text) {
    if (text == "auto")
        return std::nullopt;
    const std::optional<double> stops = parse_number(text);
    if (!stops || !(std::abs(*stops) <= 100.0))
        refuse_text("auto or stops from -100 to 100", text);
    return stops;
}

std::string ExposureText::show(const std::optional<double>& stops) {
    return stops ? fmt::format("{}", *stops) : "auto";
}

CameraPlace CameraText::read(const std::string& text) {
    std::vector<std::string> words = split(text, ',');
    std::vector<std::optional<double>> numbers;
    numbers.reserve(words.size());
    for (const std::string& word : words)
        numbers.push_back(parse_number(word));
    // The distance may be empty where a field of view follows.
    const std::size_t count = words.size();
    const bool has_distance = count == 3 || (count == 4 && !words[2].empty());
    if (count < 2 || count > 4 || !numbers[0] || !numbers[1] || (has_distance && !numbers[2]) ||
        (count == 4 && !numbers[3]))
        refuse_text("AZIMUTH,ELEVATION[,DISTANCE][,FOV]", text);
    CameraPlace place{.angles = {.azimuth = *numbers[0], .elevation = *numbers[1]}};
    if (!(std::abs(place.angles.azimuth) <= 36000.0))
        refuse_text("an azimuth within 36000 degrees", text);
    if (!(std::abs(place.angles.elevation) <= 90.0))
        refuse_text("an elevation from -90 to 90 degrees", text);
    if (has_distance) {
        place.angles.distance = numbers[2];
        if (!is_in(numbers[2], LargestPosition))
            refuse_text("a distance above 0", text);
    }
    if (count == 4) {
        place.fov_degrees = static_cast<float>(*numbers[3]);
        if (!(*place.fov_degrees > 0.0f && *place.fov_degrees < 180.0f))
            refuse_text("a field of view between 0 and 180 degrees", text);
    }
    return place;
}

std::string CameraText::show(const CameraPlace& place) {
    const auto number = [](const auto& value) {
        return value ? fmt::format("{}", *value) : std::string();
    };
    std::string text = fmt::format("{},{}", place.angles.azimuth, place.angles.elevation);
    if (place.angles.distance || place.fov_degrees)
        text += "," + number(place.angles.distance);
    return place.fov_degrees ? text + "," + number(place.fov_degrees) : text;
}

OptionRow size_row(std::uint32_t& width, std::uint32_t& height, std::string help,
                   OptionFacts facts) {
    OptionRow result{std::move(facts), "--size", std::move(help)};
    result.type = "TEXT";
    result.example = "640x480";
    result.read = [&width, &height,
                   least = std::max(result.min, 1.0)](std::span<const std::string> texts) {
        std::string text = texts.back();
        std::replace(text.begin(), text.end(), ',', 'x'); // of a list
        const auto sides = parse_sides(text);
        if (!sides)
            refuse_text("WIDTHxHEIGHT", texts.back());
        const auto is_side = [least](std::uint32_t side) {
            return side >= least && side <= prt::MaxPictureSize;
        };
        if (!is_side(sides->first) || !is_side(sides->second))
            refuse_text(fmt::format("{} to {} pixels a side", least, prt::MaxPictureSize),
                        texts.back());
        std::tie(width, height) = *sides;
    };
    result.show = [&width, &height] {
        return fmt::format("{}x{}", width, height);
    };
    result.initial = result.show();
    return result;
}

void check(const OutputOptions& options) {
    if (!options.camera_place)
        return;
    if (options.eye)
        throw OptionError("--camera", "expected either --camera or --eye, got both");
    if (options.camera_place->fov_degrees && options.fov_degrees)
        throw OptionError("--camera", fmt::format("expected either a field of view here or --fov, "
                                                  "got '{}'",
                                                  CameraText::show(*options.camera_place)));
}

Camera camera_of(const Scene& scene, const OutputOptions& options) {
    if (options.camera)
        return *options.camera;
    check(options);
    const CameraPlace place = options.camera_place.value_or(CameraPlace{});
    relight::Framing framing{.angles = place.angles,
                             .aspect = static_cast<float>(options.width) /
                                       static_cast<float>(options.height)};
    if (const auto fov = place.fov_degrees ? place.fov_degrees : options.fov_degrees)
        framing.fov_degrees = *fov;
    const bool is_plain = !options.camera_place;
    const std::optional<Camera> own = is_plain ? own_camera(scene, framing.aspect) : std::nullopt;
    const bool chooses_side = is_plain && !options.eye && !options.target;
    Camera camera = own            ? *own
                    : chooses_side ? relight::framed_from_open_side(scene.mesh, framing)
                                   : relight::framed(scene.mesh, framing);
    if (own && !scene.settings.view) {
        // The automatic camera of a room is wide. An eye that was chosen is as other eyes.
        const bool is_chosen = options.eye && !scene.settings.camera;
        camera.fov_degrees =
            options.fov_degrees.value_or(is_chosen ? framing.fov_degrees : camera.fov_degrees);
    }
    if (options.target || options.eye)
        camera.roll_degrees = 0.0f; // that of the file's own view
    if (options.target) {
        const glm::vec3 target = place_in(scene.mesh, *options.target);
        camera.eye += target - camera.target;
        camera.target = target;
    }
    if (options.eye)
        camera.eye = place_in(scene.mesh, *options.eye);
    return camera;
}

bool is_other_eye(const Scene& scene, const OutputOptions& options) {
    if (!prt::on_vertices(scene.layout) || !scene.settings.glossy_tolerance || !scene.settings.view)
        return false;
    constexpr float Same = 1e-3f; // of the distance
    const Camera camera = camera_of(scene, options);
    return glm::distance(camera.eye, scene.settings.view->eye) >
           Same * glm::distance(camera.eye, camera.target);
}

OptionTable options_of(OutputOptions& o) {
    constexpr unsigned OnVertices = OptionFacts::OnVertices;
    constexpr unsigned NoTexels = OptionFacts::OnVertices | OptionFacts::OnPixels;
    return {
        row<AlbedoText>("--albedo", o.albedo,
                        "reflectance: a number, R,G,B, `mesh` for the mesh's vertex colours, or "
                        "auto: the mesh's own, else 0.5 in pictures and 1 in .npy",
                        {.example = "0.25"}),
        row("--floor", o.floor,
            "what an added floor looks like: the photographed ground with shadows, a studio's "
            "plain floor, a grey disc; auto: as the environment suggests",
            {.receivers = NoTexels, .part = "floor"}),
        row("--photo-height", o.photo_height,
            "height above the floor from which the environment was photographed, in the mesh's "
            "unit (the mesh's longest side)",
            {.min = 1e-6,
             .max = LargestPosition,
             .type = "LENGTH",
             .receivers = NoTexels,
             .part = "floor"}),
        row<ColorText>("--floor-albedo", o.floor_albedo,
                       "reflectance of the floor of --floor: a number or R,G,B (0.3; 1 in .npy)",
                       {.example = "0.7,0.6,0.5"}),
        row<EmissionText>("--emission", o.emission,
                          "factor on the light that lamps, screens and unlit surfaces give of "
                          "their own: a number or R,G,B; NAME=GAIN[,R,G,B] for one group that "
                          "glows or one light of the mesh's file; NAME=PROFILE.ies gives a light "
                          "the shape of a measured lamp",
                          {.example = "0.5"}),
        row<ExposureText>("--exposure", o.exposure_ev,
                          "stops that brighten pictures and colours, or auto: what suits what is "
                          "seen; 0 for .exr and .npy",
                          {.example = "1.5"}),
        row("--tone-map", o.tone,
            "how a screen shows what is brighter than white, in .png and the window"),
        row<CameraText>("--camera", o.camera_place,
                        "AZIMUTH,ELEVATION[,DISTANCE][,FOV]: degrees to the right of the "
                        "front and above the horizon (24,20), distance (fills two thirds)",
                        {.example = "30,40", .receivers = OnVertices, .part = "camera"}),
        row<PointText>("--eye", o.eye, "camera position X,Y,Z in place of --camera",
                       {.example = "1,2,3", .receivers = OnVertices, .part = "camera"}),
        row<PointText>("--target", o.target, "point that the camera looks at, X,Y,Z (automatic)",
                       {.example = "0,0.1,0", .receivers = OnVertices, .part = "camera"}),
        row("--fov", o.fov_degrees, "vertical field of view in degrees (35)",
            {.min = 0.01, .max = 179, .receivers = OnVertices, .part = "camera"}),
        size_row(o.width, o.height, "picture size WIDTHxHEIGHT",
                 {.receivers = OnVertices, .part = "camera"}),
        row<BackgroundText>("--background", o.background,
                            "behind the mesh: sharp or blur=DEG (the environment), none (alpha; "
                            "premultiplied in .exr), a number or R,G,B",
                            {.example = "blur=5", .receivers = NoTexels, .part = "background"}),
        row("--sun", o.sun,
            "pictures of vertices: where shadows of the sun are traced, and on an added floor "
            "those of windows and soft boxes"),
        row("--highlight-rays", o.highlight_rays,
            "rays a pixel that find what glossy surfaces mirror, where the scene stores no "
            "highlights; 0: none, all is matte (of pixels: relight, edit and animate)",
            {.min = 0, .max = 4096, .receivers = NoTexels, .part = "highlights"})};
}

} // namespace relumine
