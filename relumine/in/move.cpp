#include "relumine/in/move.h"

#include <algorithm>
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

#include "files/nearest_name.h"
#include "files/seconds.h"
#include "prt/moves/resampled_bounces.h"
#include "prt/visibility/beam_scene.h"
#include "relight/probe_lights.h"
#include "relumine/in/stages.h"
#include "relumine/options/option_table.h"

namespace relumine {

namespace {

std::uint32_t group_named(const Scene& scene, const std::string& name) {
    const std::vector<std::string>& names = scene.mesh.groups;
    if (scene.mesh.triangle_groups.empty())
        throw std::invalid_argument("expected a scene that was precomputed with --movable, got one "
                                    "without groups");
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
        throw std::invalid_argument(
            fmt::format("expected one of {} groups, got '{}'{}", names.size(), name,
                        files::did_you_mean(name, std::span<const std::string>(names))));
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
void find_bounces(Scene& scene, const prt::RayScene& rays, const PrecomputeWork& work) {
    PrecomputeReport found;
    prt::Plan plan{.scene = std::move(scene)};
    plan.bounces = {.tolerance = plan.scene.settings.bounce_tolerance};
    try {
        std::vector<prt::BounceSamples> samples;
        samples.push_back(Stages(plan, work, found, {}).bounces(rays));
        scene = std::move(plan.scene);
        scene.bounces = prt::join_bounces(scene.receivers, scene.transfer, std::move(samples));
    } catch (...) {
        if (scene.mesh.positions.empty())
            scene = std::move(plan.scene);
        throw;
    }
}

/// The open part of each receiver's hemisphere, by place.
std::vector<float> open_parts(const Scene& scene) {
    std::vector<float> result;
    for (const prt::ProbeRadiance& probe : relight::probe_radiance(scene.transfer))
        result.push_back(probe.front());
    return result;
}

/// A move, step by step. The scene's bounces stay in the change as long as there are no others.
class Move {
public:
    Move(Scene& scene, const GroupMove& to, const PrecomputeWork& work)
        : scene_(scene), work_(work),
          change_(prt::moved(scene, group_named(scene, to.name), to.matrix, difference_)),
          has_bounces_(scene.bounces.has_value()) {}

    prt::SceneChange run(MoveReport& report) {
        const auto start = std::chrono::steady_clock::now();
        const mesh::Bounds box = mesh::bounds(scene_.mesh);
        prt::exchange(scene_, change_);
        try {
            const prt::RayScene rays = ray_scene(scene_.blocking_mesh(), "");
            prt::CountsPatch counts = recounted(rays, report);
            const auto start_bounces = std::chrono::steady_clock::now();
            std::optional<prt::ResampledBounces> resampled = bounces_before(counts);
            prt::exchange(scene_.transfer.counts, counts);
            change_.counts = std::move(counts);
            if (has_bounces_)
                bounce(rays, resampled);
            report.seconds_bounces = files::seconds_since(start_bounces);
        } catch (...) {
            prt::exchange(scene_, change_);
            throw;
        }
        prt::set_surfaces(scene_.transfer, scene_.receivers);
        report.num_moved = static_cast<std::size_t>(
            std::count(difference_.receivers.begin(), difference_.receivers.end(), true));
        report.num_all =
            std::uint64_t{scene_.transfer.counts.num_blocks()} * scene_.transfer.counts.num_leaves;
        report.leaves_box = !is_inside(mesh::bounds(scene_.mesh), box);
        report.seconds = files::seconds_since(start);
        return std::move(change_);
    }

private:
    prt::CountsPatch recounted(const prt::RayScene& rays, MoveReport& report) const {
        const prt::BeamScene beams(scene_.blocking_mesh(), rays);
        return prt::recounted(
            scene_.receivers, beams, scene_.transfer, difference_,
            {.face_resolution = scene_.settings.face_resolution, .bias = scene_.settings.bias},
            work_.of(Stage::Clusters), &report.counts);
    }

    /// Finds what the bounces' rays met that are to be traced anew. Nothing where all are.
    std::optional<prt::ResampledBounces> bounces_before(const prt::CountsPatch& counts) {
        prt::exchange(scene_, change_);
        std::optional<prt::ResampledBounces> result;
        try {
            if (prt::ResampledBounces::are_possible(scene_)) {
                const std::vector<float> open = open_parts(scene_);
                result.emplace(prt::BounceView{scene_, open, ray_scene(scene_.mesh, "")},
                               difference_, counts, work_.of(Stage::Bounces).part(0.0, 0.5));
            }
        } catch (...) {
            prt::exchange(scene_, change_);
            throw;
        }
        prt::exchange(scene_, change_);
        return result;
    }

    void bounce(const prt::RayScene& rays, std::optional<prt::ResampledBounces>& resampled) {
        if (!resampled) {
            find_bounces(scene_, rays, work_);
            return;
        }
        std::optional<prt::RayScene> of_mesh;
        if (scene_.blockers)
            of_mesh.emplace(ray_scene(scene_.mesh, ""));
        const std::vector<float> open = open_parts(scene_);
        std::vector<prt::BounceSamples> samples;
        samples.push_back(resampled->samples({scene_, open, of_mesh ? *of_mesh : rays},
                                             *change_.bounces,
                                             work_.of(Stage::Bounces).part(0.5, 0.5)));
        scene_.bounces = prt::join_bounces(scene_.receivers, scene_.transfer, std::move(samples));
    }

    Scene& scene_;
    const PrecomputeWork& work_;
    prt::SceneDifference difference_;
    prt::SceneChange change_;
    bool has_bounces_;
};

} // namespace

GroupStep GroupStepText::read(const std::string& text) {
    const std::size_t equals = text.rfind('=');
    const auto numbers = parse_numbers(equals == std::string::npos ? "" : text.substr(equals + 1));
    const auto is_finite = [](double number) {
        return std::isfinite(number);
    };
    if (equals == 0 || !numbers || (numbers->size() != 3 && numbers->size() != 4) ||
        !std::all_of(numbers->begin(), numbers->end(), is_finite))
        refuse_text("NAME=X,Y,Z or NAME=X,Y,Z,DEGREES", text);
    return {.name = text.substr(0, equals),
            .by = {(*numbers)[0], (*numbers)[1], (*numbers)[2]},
            .degrees = numbers->size() == 4 ? numbers->back() : 0.0};
}

std::string GroupStepText::show(const GroupStep& step) {
    return fmt::format("{}={},{},{}{}", step.name, step.by.x, step.by.y, step.by.z,
                       step.degrees == 0.0 ? "" : fmt::format(",{}", step.degrees));
}

GroupMove move_of(const Scene& scene, const GroupStep& step) {
    const glm::dvec3 middle =
        glm::dvec3(box_of(scene.mesh, group_named(scene, step.name)).center()) + scene.mesh.offset;
    glm::dmat4 matrix = glm::translate(glm::dmat4(1.0), middle + step.by);
    if (step.degrees != 0.0)
        matrix = glm::rotate(matrix, glm::radians(step.degrees), glm::dvec3(0.0, 1.0, 0.0));
    return {.name = step.name, .matrix = glm::translate(matrix, -middle)};
}

prt::SceneChange move(Scene& scene, const GroupMove& to, const PrecomputeWork& work,
                      MoveReport* report) {
    if (!has_clusters(scene))
        throw std::invalid_argument("expected a precomputed scene, got a mesh without clusters");
    MoveReport local;
    return Move(scene, to, work).run(report != nullptr ? *report : local);
}

} // namespace relumine
