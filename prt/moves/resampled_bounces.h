// After a move, the bounces' rays that can have met what moved, or can meet it now.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prt/bounces/bounce_matrix.h"
#include "prt/moves/bounces_patch.h"
#include "prt/moves/counts_patch.h"
#include "prt/moves/recount.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "prt/work.h"

namespace relumine::prt {

/// What bounces are sampled of: a scene, the open part of each receiver's hemisphere by place, and
/// the rays of the scene's mesh.
struct BounceView {
    const Scene& scene;
    std::span<const float> open_parts;
    const RayScene& rays;
};

/// Samples bounces anew where a move asks for it, in two steps: what rays met before, and what they
/// meet now. Each receiver looks into as many directions as before.
///
/// A ray is traced anew where it may meet a box of the difference and did not end before that, or
/// where the receiver saw all of its cluster and does so no more, or the other way round: no ray
/// goes there. So the rows are those of all rays, place by place.
class ResampledBounces {
public:
    /// Whether the scene keeps what this needs.
    [[nodiscard]] static bool are_possible(const Scene& scene);

    /// Finds what the rays met, in the scene before the move. `counts` are those of after it.
    ResampledBounces(const BounceView& before, const SceneDifference& difference,
                     const CountsPatch& counts, const Work& work);

    /// Makes the matrix, that of before the move, the one after it; once. Returns what undoes that.
    ///
    /// Throws:  Cancelled; nothing has changed then.
    [[nodiscard]] BouncesPatch update(BounceMatrix& matrix, const BounceView& now,
                                      const Work& work);

private:
    /// What changes in the row of a receiver.
    struct Row {
        /// Numbers of its directions that are traced anew
        std::vector<std::uint32_t> directions;
        /// All are, and the row is made anew.
        bool is_whole = false;
        /// What these met, and meet now: emitters, ascending.
        std::vector<std::uint32_t> emitters, now;
        std::uint32_t num_hits = 0;
        /// The sum over the hits of the first look
        double sum_inverse_distances = 0.0;
    };

    /// [receivers] by place
    std::vector<Row> rows_;
};

} // namespace relumine::prt
