// What a planned precompute takes on machines that are not here: a cost model whose inputs are
// measured, and a simulation of its tasks on hosts that are slow at times and fail at times. See
// `./dev bench scale --help`.
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data_gen/scenes.h"
#include "prt/parts/part_file.h"
#include "prt/parts/parts.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/program.h"

namespace fs = std::filesystem;
using namespace relumine;

namespace {

/// Of one receiver or one (receiver, cluster) pair, on one core of this machine.
struct Costs {
    double clusters = 0.0;
    /// Seconds of a part per pair; of the plan, per sampled pair
    double seconds_per_pair = 0.0;
    double plan_seconds_per_pair = 0.0;
    /// Seconds to read and check a plan, per receiver
    double load_seconds = 0.0;
    /// Seconds to join and write, per pair
    double join_seconds = 0.0;
    /// Bytes of a plan's file per receiver; of the light in memory and in the file per pair
    double plan_bytes = 0.0;
    double light_bytes = 0.0;
    double file_bytes = 0.0;
};

Costs measured(std::size_t num_vertices, float tolerance, const fs::path& folder) {
    prt::Plan made{.has_clusters = true};
    prt::Scene& scene = made.scene;
    scene.mesh = data_gen::knot(num_vertices);
    scene.receivers = prt::vertex_receivers(scene.mesh);
    const prt::PrecomputeOptions options{.tolerance = tolerance,
                                         .bias = prt::automatic_bias(scene.mesh)};
    scene.settings = {.tolerance = tolerance,
                      .min_level = options.min_level,
                      .face_resolution = options.face_resolution,
                      .bias = options.bias};
    const prt::RayScene rays(scene.mesh);
    const prt::BeamScene beams(scene.mesh, rays);
    const auto receivers = static_cast<double>(scene.receivers.size());
    Costs costs;
    double before = bench::cpu_seconds();
    const auto lap = [&before] {
        const double start = before;
        before = bench::cpu_seconds();
        return before - start;
    };
    prt::PrecomputeStatistics of_plan;
    scene.transfer = prt::plan_clusters(scene.receivers, beams, options, {}, &of_plan);
    const double plan_seconds = lap();
    costs.clusters = static_cast<double>(scene.transfer.num_clusters());
    const double pairs = receivers * costs.clusters;
    const double sampled = static_cast<double>(of_plan.num_samples) /
                           static_cast<double>(of_plan.num_directions) * costs.clusters;
    costs.plan_seconds_per_pair = plan_seconds / sampled;

    const fs::path plan_file = folder / "scale.plan";
    costs.plan_bytes = static_cast<double>(prt::save_plan(plan_file, made)) / receivers;
    lap();
    prt::Plan plan = prt::load_plan(plan_file);
    costs.load_seconds = lap() / receivers;
    std::vector<prt::PartLight> light = {
        {prt::part_counts(plan.scene.receivers, plan.scene.transfer, beams, options, {})}};
    costs.seconds_per_pair = lap() / pairs;
    const prt::VisibleCounts& counts = light[0].counts;
    costs.light_bytes =
        static_cast<double>(8 * 3 * counts.visible.size() + counts.counts.size()) / pairs;
    const std::vector<fs::path> parts = {folder / "scale.part"};
    prt::save_part(parts[0], plan, {}, light[0]);
    light.clear();
    lap();
    const std::uint64_t scene_bytes = prt::join_parts(parts, folder / "scale.prt");
    costs.join_seconds = lap() / pairs;
    costs.file_bytes = static_cast<double>(scene_bytes) / pairs;
    fs::remove(plan_file);
    fs::remove(parts[0]);
    fs::remove(folder / "scale.prt");
    return costs;
}

struct Machines {
    std::size_t num_hosts = 1;
    /// One task at a time on all cores of a host
    double cores_per_host = 16.0;
    /// Times of equal tasks scatter so much, relative
    double scatter = 0.1;
    /// One task in so many takes three times as long
    double one_slow_in = 100.0;
    /// Hours between two failures of one host
    double hours_to_failure = 1000.0;
};

struct Outcome {
    double seconds = 0.0;
    /// What tasks did that failed
    double lost_seconds = 0.0;
    std::size_t num_failures = 0;
};

/// Gives each host the next task when it has done one. A task whose host fails goes back to the
/// queue; the host is back after ten minutes.
Outcome simulated(std::size_t num_tasks, double seconds_per_task, const Machines& machines) {
    constexpr double Repair = 600.0;
    std::mt19937 random(1);
    std::lognormal_distribution<double> scatter(0.0, machines.scatter);
    std::bernoulli_distribution is_slow(1.0 / machines.one_slow_in);
    std::exponential_distribution<double> failure(1.0 / (3600.0 * machines.hours_to_failure));
    std::priority_queue<double, std::vector<double>, std::greater<>> free_at;
    for (std::size_t i = 0; i < machines.num_hosts; ++i)
        free_at.push(0.0);
    Outcome outcome;
    for (std::size_t left = num_tasks; left > 0;) {
        const double start = free_at.top();
        free_at.pop();
        const double task = seconds_per_task * scatter(random) * (is_slow(random) ? 3.0 : 1.0);
        const double fails_after = failure(random);
        if (fails_after < task) {
            outcome.lost_seconds += fails_after;
            ++outcome.num_failures;
            free_at.push(start + fails_after + Repair);
            continue;
        }
        --left;
        outcome.seconds = std::max(outcome.seconds, start + task);
        free_at.push(start + task);
    }
    return outcome;
}

std::string time_text(double seconds) {
    if (seconds < 120.0)
        return fmt::format("{:.0f} s", seconds);
    if (seconds < 7200.0)
        return fmt::format("{:.0f} min", seconds / 60.0);
    if (seconds < 172800.0)
        return fmt::format("{:.0f} h", seconds / 3600.0);
    return fmt::format("{:.0f} d", seconds / 86400.0);
}

std::string size_text(double bytes) {
    return bytes < 1e9    ? fmt::format("{:.0f} MB", bytes * 1e-6)
           : bytes < 1e13 ? fmt::format("{:.0f} GB", bytes * 1e-9)
                          : fmt::format("{:.0f} TB", bytes * 1e-12);
}

void print_row(const Costs& costs, double receivers, double cores, double network_speed) {
    // What a receiver and a triangle take in memory (docs/measurements.md, "Memory"); a triangle of
    // a lightmap has a hundred texels.
    constexpr double BytesPerReceiver = 80.0;
    constexpr double BytesPerTriangle = 410.0;
    constexpr double TexelsPerTriangle = 100.0;
    constexpr double Planes = 2048.0;
    // A lost task should cost little, and a task's memory fall with their number.
    constexpr std::size_t TasksPerHost = 4;

    Machines machines;
    machines.cores_per_host = std::min(cores, 16.0);
    machines.num_hosts = static_cast<std::size_t>(std::max(cores / machines.cores_per_host, 1.0));
    const std::size_t num_tasks = TasksPerHost * machines.num_hosts;
    const auto tasks = static_cast<double>(num_tasks);
    const double pairs = receivers * costs.clusters;
    const double light = pairs * costs.light_bytes;

    const double fixed_bytes =
        receivers * BytesPerReceiver + receivers / TexelsPerTriangle * BytesPerTriangle;
    const double task_bytes = fixed_bytes + (2.0 * light + Planes * receivers / 8.0) / tasks;
    // The join has one part by itself, then a frame of each, and those that it packs.
    constexpr double FrameBytes = 2.2e6, PackedBytes = 34e6;
    const double join_bytes =
        fixed_bytes + (light + pairs * costs.file_bytes) / tasks + tasks * FrameBytes + PackedBytes;
    const double plan_file = receivers * costs.plan_bytes;
    // All tasks read the plan from one store; parts go there, are read three times, and come back
    // as the scene.
    const double network = plan_file * tasks + 5.0 * pairs * costs.file_bytes;

    const double plan_seconds =
        pairs / 16.0 * costs.plan_seconds_per_pair / machines.cores_per_host;
    const double reading =
        std::max(receivers * costs.load_seconds,
                 plan_file * static_cast<double>(machines.num_hosts) / network_speed);
    const double task_seconds =
        reading + pairs * costs.seconds_per_pair / tasks / machines.cores_per_host;
    const Outcome parts = simulated(num_tasks, task_seconds, machines);
    const double join_seconds =
        pairs * costs.join_seconds + 4.0 * pairs * costs.file_bytes / network_speed;
    const auto first_limit = [&] {
        constexpr double Memory = 256e9;
        if (task_bytes > Memory)
            return "memory of a task: all receivers";
        if (join_bytes > Memory)
            return "memory of the join";
        if (join_seconds > parts.seconds)
            return "time of the join";
        if (plan_seconds > parts.seconds)
            return "time of the plan";
        if (reading > task_seconds / 2.0)
            return "reading the plan";
        return "nothing";
    };
    fmt::print("| {:.0f} M | {:.0f} | {} | {} | {} | {} | {} | {} | {} | {} | {} |\n",
               receivers * 1e-6, cores, time_text(plan_seconds), time_text(parts.seconds),
               time_text(join_seconds), size_text(task_bytes), size_text(join_bytes),
               size_text(network), size_text(pairs * costs.file_bytes), time_text(task_seconds),
               first_limit());
}

} // namespace

