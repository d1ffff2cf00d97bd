// Highlights for an eye that moves: what a look costs and how far it is from exact integration,
// beside the plain sum over all visible clusters and a prefiltered environment without visibility.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/glossy/brdf.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/block_size.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/moving_eye/moving_eye.h"
#include "relight/reference/exact.h"
#include "relight/reference/flicker.h"
#include "relumine/relumine.h"
#include "tests/bench/inputs.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

struct Settings {
    std::string mesh = "bun_zipper.ply";
    std::uint32_t floor = 193;
    /// A scene in place of a precompute.
    std::string scene;
    std::vector<float> roughness = {0.3f, 0.15f};
    float tolerance = relight::EyeOptions{}.tolerance;
    float transfer_tolerance = prt::PrecomputeOptions{}.tolerance;
    std::uint32_t resolution = 128;
    std::size_t num_eyes = 20;
    /// Of each eye.
    std::size_t num_samples = 200;
    /// Of a turntable, whose flicker is measured; 0: of none.
    std::size_t num_frames = 0;
    /// Steps of a light that is dragged while the eye stands still; 0: none.
    std::size_t num_drags = 0;
    double disc_degrees = 10.0;
    /// Whether other ways are measured, too.
    int beside = 1;
    /// Whether only what pictures show is lit: 1 or 0.
    int seen = 0;
};

/// Eyes all around and above, as far as the automatic camera.
std::vector<glm::vec3> random_eyes(const Scene& scene, std::size_t count) {
    const Camera camera = camera_of(scene);
    const float distance = glm::distance(camera.eye, camera.target);
    std::mt19937 random(7);
    std::uniform_real_distribution<float> part(0.0f, 1.0f);
    std::vector<glm::vec3> eyes(count);
    for (glm::vec3& eye : eyes) {
        const float phi = 2.0f * std::numbers::pi_v<float> * part(random);
        const float y = 0.05f + 0.75f * part(random), r = std::sqrt(1.0f - y * y);
        eye = camera.target + distance * glm::vec3(r * std::cos(phi), y, r * std::sin(phi));
    }
    return eyes;
}

/// Receivers that face each eye, and that it sees where there are rays to say so.
struct Samples {
    Samples(const Scene& scene, std::span<const prt::Surface> surfaces,
            std::span<const glm::vec3> eyes, std::size_t per_eye, const prt::RayScene* rays) {
        std::mt19937 random(11);
        const prt::Receivers& all = scene.receivers;
        std::uniform_int_distribution<std::uint32_t> any(
            0, static_cast<std::uint32_t>(all.size() - 1));
        for (const glm::vec3& eye : eyes)
            for (std::size_t found = 0; found < per_eye;) {
                const std::uint32_t i = any(random);
                const glm::vec3 to_eye = glm::normalize(eye - all.positions[i]);
                if (glm::dot(to_eye, all.normals[i]) < 0.05f ||
                    surfaces[i].highlight == prt::Highlight::None ||
                    (rays != nullptr &&
                     rays->occluded(all.positions[i] + scene.settings.bias * all.normals[i],
                                    eye - all.positions[i], 1.0f)))
                    continue;
                ++found;
                index.push_back(i);
                receivers.positions.push_back(all.positions[i]);
                receivers.normals.push_back(all.normals[i]);
                receivers.surfaces.push_back(surfaces[i]);
                receivers.to_eye.push_back(to_eye);
            }
    }
    prt::Receivers receivers;
    std::vector<std::uint32_t> index;
};

struct Error {
    double difference = 0.0, all = 0.0;
    void add(const glm::dvec3& value, const glm::dvec3& exact) {
        difference += glm::dot(value - exact, value - exact);
        all += glm::dot(exact, exact);
    }
    [[nodiscard]] double relative_l2() const { return std::sqrt(difference / all); }
};

/// The plain sum over all clusters of the light, the visible part and the lobes.
struct PlainSum {
    std::vector<glm::dvec3> radiance;
    double seconds = 0.0;
};

