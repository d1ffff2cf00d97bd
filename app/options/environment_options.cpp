#include "app/options/environment_options.h"
#include "files/joined.h"

#include <iterator>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace relumine::app {

namespace {

void tell(const EnvironmentOptions& options, const std::string& assumptions,
          std::size_t num_fixed_pixels, const Session& session) {
    session.detail(fmt::format("{}: {}", options.path, assumptions));
    if (num_fixed_pixels != 0)
        session.add_to_report("replaced_pixels", num_fixed_pixels);
    if (options.fix && num_fixed_pixels != 0)
        session.say(fmt::format("{}: replaced {} bad pixels", options.path, num_fixed_pixels));
    session.poll();
}

std::vector<std::string> convention_names() {
    std::vector<std::string> names;
    for (const cubemap::Convention& convention : cubemap::conventions())
        names.emplace_back(convention.name);
    return names;
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
    add_reading_to(command);
    command
        .add_option("--face-resolution", face_resolution,
                    "texels along a cube face's edge, 0 for the environment's own")
        .between(0, 16384)
        .show_default();
}

void EnvironmentOptions::add_reading_to(Command& command) {
    command
        .add_option("--layout", layout, "layout of the environment, where the file does not tell")
        .one_of(layout_names());
    command
        .add_option("--from", from,
                    "whose convention the environment follows (`relumine env convert --help`)")
        .one_of(convention_names())
        .show_default();
    command.add_flag("--fix-env", fix,
                     "replace NaN and negative radiance by 0, infinite by the largest finite");
    command
        .add_option("--flip", flip,
                    "mirror the environment along an axis, before --tilt: y turns it upside down")
        .one_of({"x", "y", "z"});
    command
        .add_option("--tilt", tilt_degrees,
                    "turn the environment about +X, degrees, before --rotate: +Y goes to +Z at 90")
        .between(-36000.0, 36000.0)
        .show_default();
    command
        .add_option("--rotate", rotate_degrees,
                    "turn the environment about +Y, degrees: +Z goes to +X at 90")
        .between(-36000.0, 36000.0)
        .show_default();
}

relumine::EnvironmentOptions EnvironmentOptions::for_library() const {
    relumine::EnvironmentOptions result{.from = from,
                                        .face_resolution = face_resolution,
                                        .fix_bad_pixels = fix,
                                        .flip = flip.empty() ? char{0} : flip.front(),
                                        .tilt_degrees = tilt_degrees,
                                        .rotate_degrees = rotate_degrees};
    if (layout.empty())
        return result;
    result.layout = parse_layout(layout);
    if (const cubemap::Convention& convention = *cubemap::find_convention(from);
        !convention.reads(*result.layout))
        throw UsageError("--layout", fmt::format("expected {} with --from {}, got {}",
                                                 layouts_of(convention), from, layout));
    return result;
}

glm::dmat3 EnvironmentOptions::world_from_image(cubemap::Layout image_layout) const {
    return relumine::world_from_image(image_layout, for_library());
}

std::string EnvironmentOptions::settings() const {
    return fmt::format("{} {} {} {} {} {} {}", layout, from, face_resolution, fix, flip,
                       tilt_degrees, rotate_degrees);
}

cubemap::EnvironmentImage load_image(const EnvironmentOptions& options, const Session& session) {
    cubemap::EnvironmentImage image = load_environment_image(options.path, options.for_library());
    tell(options, image.assumptions, image.fixed ? image.bad_pixels.count() : 0, session);
    return image;
}

bool warn_about(const EnvironmentOptions& options, const cubemap::EnvironmentImage& image,
                double light_from_below, Session& session) {
    const std::vector<std::string> warnings = warnings_about(image, light_from_below);
    for (const std::string& warning : warnings)
        session.warn(fmt::format("{}: {}", options.path, warning));
    return !warnings.empty();
}

relight::Backdrop backdrop_of(std::shared_ptr<const cubemap::EnvironmentImage> image,
                              const EnvironmentOptions& options) {
    return relumine::backdrop_of(std::move(image), options.for_library());
}

cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                             const EnvironmentOptions& options) {
    return relumine::cube_map_of(image, options.for_library());
}

Environment load_environment(const EnvironmentOptions& options, Session& session) {
    Environment environment = relumine::load_environment(options.path, options.for_library());
    tell(options, environment.assumptions, environment.num_fixed_pixels, session);
    for (const std::string& warning : environment.warnings)
        session.warn(fmt::format("{}: {}", options.path, warning));
    return environment;
}

const std::vector<std::string>& layout_names() {
    static const std::vector<std::string> Names = [] {
        std::vector<std::string> names;
        names.reserve(cubemap::AllLayouts.size());
        for (const cubemap::Layout layout : cubemap::AllLayouts)
            names.emplace_back(cubemap::option_name(layout));
        return names;
    }();
    return Names;
}

std::string layouts_of(const cubemap::Convention& convention) {
    std::vector<std::string_view> names;
    for (const cubemap::Layout layout : convention.layouts)
        names.push_back(cubemap::option_name(layout));
    return files::joined(names, ", ");
}

cubemap::Layout parse_layout(const std::string& name) {
    if (const auto layout = cubemap::layout_named(name))
        return *layout;
    throw std::invalid_argument(fmt::format("layout: expected one of {}, got {}",
                                            files::joined(layout_names(), ", "), name));
}

} // namespace relumine::app