int main(int argc, char** argv) {
    std::size_t num_vertices = 200'000;
    float tolerance = prt::PrecomputeOptions{}.tolerance;
    double network_speed = 1e9;
    fs::path folder = fs::temp_directory_path();
    bench::Program program("bench_scale",
                           "planned precomputes on machines that are not here: costs measured on "
                           "a knot, then a simulation of tasks on hosts of 16 cores, with "
                           "stragglers and failures; Markdown on stdout");
    program.add("--vertices", num_vertices, "of the knot that is measured");
    program.add("--tolerance", tolerance, "of its plan");
    program.add("--network", network_speed, "bytes a second that the shared store gives to all");
    program.add("--folder", folder, "for files that go away");
    return program.run(argc, argv, [&] {
        const Costs costs = program.is_tiny() ? measured(2000, 0.1f, folder)
                                              : measured(num_vertices, tolerance, folder);
        fmt::print("Measured: {:.0f} clusters; {:.2f} ns of a core for each pair of a receiver and "
                   "a cluster (the plan {:.2f} ns for each sampled one), {:.2f} ns to join it; "
                   "{:.4f} bytes of a pair in memory, {:.4f} in the file; {:.2f} us to read a "
                   "receiver of a plan, {:.1f} bytes in its file.\n\n",
                   costs.clusters, 1e9 * costs.seconds_per_pair, 1e9 * costs.plan_seconds_per_pair,
                   1e9 * costs.join_seconds, costs.light_bytes, costs.file_bytes,
                   1e6 * costs.load_seconds, costs.plan_bytes);
        fmt::print("| receivers | cores | plan | parts | join | memory of a task | of the join | "
                   "network | scene | a lost host costs | what breaks first |\n"
                   "|---|---|---|---|---|---|---|---|---|---|---|\n");
        for (const double receivers : {1e6, 1e8, 1e9})
            for (const double cores : {1.0, 16.0, 256.0, 4096.0})
                print_row(costs, receivers, cores, network_speed);
    });
}
