#include "relumine/in/move.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/ext/matrix_transform.hpp>
#include <glm/trigonometric.hpp>

#include "files/joined.h"
#include "files/nearest_name.h"
#include "files/seconds.h"
#include "mesh/load.h"
#include "prt/moves/new_obstacles.h"
#include "prt/moves/resampled_bounces.h"
#include "prt/parts/parts.h"
#include "relight/relighter.h"
#include "relumine/in/stages.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

constexpr std::array GoingWords = {std::pair("away", Going::Away), std::pair("back", Going::Back)};

/// Returns the number of a group.
std::uint32_t number_of(const mesh::TriangleMesh& mesh, const std::string& name) {
    const std::vector<std::string>& names = mesh.groups;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
        constexpr std::size_t MostListed = 12;
        std::string hint = files::did_you_mean(name, std::span<const std::string>(names));
        if (hint.empty() && names.size() <= MostListed)
            hint = ": " + files::joined_by_or(names);
        throw std::invalid_argument(
            fmt::format("expected one of {} groups, got '{}'{}", names.size(), name, hint));
    }
    return static_cast<std::uint32_t>(found - names.begin());
}

mesh::Bounds box_of(const mesh::TriangleMesh& mesh, std::uint32_t group) {
    std::vector<glm::vec3> corners;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        if (mesh.triangle_groups[i] == group)
            for (const std::uint32_t vertex : mesh.triangles[i])
                corners.push_back(mesh.positions[vertex]);
    return mesh::bounds(corners);
}

bool is_inside(const mesh::Bounds& box, const mesh::Bounds& of) {
    return glm::min(box.min, of.min) == of.min && glm::max(box.max, of.max) == of.max;
}

/// Samples the scene's bounces anew, all of them.
prt::BounceMatrix found_bounces(Scene& scene, const prt::RayScene& rays,
                                const PrecomputeWork& work) {
    PrecomputeReport found;
    prt::Plan plan{.scene = std::move(scene)};
    plan.bounces = {.tolerance = plan.scene.settings.bounce_tolerance};
    try {
        std::vector<prt::BounceSamples> samples;
        samples.push_back(Stages(plan, work, found, {}).bounces(rays));
        scene = std::move(plan.scene);
        return prt::join_bounces(scene.receivers, scene.transfer, std::move(samples));
    } catch (...) {
        if (scene.mesh.positions.empty())
            scene = std::move(plan.scene);
        throw;
    }
}

/// The open part of each receiver's hemisphere, by place.
std::vector<float> open_parts(const Scene& scene) {
    relight::Relighter relighter(scene.transfer);
    relighter.set_environment(cubemap::CubeMap(1, glm::vec3(1.0f)));
    std::vector<float> result;
    for (const std::uint32_t receiver : scene.transfer.order)
        result.push_back(relighter.diffuse_radiance()[receiver].g);
    return result;
}

prt::SceneChange change_of(const Scene& scene, const GroupMove& to) {
    const std::uint32_t group = group_named(scene, to.name);
    switch (to.going) {
    case Going::To:
        return prt::moved(scene, group, to.matrix);
    case Going::Pose:
        return prt::posed(scene, group, to.vertices, to.normals);
    case Going::Away:
        return prt::taken_away(scene, group);
    case Going::Back:
        return prt::brought_back(scene, group);
    }
    return {};
}

prt::SceneChange change_of(const Scene& scene, std::span<const GroupMove> to) {
    if (to.empty())
        throw std::invalid_argument("expected groups to move, got none");
    std::vector<prt::SceneChange> result;
    for (const GroupMove& own : to)
        result.push_back(change_of(scene, own));
    return to.size() == 1 ? std::move(result.front()) : prt::joined(scene, std::move(result));
}

/// A move, step by step. The scene has its bounces of before until there are others.
class Move {
public:
    Move(Scene& scene, std::span<const GroupMove> to, SceneRays& rays, const PrecomputeWork& work)
        : scene_(scene), rays_(rays), work_(work), change_(change_of(scene, to)),
          has_bounces_(scene.bounces.has_value()) {}

