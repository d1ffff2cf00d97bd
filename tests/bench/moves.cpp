// What a move costs beside a precompute anew: a room of thirty things, one of which moves by its
// size, twenty times. See docs/moves.md.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "data_gen/environments.h"
#include "prt/precompute_context.h"
#include "prt/visibility/beam_scene.h"
#include "relumine/light/scene_moves.h"
#include "relumine/relumine.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/program.h"
#include "tests/bench/times.h"

using namespace relumine;

namespace {

constexpr std::uint32_t NumThings = 30;

struct Settings {
    float cell = 0.06f, tolerance = 0.025f;
    std::size_t num_moves = 20, num_verified = 100;
    bool bounces = false;
};

/// Rectangles cut into cells, each a part of a group.
class Room {
public:
    explicit Room(float cell) : cell_(cell) {
        mesh_.groups = {"room"};
        constexpr float W = 10.0f, H = 3.0f, D = 8.0f;
        wall({0, 0, 0}, {0, 0, D}, {W, 0, 0});
        wall({0, H, 0}, {W, 0, 0}, {0, 0, D});
        wall({0, 0, 0}, {0, H, 0}, {0, 0, D});
        wall({W, 0, 0}, {0, 0, D}, {0, H, 0});
        wall({0, 0, 0}, {W, 0, 0}, {0, H, 0});
        // The front is open between three pillars.
        for (const float x : {0.0f, 4.5f, 9.5f})
            box({x, 0, D}, {x + (x == 4.5f ? 1.0f : 0.5f), H, D + 0.3f});
        std::mt19937 random(7);
        const auto part = [&random] {
            return static_cast<float>(random() % 1000) / 1000.0f;
        };
        for (std::uint32_t i = 0; i < NumThings; ++i) {
            mesh_.groups.push_back(fmt::format("thing{}", i));
            const glm::vec3 at(0.6f + 1.6f * static_cast<float>(i % 6) + 0.3f * part(), 0.002f,
                               0.6f + 1.45f * static_cast<float>(i / 6) + 0.2f * part());
            const glm::vec3 size(0.5f + 0.4f * part(), 0.4f + 0.9f * part(), 0.5f + 0.4f * part());
            if (i % 3 == 2)
                table(at, size);
            else
                box(at, at + size);
        }
    }
    [[nodiscard]] const mesh::TriangleMesh& mesh() const { return mesh_; }

private:
    /// From a corner along two sides; it faces their cross product.
    void wall(const glm::vec3& corner, const glm::vec3& along, const glm::vec3& up) {
        const auto count = [this](const glm::vec3& side) {
            return std::max(1u, static_cast<std::uint32_t>(std::lround(glm::length(side) / cell_)));
        };
        const std::uint32_t n = count(along), m = count(up);
        const auto first = static_cast<std::uint32_t>(mesh_.num_vertices());
        for (std::uint32_t j = 0; j <= m; ++j)
            for (std::uint32_t i = 0; i <= n; ++i) {
                mesh_.positions.push_back(corner +
                                          along * (static_cast<float>(i) / static_cast<float>(n)) +
                                          up * (static_cast<float>(j) / static_cast<float>(m)));
                mesh_.normals.push_back(glm::normalize(glm::cross(along, up)));
            }
        for (std::uint32_t j = 0; j < m; ++j)
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t a = first + j * (n + 1) + i, b = a + n + 1;
                mesh_.triangles.push_back({a, a + 1, b});
                mesh_.triangles.push_back({a + 1, b + 1, b});
            }
        mesh_.triangle_groups.resize(mesh_.num_triangles(),
                                     static_cast<std::uint32_t>(mesh_.groups.size() - 1));
    }
    void box(const glm::vec3& low, const glm::vec3& high) {
        const glm::vec3 size = high - low, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
        wall(low, z, y);
        wall(low + x, y, z);
        wall(low, x, z);
        wall(low + y, z, x);
        wall(low, y, x);
        wall(low + z, x, y);
    }
    void table(const glm::vec3& at, const glm::vec3& size) {
        constexpr float Leg = 0.06f, Top = 0.05f;
        box(at + glm::vec3(0, size.y, 0), at + size + glm::vec3(0, Top, 0));
        for (const float x : {0.0f, size.x - Leg})
            for (const float z : {0.0f, size.z - Leg})
                box(at + glm::vec3(x, 0, z), at + glm::vec3(x + Leg, size.y - 0.001f, z + Leg));
    }

