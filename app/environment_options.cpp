#include "app/environment_options.h"

#include <array>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

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

relumine::EnvironmentOptions options_of(const EnvironmentOptions& options) {
    relumine::EnvironmentOptions result{.face_resolution = options.face_resolution,
                                        .fix_bad_pixels = options.fix,
                                        .rotate_degrees = options.rotate_degrees};
    if (!options.layout.empty())
        result.layout = parse_layout(options.layout);
    return result;
}

void tell(const EnvironmentOptions& options, const std::string& assumptions,
          std::size_t num_fixed_pixels, const Session& session) {
    session.detail(fmt::format("{}: {}", options.path, assumptions));
    if (num_fixed_pixels != 0)
        session.add_to_report("replaced_pixels", num_fixed_pixels);
    if (num_fixed_pixels != 0)
        session.say(fmt::format("{}: replaced {} bad pixels", options.path, num_fixed_pixels));
    session.poll();
}

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
        .between(0, 16384)
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
    cubemap::EnvironmentImage image = load_environment_image(options.path, options_of(options));
    tell(options, image.assumptions, image.fixed ? image.bad_pixels.count() : 0, session);
    return image;
}

cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                             const EnvironmentOptions& options) {
    return relumine::cube_map_of(image, options_of(options));
}

Environment load_environment(const EnvironmentOptions& options, const Session& session) {
    Environment environment = relumine::load_environment(options.path, options_of(options));
    tell(options, environment.assumptions, environment.num_fixed_pixels, session);
    return environment;
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