PlainSum plain_sum(const Samples& samples, const relight::Relighter& relighter) {
    const prt::Transfer& transfer = relighter.transfer();
    std::vector<std::uint32_t> place_of(transfer.order.size());
    for (std::uint32_t place = 0; place < place_of.size(); ++place)
        place_of[transfer.order[place]] = place;
    std::vector<std::pair<glm::vec3, glm::vec3>> lights; // direction, irradiance
    for (const prt::Cell& cell : transfer.quadtree.leaves()) {
        const relight::VectorIrradiance sum =
            relighter.binning()->sum(relighter.environment(), cell);
        const glm::dvec3 luminance = sum.luminance();
        const double length = glm::length(luminance);
        lights.emplace_back(
            length > 0.0 ? luminance / length : glm::dvec3(0.0, 1.0, 0.0),
            glm::dvec3(glm::length(sum.red), glm::length(sum.green), glm::length(sum.blue)));
    }
    const prt::Receivers& receivers = samples.receivers;
    PlainSum result;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < receivers.size(); ++i) {
        const prt::Surface& surface = receivers.surfaces[i];
        const glm::vec3 &normal = receivers.normals[i], &to_eye = receivers.to_eye[i];
        prt::Lobes<glm::vec3> sums;
        for (std::uint32_t cluster = 0; cluster < lights.size(); ++cluster) {
            const int count = transfer.counts.count(place_of[samples.index[i]], cluster);
            if (count == 0)
                continue;
            const auto& [direction, irradiance] = lights[cluster];
            prt::add_scaled(
                sums,
                prt::converted<glm::vec3>(prt::evaluate_lobes(surface, normal, to_eye, direction)),
                static_cast<float>(count) / 16.0f * irradiance);
        }
        result.radiance.emplace_back(prt::reflect(surface, sums, {surface, normal, to_eye}));
    }
    result.seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return result;
}

/// Nothing is in the way.
class OpenSky final : public prt::Blockers {
public:
    [[nodiscard]] std::uint32_t occluded(const glm::vec3&, const prt::DirectionPacket&,
                                         std::uint32_t) const override {
        return 0;
    }
};

/// What a prefiltered environment gives at best: highlights without visibility, here integrated
/// exactly, over exact diffuse light.
std::vector<glm::dvec3> prefiltered(const LitScene& lit, const Samples& samples,
                                    std::span<const std::uint32_t> order,
                                    std::span<const glm::dvec3> exact,
                                    const cubemap::CubeMap& map) {
    prt::Receivers mirrors = samples.receivers;
    for (prt::Surface& surface : mirrors.surfaces)
        surface.albedo = glm::vec3(0.0f);
    const relight::ExactOptions options{.bias = lit.scene().settings.bias};
    const auto seen = relight::exact_radiance(mirrors, order, lit.rays().blockers(), map, options);
    std::vector<glm::dvec3> all = relight::exact_radiance(mirrors, order, OpenSky(), map, options);
    for (std::size_t i = 0; i < all.size(); ++i)
        all[i] += exact[i] - seen[i];
    return all;
}