    float cell_;
    mesh::TriangleMesh mesh_;
};

/// Whether the counts are those of a precompute with the scene's clusters, bit by bit.
bool are_fresh(const Scene& scene) {
    const prt::RayScene rays(scene.blocking_mesh());
    const prt::BeamScene beams(scene.blocking_mesh(), rays);
    const prt::VisibleCounts counts =
        prt::precompute(
            scene.receivers, beams,
            {.face_resolution = scene.settings.face_resolution, .bias = scene.settings.bias}, {},
            {.given = &scene.transfer, .has_clusters = true})
            .counts;
    const prt::VisibleCounts& own = scene.transfer.counts;
    return counts.visible == own.visible && counts.mixed == own.mixed &&
           counts.counts == own.counts;
}

double error_of(const LitScene& lit, std::size_t num_receivers) {
    return verify(lit, {.num_samples = num_receivers, .num_surface_points = 0}).error.relative_l2;
}

/// What drags cost, and how far what they show is from the light after a move there.
struct DragFigures {
    std::vector<double> seconds, processor, errors;
};

/// Drags a group to where a step takes it, in several steps, and takes it back. Returns the light
/// at the end of it.
std::vector<glm::vec3> dragged(LitScene& lit, const GroupStep& to, DragFigures& figures) {
    constexpr int NumSteps = 4;
    const Scene& scene = lit.scene();
    std::vector<GroupMove> moves;
    for (int i = 1; i <= NumSteps; ++i) {
        const double part = static_cast<double>(i) / NumSteps;
        moves.push_back(
            move_of(scene, {.name = to.name, .by = part * to.by, .degrees = part * to.degrees}));
    }
    for (const GroupMove& move : moves)
        figures.processor.push_back(bench::processor_seconds_of([&] {
            figures.seconds.push_back(bench::seconds_of([&] { lit.moves().drag(move); }));
        }));
    std::vector<glm::vec3> result(lit.radiance().begin(), lit.radiance().end());
    lit.moves().undo();
    return result;
}

/// Relative L2 of radiance
double difference(std::span<const glm::vec3> found, std::span<const glm::vec3> expected) {
    double sum = 0.0, of_all = 0.0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const glm::dvec3 own(expected[i]), error = glm::dvec3(found[i]) - own;
        sum += glm::dot(error, error);
        of_all += glm::dot(own, own);
    }
    return std::sqrt(sum / of_all);
}

