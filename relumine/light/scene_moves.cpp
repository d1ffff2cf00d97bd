#include "relumine/light/scene_moves.h"

#include <cstddef>
#include <numeric>
#include <utility>

namespace relumine {

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

const prt::SceneChange& SceneMoves::move(const GroupMove& to, const PrecomputeWork& work,
                                         MoveReport& report) {
    constexpr std::size_t MostMoves = 32;
    moves_.push_back(relumine::move(scene_, to, work, &report, &rays_));
    if (moves_.size() > MostMoves)
        moves_.erase(moves_.begin());
    undone_.clear();
    return moves_.back();
}

const prt::SceneChange* SceneMoves::exchange(bool is_undo) {
    std::vector<prt::SceneChange>& from = is_undo ? moves_ : undone_;
    std::vector<prt::SceneChange>& to = is_undo ? undone_ : moves_;
    if (from.empty())
        return nullptr;
    prt::exchange(scene_, from.back());
    rays_.follow(from.back().group);
    to.push_back(std::move(from.back()));
    from.pop_back();
    return &to.back();
}

const prt::SceneChange& SceneMoves::drag(const GroupMove& to, std::vector<bool> coarse,
                                         MoveReport& report) {
    if (!drag_)
        drag_.emplace(scene_, rays_, to);
    of_drag_ = drag_->to(to.matrix, std::move(coarse), report);
    dragged_ = to;
    return of_drag_;
}

const prt::SceneChange& SceneMoves::take_back() {
    of_drag_ = drag_->back();
    drag_.reset();
    dragged_.reset();
    return of_drag_;
}

} // namespace relumine
