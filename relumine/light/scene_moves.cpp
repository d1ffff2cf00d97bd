#include "relumine/light/scene_moves.h"

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace relumine {

namespace {

/// Returns the clusters that a quick state samples in their middle alone: those with no more light
/// than a cluster has in the mean.
std::vector<bool> coarse_clusters(const relight::Relighter& relighter) {
    const std::size_t count = relighter.transfer().num_clusters();
    std::vector<double> powers(count);
    for (std::size_t i = 0; i < count; ++i)
        powers[i] = relighter.cluster_light(i).power();
    const double mean =
        std::accumulate(powers.begin(), powers.end(), 0.0) / static_cast<double>(count);
    std::vector<bool> result(count);
    for (std::size_t i = 0; i < count; ++i)
        result[i] = powers[i] <= mean;
    return result;
}

} // namespace

void SceneMoves::require_movable() const {
    relumine::require_movable(scene_);
    if (own_ == nullptr)
        throw std::logic_error("expected a scene that is not shared, to move its groups");
    const prt::Blockers* blockers =
        relighter_ != nullptr ? relighter_->shadow_rays().blockers : nullptr;
    if (blockers != nullptr && blockers != &rays_.for_moving_lights())
        throw std::logic_error("expected triangles that block light where groups move, got others");
}

MoveReport SceneMoves::move(std::span<const GroupMove> to, const PrecomputeWork& work) {
    constexpr std::size_t MostMoves = 32;
    require_movable();
    if (drag_)
        take_back(false);
    MoveReport report;
    moves_.push_back(relumine::move(*own_, to, work, &report, &rays_));
    if (moves_.size() > MostMoves)
        moves_.erase(moves_.begin());
    undone_.clear();
    follower_.follow(moves_.back(), false);
    return report;
}

MoveReport SceneMoves::drag(const GroupMove& to) {
    require_movable();
    static_cast<void>(group_named(scene_, to.name));
    if (dragged_ && dragged_->name != to.name)
        take_back(false);
    std::vector<bool> coarse = coarse_clusters(require_clusters(relighter_));
    if (!drag_)
        drag_.emplace(*own_, rays_, to);
    MoveReport report;
    const prt::SceneChange change = drag_->to(to.matrix, std::move(coarse), report);
    dragged_ = to;
    follower_.follow(change, true);
    return report;
}

MoveReport SceneMoves::drop(const PrecomputeWork& work) {
    require_movable();
    if (!dragged_)
        throw std::logic_error("expected a group that is dragged");
    const GroupMove to = *dragged_;
    take_back(true);
    try {
        return move(to, work);
    } catch (...) {
        follower_.follow(prt::SceneChange(), false);
        throw;
    }
}

/// Ends the drag: the group stands where it stood before.
void SceneMoves::take_back(bool is_quick) {
    const prt::SceneChange change = drag_->back();
    drag_.reset();
    dragged_.reset();
    follower_.follow(change, is_quick);
}

bool SceneMoves::exchange(std::vector<prt::SceneChange>& from, std::vector<prt::SceneChange>& to) {
    require_movable();
    if (drag_) {
        take_back(false);
        return true;
    }
    if (from.empty())
        return false;
    prt::exchange(*own_, from.back());
    for (const std::uint32_t group : from.back().groups)
        rays_.follow(group);
    to.push_back(std::move(from.back()));
    from.pop_back();
    follower_.follow(to.back(), false);
    return true;
}

} // namespace relumine
