#include "app/environment_options.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cubemap/resample/resample.h"

namespace relumine::app {

namespace {

struct NamedLayout {
    const char* name;
    cubemap::Layout layout;
};
constexpr std::array<NamedLayout, cubemap::AllLayouts.size()> Layouts = {{
    {"latlong", cubemap::Layout::LatLong},
    {"cube", cubemap::Layout::Cube},
    {"strip", cubemap::Layout::HorizontalStrip},
    {"cross", cubemap::Layout::VerticalCross},
    {"hcross", cubemap::Layout::HorizontalCross},
    {"angular", cubemap::Layout::AngularMap},
    {"mirrorball", cubemap::Layout::MirrorBall},
    {"octahedral", cubemap::Layout::Octahedral},
}};

} // namespace

Option EnvironmentOptions::add_to(Command& command) {
    const Option environment =
        command
            .add_option(
                "ENV", path,
                "environment: .exr or .hdr; {face} in the name for six files px nx py ny pz nz")
            .file()
            .required();
    add_conversion_to(command);
    return environment;
}

void EnvironmentOptions::add_conversion_to(Command& command) {
    command
        .add_option("--layout", layout, "layout of the environment, where the file does not tell")
        .one_of(layout_names());
    command
        .add_option("--face-resolution", face_resolution,
                    "texels along a cube face's edge, 0 for the environment's own")
        .show_default();
    command.add_flag("--fix-env", fix,
                     "replace NaN and negative radiance by 0, infinite by the largest finite");
    command
        .add_option("--rotate", rotate_degrees,
                    "turn the environment about +Y, degrees: +Z goes to +X at 90")
        .between(-36000.0, 36000.0)
        .show_default();
}

cubemap::EnvironmentImage load_image(const EnvironmentOptions& options, const Session& session) {
    cubemap::LoadOptions load_options{.fix_bad_pixels = options.fix};
    if (!options.layout.empty())
        load_options.layout = parse_layout(options.layout);
    cubemap::EnvironmentImage image = cubemap::load_environment(options.path, load_options);
    session.detail(fmt::format("{}: {}", options.path, image.assumptions));
    if (image.fixed)
        session.say(
            fmt::format("{}: replaced {} bad pixels", options.path, image.bad_pixels.count()));
    session.poll();
    return image;
}

cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                             const EnvironmentOptions& options) {
    const std::uint32_t resolution =
        options.face_resolution != 0 ? options.face_resolution : cubemap::natural_resolution(image);
    cubemap::CubeMap map = cubemap::resample(image, resolution);
    if (options.rotate_degrees != 0.0)
        map = cubemap::rotated(map, options.rotate_degrees);
    return map;
}

LoadedEnvironment load_environment(const EnvironmentOptions& options, const Session& session) {
    LoadedEnvironment result;
    Stopwatch watch;
    const cubemap::EnvironmentImage image = load_image(options, session);
    result.assumptions = image.assumptions;
    result.seconds_load = watch.lap();
    result.map = cube_map_of(image, options);
    result.seconds_resample = watch.lap();
    session.poll();
    return result;
}

const std::vector<std::string>& layout_names() {
    static const std::vector<std::string> Names = [] {
        std::vector<std::string> names;
        for (const NamedLayout& each : Layouts)
            names.emplace_back(each.name);
        return names;
    }();
    return Names;
}

std::string option_name(cubemap::Layout layout) {
    for (const NamedLayout& each : Layouts)
        if (each.layout == layout)
            return each.name;
    return {};
}

cubemap::Layout parse_layout(const std::string& name) {
    for (const NamedLayout& each : Layouts)
        if (name == each.name)
            return each.layout;
    throw std::invalid_argument(
        fmt::format("layout: expected one of {}, got {}", fmt::join(layout_names(), ", "), name));
}

} // namespace relumine::app
