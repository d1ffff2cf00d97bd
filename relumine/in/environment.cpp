#include "relumine/in/environment.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "cubemap/doctor/upside_down.h"
#include "cubemap/image/convention.h"
#include "cubemap/resample/load_averaged.h"
#include "cubemap/resample/resample.h"
#include "files/joined.h"
#include "files/pixel_values.h"
#include "files/seconds.h"
#include "lights/sun_split.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

const cubemap::Convention& convention_of(const EnvironmentOptions& options) {
    const cubemap::Convention* found = cubemap::find_convention(options.from);
    if (found == nullptr)
        throw std::invalid_argument(
            fmt::format("environment: expected a known convention, got '{}'", options.from));
    return *found;
}

glm::dmat3 flipped(char axis) {
    glm::dmat3 result(1.0);
    if (axis != 0) {
        const int index = axis - 'x';
        if (index < 0 || index > 2)
            throw std::invalid_argument(
                fmt::format("environment: expected x, y or z as the axis to flip, got '{}'", axis));
        result[index][index] = -1.0;
    }
    return result;
}

cubemap::LoadOptions load_options(const EnvironmentOptions& options) {
    const cubemap::Convention& from = convention_of(options);
    if (options.layout && !from.reads(*options.layout))
        throw OptionError("--layout",
                          fmt::format("expected {} with --from {}, got {}", layouts_of(from),
                                      from.name, cubemap::option_name(*options.layout)));
    cubemap::LoadOptions result{.layout = options.layout, .fix_bad_pixels = options.fix_bad_pixels};
    if (!result.layout && from.layouts.size() == 1)
        result.layout = from.layouts.front();
    return result;
}

/// Applies what does not depend on directions. `name` stands for the image in messages.
cubemap::EnvironmentImage as_convention_has_it(cubemap::EnvironmentImage image,
                                               const std::string& name,
                                               const EnvironmentOptions& options) {
    const cubemap::Convention& from = convention_of(options);
    if (!from.reads(image.layout)) {
        std::vector<std::string_view> names;
        for (const cubemap::Layout layout : from.layouts)
            names.push_back(cubemap::name(layout));
        throw std::runtime_error(fmt::format("{}: expected a {} in the convention of {}, got a {}",
                                             name, files::joined(names, " or "), from.name,
                                             cubemap::name(image.layout)));
    }
    // Programs other than OpenEXR's own do not look at the attribute.
    if (!from.has_attribute && image.sampling == cubemap::Sampling::Borders) {
        image.sampling = cubemap::Sampling::TexelCentres;
        image.assumptions = fmt::format("{} as {} reads it, samples at texel centres",
                                        cubemap::name(image.layout), from.name);
    }
    cubemap::take_faces(from, image);
    return image;
}

} // namespace

std::span<const std::string_view> LayoutText::choices() {
    static const auto Names = [] {
        std::array<std::string_view, cubemap::AllLayouts.size()> names;
        std::transform(cubemap::AllLayouts.begin(), cubemap::AllLayouts.end(), names.begin(),
                       cubemap::option_name);
        return names;
    }();
    return Names;
}

cubemap::Layout LayoutText::read(const std::string& text) {
    return cubemap::AllLayouts.at(option_text::word(choices(), text));
}

std::string LayoutText::show(cubemap::Layout layout) {
    return std::string(cubemap::option_name(layout));
}

std::span<const std::string_view> ConventionText::choices() {
    static const auto Names = [] {
        std::vector<std::string_view> names;
        for (const cubemap::Convention& convention : cubemap::conventions())
            names.push_back(convention.name);
        return names;
    }();
    return Names;
}

std::span<const std::string_view> FlipText::choices() {
    return AxisWords;
}

std::string layouts_of(const cubemap::Convention& convention) {
    std::vector<std::string_view> names;
    for (const cubemap::Layout layout : convention.layouts)
        names.push_back(cubemap::option_name(layout));
    return files::joined(names, ", ");
}

OptionTable options_of(EnvironmentOptions& o) {
    return {row<LayoutText>("--layout", o.layout,
                            "layout of the environment, where the file does not tell"),
            row<ConventionText>("--from", o.from,
                                "whose convention the environment follows (`relumine env convert "
                                "--help`)"),
            row("--fix-env", o.fix_bad_pixels,
                "replace NaN and negative radiance by 0, infinite by the largest finite"),
            row<FlipText>("--flip", o.flip,
                          "mirror the environment along an axis, before --tilt: y turns it upside "
                          "down"),
            row("--tilt", o.tilt_degrees,
                "turn the environment about +X, degrees, before --rotate: +Y goes to +Z at 90",
                {.min = -36000, .max = 36000}),
            row("--rotate", o.rotate_degrees,
                "turn the environment about +Y, degrees: +Z goes to +X at 90",
                {.min = -36000, .max = 36000}),
            row("--face-resolution", o.face_resolution,
                "texels along a cube face's edge, 0 for the environment's own",
                {.min = 0, .max = 16384})};
}

