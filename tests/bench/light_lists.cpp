// How well light lists light one scene: every method's error against exact integration, by number
// of lights. See docs/light-lists.md.
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "data_gen/environments.h"
#include "lights/place_lights.h"
#include "prt/visibility/ray_scene.h"
#include "relight/light_fit/transfer_lights.h"
#include "relight/reference/exact.h"
#include "relight/relighter.h"
#include "relumine/in/scene.h"
#include "tests/bench/inputs.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

struct Settings {
    std::vector<std::string> environments = {"grace_cross.hdr", "stpeters_cross.hdr",
                                             "galileo_cross.hdr", "kitchen_cross.hdr", "sun_sky"};
    std::uint32_t resolution = 0;
    std::vector<float> numbers = {16, 64, 256};
    std::size_t num_samples = 2000;
    std::size_t seed = 1;
};

constexpr const char* Transfer = "transfer";

/// A scene, one environment, and the truth about some receivers.
class Comparison {
public:
    Comparison(const Settings& settings, const Scene& scene, const prt::RayScene& rays,
               cubemap::CubeMap map)
        : settings_(settings), scene_(scene), map_(std::move(map)),
          shadow_rays_{.blockers = &rays,
                       .positions = scene.receivers.positions,
                       .bias = scene.settings.bias,
                       .tolerance = rms_tolerance(scene)},
          relighter_(scene.transfer, shadow_rays_),
          sample_(relight::random_receivers(scene.transfer, settings.num_samples, settings.seed)),
          exact_(relight::exact_radiance(scene.receivers, sample_, rays, map_,
                                         {.bias = scene.settings.bias})) {
        relighter_.set_environment(map_);
    }

    void print_row(const std::string& method, std::size_t count) const {
        // One list of random lights says little about the method: another seed's error is half or
        // twice as large.
        const bool is_random = method == lights::name(lights::Method::Importance);
        const std::size_t num_seeds = is_random ? 8 : 1;
        double squares = 0.0, seconds = 0.0;
        for (std::size_t i = 0; i < num_seeds; ++i) {
            bench::Stopwatch watch;
            const std::vector<lights::DistantLight> list =
                method == Transfer ? relight::transfer_lights(relighter_, count)
                                   : lights::place_lights(*lights::method_named(method), map_,
                                                          count, settings_.seed + i);
            seconds += watch.seconds();
            squares += std::pow(relative_l2(list), 2);
        }
        const auto n = static_cast<double>(num_seeds);
        fmt::print("| {} | {} | {:.4f} | {:.1f} ms |\n", method, count, std::sqrt(squares / n),
                   1e3 * seconds / n);
        std::fflush(stdout);
    }

private:
    [[nodiscard]] double relative_l2(std::span<const lights::DistantLight> list) const {
        const std::vector<glm::dvec3> radiance =
            relight::radiance_under(list, scene_.receivers.normals, sample_, shadow_rays_);
        std::vector<glm::vec3> relit(scene_.receivers.size(), glm::vec3(0.0f));
        for (std::size_t i = 0; i < sample_.size(); ++i)
            relit[sample_[i]] = glm::vec3(radiance[i]);
        return relight::compare(sample_, exact_, relit).relative_l2;
    }

    const Settings& settings_;
    const Scene& scene_;
    cubemap::CubeMap map_;
    relight::ShadowRays shadow_rays_;
    relight::Relighter relighter_;
    std::vector<std::uint32_t> sample_;
    std::vector<glm::dvec3> exact_;
};

void run(const Settings& settings, const bench::Inputs& inputs) {
    const Scene scene = inputs.bunny();
    const prt::RayScene rays(scene.blocking_mesh());
    for (const std::string& name : settings.environments) {
        const std::uint32_t resolution = settings.resolution == 0 ? 256 : settings.resolution;
        const Comparison comparison(settings, scene, rays,
                                    name == "sun_sky"
                                        ? data_gen::environments().front().make(resolution)
                                        : inputs.environment(name, settings.resolution));
        fmt::print("\n{}, {} receivers, against exact integration\n\n"
                   "| method | lights | relative L2 | choose |\n|---|---|---|---|\n",
                   name, settings.num_samples);
        for (const float count : settings.numbers) {
            for (const lights::Method method : lights::AllMethods)
                comparison.print_row(std::string(lights::name(method)),
                                     static_cast<std::size_t>(count));
            comparison.print_row(Transfer, static_cast<std::size_t>(count));
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_light_lists",
                           "errors of light lists against exact integration; Markdown on stdout");
    bench::Inputs inputs(program);
    inputs.add_scene();
    program.add("--env", settings.environments, "files of envs/debevec, or sun_sky");
    program.add("--face-resolution", settings.resolution, "R; 0: the files' own");
    program.add("--numbers", settings.numbers, "of lights");
    program.add("--receivers", settings.num_samples, "that are integrated exactly");
    program.add("--seed", settings.seed, "of importance sampling and of the receivers");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny())
            settings = {.environments = {"grace_cross.hdr"},
                        .resolution = 16,
                        .numbers = {4},
                        .num_samples = 20};
        run(settings, inputs);
    });
}