void run(const Settings& settings) {
    const PrecomputeOptions options{.tolerance = settings.tolerance,
                                    .no_refine = true,
                                    .bounce_tolerance = settings.bounces ? 0.01f : 0.0f,
                                    .movable = true};
    const Mesh mesh = Room(settings.cell).mesh();
    const auto environment = std::make_shared<const cubemap::CubeMap>(
        data_gen::sun_and_sky(128, {.sun_azimuth_degrees = 20.0}));
    Scene scene;
    double fresh = 0.0;
    const double fresh_processor = bench::processor_seconds_of(
        [&] { fresh = bench::seconds_of([&] { scene = precompute(mesh, options); }); });
    const std::size_t num_receivers = scene.receivers.size();
    const std::size_t num_clusters = scene.transfer.num_clusters();
    LitScene lit(std::move(scene));
    lit.light(environment);
    if (settings.bounces)
        lit.bounce({.albedo = bounce_albedo(lit.scene())});
    const double memory_before = bench::peak_megabytes();

    std::mt19937 random(3);
    const auto part = [&random] {
        return static_cast<double>(random() % 2001) / 1000.0 - 1.0;
    };
    std::vector<double> seconds, processor, pairs, moved;
    DragFigures drag;
    double memory = memory_before;
    for (std::size_t i = 0; i < settings.num_moves; ++i) {
        GroupStep step{.name = fmt::format("thing{}", random() % NumThings)};
        const double angle = std::numbers::pi * part();
        step.by = 0.9 * glm::dvec3(std::cos(angle), 0.0, std::sin(angle));
        step.degrees = i % 3 == 2 ? 180.0 * part() : 0.0;
        const std::vector<glm::vec3> quick = dragged(lit, step, drag);
        MoveReport report;
        processor.push_back(bench::processor_seconds_of([&] {
            seconds.push_back(
                bench::seconds_of([&] { report = lit.moves().move(move_of(lit.scene(), step)); }));
        }));
        drag.errors.push_back(difference(quick, lit.radiance()));
        pairs.push_back(static_cast<double>(report.counts.num_pairs) /
                        static_cast<double>(report.num_all));
        moved.push_back(static_cast<double>(report.num_moved) / static_cast<double>(num_receivers));
        if (i == 0)
            memory = bench::peak_megabytes();
    }
    const double undo = bench::seconds_of([&] { lit.moves().undo(); });
    lit.moves().redo();
    const bool are_equal = are_fresh(lit.scene());
    const double error = error_of(lit, settings.num_verified);
    const std::size_t num_expected = fresh_clusters(lit.scene());

    Mesh there = lit.scene().mesh;
    LitScene anew(precompute(std::move(there), options));
    anew.light(environment);
    if (settings.bounces)
        anew.bounce({.albedo = bounce_albedo(anew.scene())});
    const double error_anew = error_of(anew, settings.num_verified);

    fmt::print("{} receivers, {} clusters, {} things{}\n\n", num_receivers, num_clusters, NumThings,
               settings.bounces ? ", with bounces" : "");
    fmt::print("| | seconds | of all processors |\n|---|---|---|\n");
    fmt::print("| a precompute | {:.2f} | {:.2f} |\n", fresh, fresh_processor);
    fmt::print("| a move, and light again; median of {} | {:.3f} | {:.3f} |\n", seconds.size(),
               bench::median(seconds), bench::median(processor));
    fmt::print("| the same over a precompute | {:.3f} | {:.3f} |\n", bench::median(seconds) / fresh,
               bench::median(processor) / fresh_processor);
    fmt::print("| undo | {:.3f} | |\n", undo);
    fmt::print("| a step of a drag; median of {} | {:.3f} | {:.3f} |\n\n", drag.seconds.size(),
               bench::median(drag.seconds), bench::median(drag.processor));
    fmt::print("A drag shows {:.1f} steps a second. Its light is {:.4f} from that of a move there, "
               "relative L2 (median; {:.4f} at most).\n",
               1.0 / bench::median(drag.seconds), bench::median(drag.errors),
               *std::ranges::max_element(drag.errors));
    fmt::print("A move takes {:.1f} % of the receivers along, and {:.1f} % of the counts are made "
               "anew (medians).\n",
               100.0 * bench::median(moved), 100.0 * bench::median(pairs));
    fmt::print("After all moves: counts {} those of a precompute with the same clusters; error "
               "{:.4f}, of a precompute of the moved room {:.4f} ({} clusters, expected {}), ratio "
               "{:.2f}.\n",
               are_equal ? "equal" : "DIFFER FROM", error, error_anew,
               anew.scene().transfer.num_clusters(), num_expected, error / error_anew);
    fmt::print("Peak memory: {:.0f} MB, {:.0f} MB with a move.\n", memory_before, memory);
    if (!are_equal)
        throw std::runtime_error("expected the counts of a precompute with the same clusters");
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_moves", "a room whose things move, beside a precompute anew");
    program.add("--cell", settings.cell, "side of the cells of its surfaces; the room is 10 wide");
    program.add("--tolerance", settings.tolerance, "of the clusters");
    program.add("--moves", settings.num_moves, "1 or more");
    program.add("--verified", settings.num_verified, "receivers that are integrated exactly");
    program.add_flag("--bounces", settings.bounces, "light bounces");
    return program.run(argc, argv, [&] {
        if (program.is_tiny())
            settings = {.cell = 0.5f,
                        .tolerance = 0.05f,
                        .num_moves = 3,
                        .num_verified = 20,
                        .bounces = settings.bounces};
        if (settings.num_moves == 0)
            throw std::invalid_argument("expected at least one move");
        run(settings);
    });
}
