#include "app/environments/light_comparison.h"

#include <cmath>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "app/options/output_options.h"
#include "app/options/receiver_options.h"
#include "files/output_file.h"
#include "lights/place_lights.h"
#include "relight/light_fit/transfer_lights.h"
#include "relight/pictures/plot.h"
#include "relight/reference/exact.h"
#include "relight/sharp/shadow_rays.h"

namespace relumine::app {

namespace {

// One list of random lights says little about the method: another seed's error is half or twice as
// large.
constexpr std::size_t SeedsOfRandomMethods = 8;

/// One method at one number of lights.
struct Row {
    std::string method;
    /// Asked for
    std::size_t num_lights = 0;
    /// Lists that were measured
    std::size_t num_seeds = 1;
    /// transfer_lights() may need fewer
    std::size_t num_found = 0;
    /// Root mean square over the seeds
    double relative_l2 = 0.0;
    /// Mean over the seeds
    double seconds_choose = 0.0;
    /// Of the samples
    double seconds_light = 0.0;
};

/// The scene, its environment and the truth about some receivers.
class Comparison {
public:
    Comparison(const ComparisonOptions& options, const EnvironmentOptions& environment,
               Session& session)
        : options_(options), session_(session), lit_(lit_scene({.path = options.scene})),
          map_(cube_map_of(load_image(environment, session), environment)),
          receivers_(lit_.scene().receivers),
          sample_(
              relight::random_receivers(lit_.scene().transfer, options.num_samples, options.seed)) {
        require_diffuse(lit_.scene(), options.scene);
        lit_.light(map_);
        exact_ = relight::exact_radiance(receivers_, sample_, lit_.blockers(), map_,
                                         {.bias = lit_.scene().settings.bias,
                                          .stop = session.stop(),
                                          .on_progress = session.progress("exact integration")});
        session.end_progress();
    }

    [[nodiscard]] Row row(const std::string& method, std::size_t count) {
        const bool is_random = method == lights::name(lights::Method::Importance);
        Row row{.method = method,
                .num_lights = count,
                .num_seeds = is_random ? SeedsOfRandomMethods : 1};
        double squares = 0.0;
        for (std::size_t i = 0; i < row.num_seeds; ++i) {
            session_.poll();
            Stopwatch watch;
            const std::vector<lights::DistantLight> list =
                method == TransferMethod ? lights_for_scene(lit_.relighter(), count, session_)
                                         : lights::place_lights(*lights::method_named(method), map_,
                                                                count, options_.seed + i);
            row.seconds_choose += watch.lap() / static_cast<double>(row.num_seeds);
            row.num_found = list.size();
            const double error = relative_l2(list);
            row.seconds_light += watch.lap() / static_cast<double>(row.num_seeds);
            squares += error * error;
        }
        row.relative_l2 = std::sqrt(squares / static_cast<double>(row.num_seeds));
        return row;
    }

    [[nodiscard]] std::size_t num_samples() const { return sample_.size(); }
    [[nodiscard]] std::uint32_t resolution() const { return map_.resolution; }

private:
    [[nodiscard]] double relative_l2(std::span<const lights::DistantLight> list) const {
        const std::vector<glm::dvec3> radiance =
            relight::radiance_under(list, receivers_.normals, sample_, lit_.shadow_rays());
        std::vector<glm::vec3> relit(receivers_.size(), glm::vec3(0.0f));
        for (std::size_t i = 0; i < sample_.size(); ++i)
            relit[sample_[i]] = glm::vec3(radiance[i]);
        return relight::compare(sample_, exact_, relit).relative_l2;
    }

    const ComparisonOptions& options_;
    Session& session_;
    LitScene lit_;
    cubemap::CubeMap map_;
    const prt::Receivers& receivers_;
    std::vector<std::uint32_t> sample_;
    std::vector<glm::dvec3> exact_;
};

std::vector<std::string> all_methods() {
    std::vector<std::string> methods;
    methods.reserve(lights::AllMethods.size() + 1);
    for (const lights::Method method : lights::AllMethods)
        methods.emplace_back(lights::name(method));
    methods.emplace_back(TransferMethod);
    return methods;
}

void draw(const ComparisonOptions& options, const std::string& environment,
          const std::vector<Row>& rows) {
    relight::Plot plot{.title = fmt::format("Light lists of {}", environment),
                       .x_label = "lights",
                       .y_label = "relative L2 error",
                       .x_scale = relight::Scale::Log,
                       .y_scale = relight::Scale::Log};
    for (const std::string& method : all_methods()) {
        relight::Plot::Series series{.name = method, .x = {}, .y = {}};
        for (const Row& row : rows)
            if (row.method == method) {
                series.x.push_back(static_cast<double>(row.num_lights));
                series.y.push_back(row.relative_l2);
            }
        plot.series.push_back(series);
    }
    files::save_text(options.plot, relight::svg(plot));
}

} // namespace

std::vector<lights::DistantLight> lights_for_scene(const relight::Relighter& relighter,
                                                   std::size_t count, Session& session) {
    std::vector<lights::DistantLight> list = relight::transfer_lights(
        relighter, count,
        {.stop = session.stop(), .on_progress = session.progress(fmt::format("{} lights", count))});
    session.end_progress();
    return list;
}

void compare_methods(const ComparisonOptions& options, const EnvironmentOptions& environment,
                     Session& session) {
    Comparison comparison(options, environment, session);
    const std::string name = std::filesystem::path(environment.path).filename().string();
    session.say(fmt::format("{} on {}, {} receivers, R = {}, against exact integration\n", name,
                            options.scene, comparison.num_samples(), comparison.resolution()));
    session.say(
        "| method | lights | relative L2 | choose | light the receivers |\n|---|---|---|---|---|");
    std::vector<Row> rows;
    std::vector<Report> report;
    for (const std::string& method : all_methods())
        for (const std::size_t count : options.numbers) {
            try {
                rows.push_back(comparison.row(method, count));
            } catch (const std::invalid_argument& error) {
                throw std::runtime_error(fmt::format("{}: {}", environment.path, error.what()));
            }
            const Row& row = rows.back();
            session.say(fmt::format("| {} | {} | {:.4f} | {:.1f} ms | {:.1f} ms |", row.method,
                                    row.num_lights, row.relative_l2, 1e3 * row.seconds_choose,
                                    1e3 * row.seconds_light));
            report.push_back({{"method", row.method},
                              {"lights", row.num_lights},
                              {"seeds", row.num_seeds},
                              {"lights_found", row.num_found},
                              {"relative_l2", row.relative_l2},
                              {"seconds_choose", row.seconds_choose},
                              {"seconds_light", row.seconds_light}});
        }
    if (!options.plot.empty())
        draw(options, name, rows);
    session.report({{"samples", comparison.num_samples()},
                    {"face_resolution", comparison.resolution()},
                    {"rows", report}});
}

} // namespace relumine::app
