// The stages of a precompute, one after the other. Private.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "prt/parts/part_file.h"
#include "prt/visibility/ray_scene.h"
#include "relumine/in/precompute_options.h"

namespace relumine {

/// "12 MB": powers of 1024, rounded up; "12 bytes" below one.
[[nodiscard]] std::string megabytes(std::uint64_t bytes);

/// Returns what answers ray queries about a mesh. `prefix` begins messages.
[[nodiscard]] prt::RayScene ray_scene(const mesh::TriangleMesh& mesh, const std::string& prefix);

// What a precompute tells its caller, who need not listen.
void warn(const PrecomputeWork& work, Warning kind, const std::string& message);
void note(const PrecomputeWork& work, const std::string& message);

/// Returns what a scene's clusters were chosen by.
[[nodiscard]] prt::PrecomputeOptions cluster_options(const prt::SceneSettings& settings);

/// Clusters, highlights and bounces of the receivers that this process or part has.
class Stages {
public:
    struct Options {
        /// What blocks light; null: the mesh's triangles (PrecomputeOptions::blockers)
        const prt::Blockers* blockers = nullptr;
        /// Most bytes that the work may take; empty: no limit (PrecomputeOptions::max_memory)
        std::optional<std::uint64_t> max_memory = {};
        /// Begins all messages: "bunny.ply: " or nothing
        std::string prefix = {};
        prt::Checkpoint* checkpoint = nullptr;
    };

    /// The arguments must outlive this object. What the plan's settings name is computed. The
    /// report receives the figures of the stages.
    Stages(prt::Plan& plan, const PrecomputeWork& work, PrecomputeReport& report, Options options)
        : plan_(plan), scene_(plan.scene), work_(work), report_(report),
          options_(std::move(options)) {}

    /// Refuses a scene that takes more than max_memory by itself.
    void check_scene() const;

    /// Chooses clusters from a sample of the receivers: gives the plan order, normals, quadtree and
    /// the light of the sample.
    void choose_clusters(const prt::RayScene& rays);

    /// Does the work of the process or part. `rays`: of what blocks light.
    [[nodiscard]] prt::PartLight run(const prt::RayScene& rays);

    /// Samples the bounces alone, for counts that are there: those of the process or part.
    [[nodiscard]] prt::BounceSamples bounces(const prt::RayScene& rays);

private:
    template<typename Find>
    void find_clusters(const prt::RayScene& rays, const Find& find);
    void limit_clusters(const prt::Blockers& blockers, prt::PrecomputeOptions& clusters);
    void add_highlights(const prt::RayScene& rays);

    [[nodiscard]] prt::SceneSizes sizes() const;
    [[nodiscard]] prt::Work work_for(Stage stage, bool more_follows) const;
    [[nodiscard]] MemoryLimitExceeded exceeded(MemoryLimitExceeded::Part part,
                                               const std::string& expected,
                                               const std::string& got) const;
    [[nodiscard]] std::string within_limit() const;

    prt::Plan& plan_;
    prt::Scene& scene_;
    const PrecomputeWork& work_;
    PrecomputeReport& report_;
    Options options_;
};

} // namespace relumine