    prt::SceneChange run(MoveReport& report) {
        const auto start = std::chrono::steady_clock::now();
        const mesh::Bounds box = mesh::bounds(scene_.mesh);
        exchange();
        report.num_moved = change_.receivers.size();
        try {
            prt::leave_new_obstacles(scene_, rays_.blockers(), change_);
            prt::CountsPatch counts = prt::recounted(
                scene_.receivers, rays_.beams(), scene_.transfer, change_.difference,
                {.face_resolution = scene_.settings.face_resolution, .bias = scene_.settings.bias},
                work_.of(Stage::Clusters), &report.counts);
            const auto start_bounces = std::chrono::steady_clock::now();
            std::optional<prt::ResampledBounces> resampled = bounces_before(counts);
            prt::exchange(scene_.transfer.counts, counts);
            change_.counts = std::move(counts);
            if (has_bounces_)
                bounce(resampled);
            report.seconds_bounces = files::seconds_since(start_bounces);
        } catch (...) {
            exchange();
            throw;
        }
        report.num_all =
            std::uint64_t{scene_.transfer.counts.num_blocks()} * scene_.transfer.counts.num_leaves;
        report.leaves_box = !is_inside(mesh::bounds(scene_.mesh), box);
        report.seconds = files::seconds_since(start);
        return std::move(change_);
    }

private:
    /// Moves the group, or moves it back.
    void exchange() {
        prt::exchange(scene_, change_);
        for (const std::uint32_t group : change_.groups)
            rays_.follow(group);
    }

    /// Finds what the bounces' rays met that are to be traced anew. Nothing where all are.
    std::optional<prt::ResampledBounces> bounces_before(const prt::CountsPatch& counts) {
        std::optional<prt::ResampledBounces> result;
        if (!has_bounces_)
            return result;
        exchange();
        try {
            if (prt::ResampledBounces::are_possible(scene_)) {
                const std::vector<float> open = open_parts(scene_);
                result.emplace(prt::BounceView{scene_, open, rays_.of_mesh()}, change_.difference,
                               counts, work_.of(Stage::Bounces).part(0.0, 0.5));
            }
        } catch (...) {
            exchange();
            throw;
        }
        exchange();
        return result;
    }

    void bounce(std::optional<prt::ResampledBounces>& resampled) {
        if (!resampled) {
            prt::BounceMatrix found = found_bounces(scene_, rays_.blockers(), work_);
            change_.bounces = std::exchange(scene_.bounces, std::move(found));
            return;
        }
        const std::vector<float> open = open_parts(scene_);
        change_.bounces_patch = resampled->update(*scene_.bounces, {scene_, open, rays_.of_mesh()},
                                                  work_.of(Stage::Bounces).part(0.5, 0.5));
    }

    Scene& scene_;
    SceneRays& rays_;
    const PrecomputeWork& work_;
    prt::SceneChange change_;
    bool has_bounces_;
};

} // namespace

PrecomputeWork move_work(const prt::Work& work) {
    return {.stop = work.stop, .on_progress = [work](Stage stage, double fraction) {
                work.tell(0.5 * fraction + (stage == Stage::Bounces ? 0.5 : 0.0));
            }};
}

void require_movable(const Scene& scene) {
    if (!scene.settings.is_movable || scene.mesh.triangle_groups.empty())
        throw std::invalid_argument("expected a scene that was precomputed with --movable, got one "
                                    "without groups");
}

std::uint32_t group_named(const Scene& scene, const std::string& name) {
    require_movable(scene);
    return number_of(scene.mesh, name);
}

