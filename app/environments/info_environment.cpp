#include "app/environments/info_environment.h"

#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "app/options/environment_options.h"
#include "app/options/output_options.h"
#include "files/joined.h"
#include "relumine/ask/environment_doctor.h"
#include "relumine/in/environment.h"
#include "relumine/in/environment_files.h"
#include "relumine/light/light_lists.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

constexpr std::array<std::string_view, 6> AxisNames = {"+X", "-X", "+Y", "-Y", "+Z", "-Z"};

/// Everything that is found out.
struct Findings {
    cubemap::EnvironmentStatistics statistics;
    cubemap::SunSearch search;
    std::optional<cubemap::ClippedSun> clipped;
    std::vector<cubemap::SeamFault> faults;
    /// The sun was split off the map; what is left may be darker above.
    bool has_sun_file = false;
    /// What a first picture says
    std::vector<std::string> warnings = {};
};

std::string direction_text(const glm::dvec3& w) {
    const cubemap::SkyAngles angles = cubemap::sky_angles(w);
    return fmt::format("{:.4f} {:.4f} {:.4f}, azimuth {:.1f}, elevation {:.1f} degrees", w.x, w.y,
                       w.z, angles.azimuth_degrees, angles.elevation_degrees);
}

Report direction_json(const glm::dvec3& w) {
    const cubemap::SkyAngles angles = cubemap::sky_angles(w);
    return {{"direction", w},
            {"azimuth_degrees", angles.azimuth_degrees},
            {"elevation_degrees", angles.elevation_degrees}};
}

void say_image(const cubemap::EnvironmentImage& image, const Session& session) {
    const cubemap::BadPixels& bad = image.bad_pixels;
    session.say(fmt::format("layout              {} {} x {}", cubemap::name(image.layout),
                            image.width, image.height));
    session.say(fmt::format("assumed             {}", image.assumptions));
    session.say(fmt::format("samples             {}", image.sampling == cubemap::Sampling::Borders
                                                          ? "on the borders"
                                                          : "at texel centres"));
    session.say(
        fmt::format("as a cube map       6 x {0} x {0}", cubemap::natural_resolution(image)));
    session.say(fmt::format("bad pixels          {} NaN, {} infinite, {} negative{}", bad.num_nan,
                            bad.num_infinite, bad.num_negative,
                            bad.count() == 0 ? ""
                            : bad.is_harmless()
                                ? fmt::format(" ({:.2g} % of the light, read as 0); first at ({}, "
                                              "{})",
                                              100.0 * bad.negative_share, bad.first_x, bad.first_y)
                                : fmt::format("; first at ({}, {}); what follows is with "
                                              "--fix-env, light with it too",
                                              bad.first_x, bad.first_y)));
}

void say_light(const Findings& found, const Session& session) {
    const cubemap::EnvironmentStatistics& s = found.statistics;
    session.say(fmt::format("mean radiance       {:.5g} {:.5g} {:.5g}, luminance {:.5g}",
                            s.mean_radiance.r, s.mean_radiance.g, s.mean_radiance.b,
                            s.mean_luminance));
    session.say(fmt::format("luminance range     {:.4g} to {:.4g}, {:.1f} EV",
                            s.min_positive_luminance, s.max_luminance, s.dynamic_range_ev));
    session.say(fmt::format("brightest towards   {}", direction_text(s.brightest_direction)));
    std::vector<std::string> sides;
    for (const std::size_t axis : {2u, 3u, 0u, 1u, 4u, 5u})
        sides.push_back(
            fmt::format("{} {:.4g}", AxisNames[axis], cubemap::luminance(s.axis_irradiance[axis])));
    session.say(fmt::format("irradiance          {} (luminance, on surfaces that face so)",
                            files::joined(sides, ", ")));
    if (!found.search.sun) {
        session.say(fmt::format("sun                 none: {}", found.search.why_none));
        return;
    }
    const cubemap::Sun& sun = *found.search.sun;
    session.say(fmt::format("sun towards         {}", direction_text(sun.direction)));
    session.say(fmt::format(
        "sun                 {:.2f} degrees wide (a pixel {:.2f}), irradiance {:.4g} {:.4g} "
        "{:.4g}, {:.3g} % of all light",
        cubemap::disc_diameter_degrees(sun.solid_angle), found.search.pixel_diameter_degrees,
        sun.irradiance.r, sun.irradiance.g, sun.irradiance.b, 100.0 * sun.share_of_power));
}

std::optional<std::string> upside_down(const Findings& found) {
    return found.has_sun_file ? std::nullopt
                              : cubemap::upside_down(found.statistics.light_from_below);
}

