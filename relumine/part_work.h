// What one of several processes does of a precompute.
#pragma once

#include <chrono>
#include <ctime>

#include "prt/bounces/bounce_precompute.h"
#include "prt/parts/part_file.h"
#include "prt/team.h"
#include "relumine/precompute.h"

namespace relumine {

/// The share of one process, while it lasts.
class ProcessWork {
public:
    explicit ProcessWork(const prt::Team* team) : team_(team), waiting_before_(waiting()) {}

    [[nodiscard]] ProcessFigures figures(const prt::PrecomputeStatistics& clusters) const {
        const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
        return {.num_rays = clusters.num_own_rays,
                .seconds = seconds.count(),
                .seconds_waiting = waiting() - waiting_before_,
                .seconds_of_processors =
                    static_cast<double>(std::clock() - processors_before_) / CLOCKS_PER_SEC,
                .plane_bytes = clusters.plane_bytes,
                .column_bytes = clusters.column_bytes};
    }

private:
    [[nodiscard]] double waiting() const {
        return team_ != nullptr ? team_->seconds_waiting() : 0.0;
    }

    const prt::Team* team_;
    double waiting_before_;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
    std::clock_t processors_before_ = std::clock();
};

/// The bounces of a part's receivers, those of options.reduction. `transfer` has their counts; it
/// is the same afterwards. `plan`: of a part that knows nothing of others.
[[nodiscard]] prt::BounceSamples bounce_samples(const mesh::TriangleMesh& mesh,
                                                const prt::Receivers& receivers,
                                                prt::Transfer& transfer, const prt::RayScene& rays,
                                                const prt::BounceOptions& options,
                                                const prt::PlannedBounces* plan = nullptr);

} // namespace relumine