namespace {

/// Texels of 0.06 degrees light a scene whose sharp lights are 0.2 degrees wide, and a picture of
/// 768 pixels over 35 degrees shows no finer ones behind the scene.
constexpr std::uint32_t FinestResolution = 2048;

} // namespace

cubemap::EnvironmentImage load_environment_image(const std::filesystem::path& path,
                                                 const EnvironmentOptions& options) {
    return as_convention_has_it(cubemap::load_environment(path, load_options(options)),
                                path.string(), options);
}

cubemap::EnvironmentImage environment_image(cubemap::Picture picture,
                                            const EnvironmentOptions& options) {
    const std::string name = "environment";
    return as_convention_has_it(
        cubemap::environment_image(std::move(picture), name, load_options(options)), name, options);
}

glm::dmat3 world_from_image(cubemap::Layout layout, const EnvironmentOptions& options) {
    return options.turn * cubemap::turn_about_y(options.rotate_degrees) *
           cubemap::turn_about_x(options.tilt_degrees) * flipped(options.flip) *
           convention_of(options).world_from(layout);
}

cubemap::CubeMap unturned_cube_map_of(const cubemap::EnvironmentImage& image,
                                      const EnvironmentOptions& options) {
    return cubemap::resample(image, options.face_resolution != 0
                                        ? options.face_resolution
                                        : cubemap::automatic_resolution(image));
}

cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                             const EnvironmentOptions& options) {
    return cubemap::turned(unturned_cube_map_of(image, options),
                           world_from_image(image.layout, options));
}

std::vector<std::string> warnings_about(const cubemap::EnvironmentImage& image,
                                        double light_from_below) {
    std::vector<std::string> result;
    const cubemap::BadPixels& bad = image.bad_pixels;
    if (image.fixed && bad.is_harmless())
        result.push_back(fmt::format("{} negative pixels became 0 ({:.2g} % of the light)",
                                     bad.num_negative, 100.0 * bad.negative_share));
    if (image.fixed && bad.num_infinite > 0)
        result.push_back(fmt::format(
            "{} infinite pixels became {:g}, {}: the light there was brighter", bad.num_infinite,
            image.infinity_became,
            image.infinity_became == files::LargestHalf ? "the most that 16-bit floats hold"
                                                        : "the largest radiance of the others"));
    if (image.num_transparent != 0)
        result.push_back(fmt::format("{} of {} pixels have an alpha of 0: no light comes from them",
                                     image.num_transparent, image.num_file_pixels));
    if (const auto doubt = cubemap::upside_down(light_from_below))
        result.push_back(*doubt);
    return result;
}

relight::Backdrop backdrop_of(std::shared_ptr<const cubemap::EnvironmentImage> image,
                              const EnvironmentOptions& options) {
    const glm::dmat3 turn = world_from_image(image->layout, options);
    return relight::image_backdrop(std::move(image), turn);
}

namespace {

/// Puts a map and what is known of its image together.
Environment told_of(const std::shared_ptr<const cubemap::EnvironmentImage>& image,
                    cubemap::CubeMap map, const glm::dmat3& turn) {
    Environment result{.map = std::move(map),
                       .file = {.image = image, .turn = turn},
                       .assumptions = image->assumptions};
    result.num_fixed_pixels = image->fixed ? image->bad_pixels.count() : 0;
    result.warnings = warnings_about(*image, cubemap::light_from_below(result.map));
    return result;
}

} // namespace

Environment environment_of(const std::shared_ptr<const cubemap::EnvironmentImage>& image,
                           const EnvironmentOptions& options) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    // A map that is not turned is not copied either: it takes hundreds of megabytes.
    const glm::dmat3 turn = world_from_image(image->layout, options);
    Environment result =
        told_of(image, cubemap::turned(unturned_cube_map_of(*image, options), turn), turn);
    result.seconds_resample = files::seconds_since(start);
    return result;
}

Environment environment_of(const std::shared_ptr<const cubemap::EnvironmentImage>& image,
                           const cubemap::CubeMap& resampled, const EnvironmentOptions& options) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const glm::dmat3 turn = world_from_image(image->layout, options);
    Environment result = told_of(image, cubemap::turned(resampled, turn), turn);
    result.seconds_resample = files::seconds_since(start);
    return result;
}

Environment load_environment(const std::filesystem::path& path, const EnvironmentOptions& options) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const std::uint32_t most_width = 4 * std::max(FinestResolution, options.face_resolution);
    const auto image = std::make_shared<const cubemap::EnvironmentImage>(as_convention_has_it(
        cubemap::load_averaged(path, load_options(options), most_width), path.string(), options));
    const double seconds_load = files::seconds_since(start);
    Environment result = environment_of(image, options);
    if (lights::has_sun_file(path)) // what is left may well be darker above
        result.warnings = warnings_about(*image, 0.0);
    result.seconds_load = seconds_load;
    result.path = path;
    return result;
}

} // namespace relumine