/// A turntable: how far frames change, against exact integration of some receivers.
void print_turntable(const Settings& settings, const LitScene& lit, relight::MovingEye& live,
                     std::span<const prt::Surface> surfaces, const bench::NamedMap& map) {
    const Scene& scene = lit.scene();
    const Camera camera = camera_of(scene);
    prt::Receivers all = scene.receivers;
    all.surfaces.assign(surfaces.begin(), surfaces.end());
    std::vector<std::uint32_t> chosen;
    for (std::size_t i = 0; i < settings.num_samples; ++i)
        chosen.push_back(static_cast<std::uint32_t>(i * all.size() / settings.num_samples));
    // A picture that stands still has no change of its own.
    const std::vector<glm::dvec3> still(chosen.size(), glm::dvec3(0.0));
    relight::FlickerMeter of_looks, of_exact, between;
    for (std::size_t frame = 0; frame < settings.num_frames; ++frame) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(frame) /
                            static_cast<double>(settings.num_frames);
        const glm::dvec3 arm(camera.eye - camera.target);
        const glm::vec3 eye =
            camera.target + glm::vec3(std::cos(turn) * arm.x + std::sin(turn) * arm.z, arm.y,
                                      std::cos(turn) * arm.z - std::sin(turn) * arm.x);
        prt::look_from(all, eye);
        const std::vector<glm::dvec3> exact = relight::exact_radiance(
            all, chosen, lit.rays().blockers(), map.map, {.bias = scene.settings.bias});
        const auto radiance = live.look(eye, lit.radiance(), {.tolerance = settings.tolerance});
        std::vector<glm::dvec3> seen;
        for (const std::uint32_t receiver : chosen)
            seen.emplace_back(radiance[receiver]);
        of_looks.add_frame(seen, still);
        of_exact.add_frame(exact, still);
        between.add_frame(seen, exact);
    }
    const double change = of_exact.report().mean_inconsistency;
    fmt::print("| {} | turntable of {} frames: change {:.5f}, exact {:.5f}, ratio {:.3f}; "
               "inconsistency {:.5f}\n",
               map.name, settings.num_frames, of_looks.report().mean_inconsistency, change,
               of_looks.report().mean_inconsistency / change, between.report().mean_inconsistency);
}

/// A disc of light that is dragged across the sky while the eye stands still: what an update costs,
/// and how far it is from a look of an eye that comes new.
void print_drag(const Settings& settings, LitScene& lit, relight::MovingEye& live,
                const bench::NamedMap& map) {
    const glm::vec3 eye = camera_of(lit.scene()).eye;
    const relight::EyeOptions options{.tolerance = settings.tolerance,
                                      .seen_only = settings.seen != 0};
    std::vector<double> of_edit, of_light, of_look, of_all, processor;
    std::size_t num_updated = 0, num_blocks = 0;
    constexpr std::size_t NumFirst = 3;
    for (std::size_t step = 0; step < settings.num_drags + NumFirst; ++step) {
        const double phi = 0.03 * static_cast<double>(step);
        const cubemap::Disc disc{
            .direction = {0.8 * std::cos(phi), 0.6, 0.8 * std::sin(phi)},
            .radius_degrees = settings.disc_degrees,
        };
        const double cpu = bench::cpu_seconds();
        const auto start = std::chrono::steady_clock::now();
        set_layers(lit, {{.name = "light",
                          .region = disc,
                          .effect = cubemap::Emit{.radiance = glm::vec3(5.0f)}}});
        const auto edited = std::chrono::steady_clock::now();
        live.set_light(lit.relighter());
        const auto lit_at = std::chrono::steady_clock::now();
        static_cast<void>(live.look(eye, lit.radiance(), options));
        const auto end = std::chrono::steady_clock::now();
        if (step < NumFirst)
            continue;
        const auto ms = [](auto from, auto to) {
            return std::chrono::duration<double, std::milli>(to - from).count();
        };
        of_edit.push_back(ms(start, edited));
        of_light.push_back(ms(edited, lit_at));
        of_look.push_back(ms(lit_at, end));
        of_all.push_back(ms(start, end));
        processor.push_back(1e3 * (bench::cpu_seconds() - cpu));
        num_updated += live.report().num_updated;
        num_blocks += live.report().num_blocks;
    }
    const auto last = live.look(eye, lit.radiance(), options);
    const std::vector<glm::vec3> kept(last.begin(), last.end());
    static_cast<void>(live.look(-eye, lit.radiance(), options));
    const auto fresh = live.look(eye, lit.radiance(), options);
    const double fresh_ms = 1e3 * live.report().seconds;
    double difference = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        difference = std::max(difference, double{glm::distance(kept[i], fresh[i])});
        largest = std::max(largest, double{glm::length(fresh[i])});
    }
    fmt::print("| {} | drag of {} degrees, {} steps: {:.1f} ms = edit {:.1f} + light {:.1f} + look "
               "{:.1f}, of a new eye {:.1f}; {:.1f} cpu ms; medians; {:.3f} of the blocks updated, "
               "difference "
               "{:.1e} of the largest\n",
               map.name, settings.disc_degrees, settings.num_drags, bench::median(of_all),
               bench::median(of_edit), bench::median(of_light), bench::median(of_look), fresh_ms,
               bench::median(processor),
               static_cast<double>(num_updated) / static_cast<double>(num_blocks),
               difference / largest);
    set_layers(lit, {});
}

