// `relumine lights --compare`: the error of every method on one scene.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "app/options/environment_options.h"
#include "app/options/lit_scene.h"
#include "app/session.h"
#include "lights/light_list.h"
#include "relight/relighter.h"

namespace relumine::app {

/// The name of relight::transfer_lights() beside those of lights::AllMethods.
inline constexpr const char* TransferMethod = "transfer";

struct ComparisonOptions {
    /// .prt
    std::string scene;
    /// The numbers of lights to compare.
    std::vector<std::size_t> numbers = {};
    /// The first seed of importance sampling, and the seed that chooses receivers.
    std::uint64_t seed = 1;
    /// How many receivers are compared. 0: all.
    std::size_t num_samples = 2000;
    /// An .svg plot of the errors. Empty: none.
    std::string plot = {};
};

/// Lights chosen for a scene by transfer_lights(); what went wrong names the environment.
[[nodiscard]] std::vector<lights::DistantLight>
lights_for_scene(const relight::Relighter& relighter, std::size_t count, Session& session);

/// Lights the scene's receivers with the lists of all methods and all numbers of lights, a shadow
/// ray for each light; says a Markdown table of relative L2 errors against exact integration and
/// times, reports the same, and draws it. For the random method the error is the root mean square
/// over lists of eight seeds, `seed` and those that follow it.
void compare_methods(const ComparisonOptions& options, const EnvironmentOptions& environment,
                     Session& session);

} // namespace relumine::app
