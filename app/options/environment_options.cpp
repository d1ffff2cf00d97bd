#include "app/options/environment_options.h"

#include <vector>

#include <fmt/format.h>

#include "relumine/light/light_lists.h"

namespace relumine::app {

namespace {

void tell(const EnvironmentOptions& options, const std::string& assumptions,
          std::size_t num_fixed_pixels, const Session& session) {
    session.detail(fmt::format("{}: {}", options.path, assumptions));
    if (num_fixed_pixels != 0)
        session.add_to_report("replaced_pixels", num_fixed_pixels);
    if (options.fix_bad_pixels && num_fixed_pixels != 0)
        session.say(fmt::format("{}: replaced {} bad pixels", options.path, num_fixed_pixels));
    session.poll();
}

} // namespace

Option EnvironmentOptions::add_to(Command& command) {
    const Option environment =
        command.add(row("ENV", path,
                        "environment: " + cubemap::environment_extensions() +
                            "; {face} in the name for six files px nx py ny pz nz",
                        {.file = true, .required = true}));
    command.add_all(options_of(*this));
    return environment;
}

cubemap::EnvironmentImage load_image(const EnvironmentOptions& options, const Session& session) {
    cubemap::EnvironmentImage image = load_environment_image(options.path, options);
    tell(options, image.assumptions, image.fixed ? image.bad_pixels.count() : 0, session);
    return image;
}

bool warn_about(const EnvironmentOptions& options, const cubemap::EnvironmentImage& image,
                double light_from_below, Session& session) {
    const std::vector<std::string> warnings =
        warnings_about(image, lights::has_sun_file(options.path) ? 0.0 : light_from_below);
    for (const std::string& warning : warnings)
        session.warn(fmt::format("{}: {}", options.path, warning));
    return !warnings.empty();
}

Environment load_environment(const EnvironmentOptions& options, Session& session) {
    Environment environment = relumine::load_environment(options.path, options);
    tell(options, environment.assumptions, environment.num_fixed_pixels, session);
    for (const std::string& warning : environment.warnings)
        session.warn(fmt::format("{}: {}", options.path, warning));
    return environment;
}

} // namespace relumine::app