void print_rows(float roughness, const Settings& settings, LitScene& lit,
                const std::vector<bench::NamedMap>& maps) {
    const Scene& scene = lit.scene();
    std::vector<prt::Surface> surfaces(scene.receivers.size(),
                                       {.albedo = glm::vec3(0.3f),
                                        .specular = glm::vec3(0.5f),
                                        .highlight = prt::Highlight::GgxWhole,
                                        .roughness_or_exponent = roughness});
    const std::vector<bool> is_floor = floor_receivers(scene);
    for (std::size_t i = 0; i < is_floor.size(); ++i)
        if (is_floor[i])
            surfaces[i] = {};
    double seconds_made = 0.0;
    const auto start = std::chrono::steady_clock::now();
    relight::MovingEye live(scene.transfer, scene.receivers.positions, surfaces,
                            scene.mesh.triangles);
    seconds_made = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    const prt::VisibleCounts& counts = scene.transfer.counts;
    fmt::print("roughness {}: {} receivers, {} clusters; pyramid {:.1f} MB in {:.2f} s, counts "
               "{:.1f} MB\n",
               roughness, scene.receivers.size(), scene.transfer.num_clusters(),
               1e-6 * static_cast<double>(live.num_bytes()), seconds_made,
               1e-6 * static_cast<double>(counts.counts.size() + 24 * counts.mixed.size()));
    const std::vector<glm::vec3> eyes = random_eyes(scene, settings.num_eyes);
    const Samples samples(scene, surfaces, eyes, settings.num_samples,
                          settings.seen != 0 ? &lit.rays().of_mesh() : nullptr);
    std::vector<std::uint32_t> order(samples.index.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
        order[i] = i;
    for (const bench::NamedMap& map : maps) {
        lit.light(map.map);
        const auto before_set = std::chrono::steady_clock::now();
        live.set_light(lit.relighter());
        const double set_seconds =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - before_set).count();
        Error error, matt, plain, open;
        std::vector<glm::dvec3> exact, filtered;
        PlainSum sum;
        if (settings.num_samples != 0) {
            exact = relight::exact_radiance(samples.receivers, order, lit.rays().blockers(),
                                            map.map, {.bias = scene.settings.bias});
        }
        if (settings.num_samples != 0 && settings.beside != 0) {
            sum = plain_sum(samples, lit.relighter());
            filtered = prefiltered(lit, samples, order, exact, map.map);
        }
        for (std::size_t i = 0; i < filtered.size(); ++i) {
            plain.add(sum.radiance[i], exact[i]);
            open.add(filtered[i], exact[i]);
        }
        double seconds = 0.0, processor = 0.0, cells = 0.0, blocks = 0.0;
        std::size_t num_left_out = 0;
        for (std::size_t eye = 0; eye < eyes.size(); ++eye) {
            const double cpu = bench::cpu_seconds();
            const auto radiance =
                live.look(eyes[eye], lit.radiance(),
                          {.tolerance = settings.tolerance, .seen_only = settings.seen != 0});
            processor += bench::cpu_seconds() - cpu;
            seconds += live.report().seconds;
            cells += static_cast<double>(live.report().num_cells);
            blocks += static_cast<double>(live.report().num_blocks);
            for (std::size_t i = eye * settings.num_samples; i < (eye + 1) * settings.num_samples;
                 ++i) {
                error.add(glm::dvec3(radiance[samples.index[i]]), exact[i]);
                matt.add(glm::dvec3(lit.radiance()[samples.index[i]]), exact[i]);
            }
            if (settings.seen == 0 || exact.empty())
                continue;
            // What a picture leaves out although the eye sees it.
            const std::vector<glm::vec3> kept(radiance.begin(), radiance.end());
            const auto all =
                live.look(eyes[eye], lit.radiance(), {.tolerance = settings.tolerance});
            for (std::size_t i = eye * settings.num_samples; i < (eye + 1) * settings.num_samples;
                 ++i)
                num_left_out += kept[samples.index[i]] != all[samples.index[i]] ? 1 : 0;
        }
        const auto num_eyes = static_cast<double>(eyes.size());
        // The sum's time for all receivers that a look lights
        const double plain_ms = 1e3 * sum.seconds / static_cast<double>(samples.index.size()) *
                                blocks / num_eyes * prt::BlockSize;
        fmt::print("| {} | {:.0f} blocks, {:.0f} cells | {:.1f} cpu ms, {:.1f} ms | {} sharp, set "
                   "{:.1f} ms",
                   map.name, blocks / num_eyes, cells / blocks, 1e3 * processor / num_eyes,
                   1e3 * seconds / num_eyes, live.num_traced(), 1e3 * set_seconds);
        if (!exact.empty())
            fmt::print(" | {:.4f} | matt {:.3f}", error.relative_l2(), matt.relative_l2());
        if (num_left_out != 0)
            fmt::print(" | {} of {} seen receivers left out", num_left_out, exact.size());
        if (!filtered.empty())
            fmt::print(" | plain sum {:.4f}, {:.0f} cpu ms | no visibility {:.3f}",
                       plain.relative_l2(), plain_ms, open.relative_l2());
        fmt::print("\n");
        if (settings.num_frames != 0 && settings.num_samples != 0)
            print_turntable(settings, lit, live, surfaces, map);
        if (settings.num_drags != 0)
            print_drag(settings, lit, live, map);
        std::fflush(stdout);
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_moving_eye", "highlights for an eye that moves: cost and error");
    bench::Inputs inputs(program);
    program.add("--mesh", settings.mesh, "file of meshes/stanford");
    program.add("--floor", settings.floor, "N x N vertices, 0 for none");
    program.add("--scene", settings.scene, "a .prt without materials, in place of --mesh");
    program.add("--roughness", settings.roughness, "glTF's");
    program.add("--tolerance", settings.transfer_tolerance, "of the clusters");
    program.add("--glossy-tolerance", settings.tolerance, "of the highlights");
    program.add("--resolution", settings.resolution, "R of the environments");
    program.add("--eyes", settings.num_eyes, "eyes around the mesh");
    program.add("--turntable", settings.num_frames, "frames of a turntable, 0 for none");
    program.add("--drags", settings.num_drags, "steps of a light that is dragged, 0 for none");
    program.add("--disc", settings.disc_degrees, "radius of that light, degrees");
    program.add("--beside", settings.beside, "the plain sum and no visibility, too: 1 or 0");
    program.add("--seen", settings.seen, "only what pictures show: 1 or 0");
    program.add("--samples", settings.num_samples,
                "receivers of each eye; 0: only times are measured");
    return program.run(argc, argv, [&] {
        if (inputs.is_tiny()) {
            settings.roughness = {0.3f};
            settings.transfer_tolerance = 0.1f;
            settings.resolution = 32;
            settings.num_eyes = 3;
            settings.num_drags = 2;
        }
        LitScene lit(settings.scene.empty() ? precompute(inputs.mesh(settings.mesh, settings.floor),
                                                         {.tolerance = settings.transfer_tolerance})
                                            : load_scene(settings.scene));
        const std::vector<bench::NamedMap> maps = inputs.probes_and_sky(settings.resolution);
        for (const float roughness : settings.roughness)
            print_rows(roughness, settings, lit, maps);
    });
}