GroupStep GroupStepText::read(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    const std::string name = text.substr(0, equals);
    const std::string to = equals == std::string::npos ? "" : text.substr(equals + 1);
    for (const auto& [word, going] : GoingWords)
        if (equals != 0 && to == word)
            return {.name = name, .going = going};
    if (equals != 0 && mesh::has_mesh_extension(to))
        return {.name = name, .going = Going::Pose, .file = to};
    const auto numbers = parse_numbers(to);
    const auto is_finite = [](double number) {
        return std::isfinite(number);
    };
    if (equals == 0 || !numbers || (numbers->size() != 3 && numbers->size() != 4) ||
        !std::all_of(numbers->begin(), numbers->end(), is_finite))
        refuse_text("NAME=X,Y,Z, NAME=X,Y,Z,DEGREES, NAME=away, NAME=back or NAME=FILE of a mesh",
                    text);
    return {.name = name,
            .by = {(*numbers)[0], (*numbers)[1], (*numbers)[2]},
            .degrees = numbers->size() == 4 ? numbers->back() : 0.0};
}

std::string GroupStepText::show(const GroupStep& step) {
    for (const auto& [word, going] : GoingWords)
        if (step.going == going)
            return fmt::format("{}={}", step.name, word);
    if (step.going == Going::Pose)
        return fmt::format("{}={}", step.name, step.file);
    return fmt::format("{}={},{},{}{}", step.name, step.by.x, step.by.y, step.by.z,
                       step.degrees == 0.0 ? "" : fmt::format(",{}", step.degrees));
}

glm::dvec3 middle_of(const Scene& scene, const std::string& name) {
    return glm::dvec3(box_of(scene.mesh, group_named(scene, name)).center()) + scene.mesh.offset;
}

GroupMove move_of(const Scene& scene, const GroupStep& step) {
    return move_of(step, middle_of(scene, step.name));
}

GroupMove move_of(const GroupStep& step, const glm::dvec3& middle) {
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), middle + step.by);
    if (step.degrees != 0.0)
        matrix = glm::rotate(matrix, glm::radians(step.degrees), glm::dvec3(0.0, 1.0, 0.0));
    return {.name = step.name, .matrix = glm::translate(matrix, -middle), .going = step.going};
}

GroupMove pose_of(const std::string& name, const mesh::TriangleMesh& mesh) {
    const bool is_whole = mesh.groups.empty();
    const std::uint32_t group = is_whole ? 0 : number_of(mesh, name);
    std::vector<bool> is_own(mesh.num_vertices());
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        for (const std::uint32_t vertex : mesh.triangles[i])
            is_own[vertex] = is_own[vertex] || is_whole || mesh.triangle_groups[i] == group;
    GroupMove result{.name = name, .going = Going::Pose};
    for (std::size_t i = 0; i < is_own.size(); ++i)
        if (is_own[i]) {
            result.vertices.push_back(glm::dvec3(mesh.positions[i]) + mesh.offset);
            if (!mesh.normals.empty())
                result.normals.push_back(mesh.normals[i]);
        }
    return result;
}

prt::SceneChange move(Scene& scene, const GroupMove& to, const PrecomputeWork& work,
                      MoveReport* report, SceneRays* rays) {
    return move(scene, std::span(&to, 1), work, report, rays);
}

prt::SceneChange move(Scene& scene, std::span<const GroupMove> to, const PrecomputeWork& work,
                      MoveReport* report, SceneRays* rays) {
    if (!has_clusters(scene))
        throw std::invalid_argument("expected a precomputed scene, got a mesh without clusters");
    MoveReport local;
    std::optional<SceneRays> own;
    if (rays == nullptr)
        own.emplace(scene);
    return Move(scene, to, rays != nullptr ? *rays : *own, work)
        .run(report != nullptr ? *report : local);
}

std::size_t fresh_clusters(const Scene& scene, const prt::Work& work) {
    require_movable(scene);
    const SceneRays rays(scene);
    prt::PrecomputeOptions options = cluster_options(scene.settings);
    // At the same tolerance, so without a limit that another tolerance would keep.
    options.most_clusters = {};
    return prt::plan_clusters(scene.receivers, rays.beams(), options, work).num_clusters();
}

} // namespace relumine