void say_doubts(const Findings& found, const Session& session) {
    for (const std::string& warning : found.warnings)
        session.say(fmt::format("suspect             {}", warning));
    if (found.clipped)
        session.say(
            fmt::format("suspect             a clipped or veiled sun is likely towards {}: {}",
                        direction_text(found.clipped->direction), found.clipped->why));
    for (const cubemap::SeamFault& fault : found.faults)
        session.say(
            fmt::format("suspect             {} out of line: {:.2g} EV, beside it {:.2g} EV",
                        fault.where, fault.step_ev, fault.usual_step_ev));
    if (found.faults.empty())
        session.say("seams and poles     in line");
}

Report report(const cubemap::EnvironmentImage& image, const Findings& found) {
    const cubemap::EnvironmentStatistics& s = found.statistics;
    Report irradiance;
    for (std::size_t axis = 0; axis < AxisNames.size(); ++axis)
        irradiance.set(std::string(AxisNames[axis]), s.axis_irradiance[axis]);
    std::vector<Report> faults;
    for (const cubemap::SeamFault& fault : found.faults)
        faults.push_back({{"where", fault.where},
                          {"step_ev", fault.step_ev},
                          {"usual_step_ev", fault.usual_step_ev}});
    Report result = {{"kind", "environment"},
                     {"layout", cubemap::name(image.layout)},
                     {"assumptions", image.assumptions},
                     {"samples_on_borders", image.sampling == cubemap::Sampling::Borders},
                     {"width", image.width},
                     {"height", image.height},
                     {"face_resolution", cubemap::natural_resolution(image)},
                     {"mean_radiance", s.mean_radiance},
                     {"mean_luminance", s.mean_luminance},
                     {"max_luminance", s.max_luminance},
                     {"min_positive_luminance", s.min_positive_luminance},
                     {"dynamic_range_ev", s.dynamic_range_ev},
                     {"brightest_direction", s.brightest_direction},
                     {"irradiance", irradiance},
                     {"light_from_below", s.light_from_below},
                     {"upside_down", upside_down(found).has_value()},
                     {"warnings", found.warnings},
                     {"pixel_diameter_degrees", found.search.pixel_diameter_degrees},
                     {"num_nan", image.bad_pixels.num_nan},
                     {"num_infinite", image.bad_pixels.num_infinite},
                     {"num_negative", image.bad_pixels.num_negative},
                     {"negative_share", image.bad_pixels.negative_share},
                     {"sun", nullptr},
                     {"clipped_sun", nullptr},
                     {"seam_faults", faults}};
    if (found.search.sun) {
        const cubemap::Sun& sun = *found.search.sun;
        Report described = direction_json(sun.direction);
        files::update(described,
                      {{"irradiance", sun.irradiance},
                       {"solid_angle", sun.solid_angle},
                       {"diameter_degrees", cubemap::disc_diameter_degrees(sun.solid_angle)},
                       {"share_of_power", sun.share_of_power},
                       {"peak_luminance", sun.peak_luminance},
                       {"sky_luminance", sun.sky_luminance}});
        result.set("sun", described);
    } else {
        result.set("why_no_sun", found.search.why_none);
    }
    if (found.clipped) {
        Report described = direction_json(found.clipped->direction);
        described.set("why", found.clipped->why);
        result.set("clipped_sun", described);
    }
    return result;
}

} // namespace

void describe_environment(const EnvironmentInfoOptions& options, const Session& session) {
    if (!options.picture.empty()) {
        require_extension("--picture", options.picture, {".png"});
        check_output(options.picture, {options.path});
    }
    const cubemap::EnvironmentImage image =
        cubemap::load_environment(options.path, {.layout = options.layout, .fix_bad_pixels = true});
    session.poll();
    Findings found{.statistics = cubemap::statistics(image),
                   .search = cubemap::find_sun(image),
                   .clipped = {},
                   .faults = cubemap::seam_faults(image),
                   .has_sun_file = lights::has_sun_file(options.path)};
    found.warnings =
        warnings_about(image, found.has_sun_file ? 0.0 : found.statistics.light_from_below);
    found.clipped = cubemap::clipped_sun(image, found.search, found.statistics);
    session.poll();
    if (!options.picture.empty()) {
        relight::SunMark mark;
        if (found.clipped)
            mark = {.direction = found.clipped->direction, .label = "sun?"};
        if (found.search.sun)
            mark = {.direction = found.search.sun->direction,
                    .label = found.clipped ? "sun?" : "sun"};
        relight::save_environment_picture(options.picture, image, mark);
    }
    say_image(image, session);
    say_light(found, session);
    say_doubts(found, session);
    session.report(report(image, found));
}

} // namespace relumine::app
