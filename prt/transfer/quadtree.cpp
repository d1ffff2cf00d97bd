#include "prt/transfer/quadtree.h"

#include <stdexcept>

namespace relumine::prt {

Quadtree::Quadtree() : Quadtree(std::vector<bool>(cubemap::NumFaces, false)) {}

Quadtree::Quadtree(const std::vector<bool>& split_flags) : nodes_(cubemap::NumFaces) {
    std::size_t next_flag = 0;
    for (const cubemap::Face face : cubemap::AllFaces)
        build(static_cast<std::uint32_t>(face), Cell{.face = face}, split_flags, next_flag);
    if (next_flag != split_flags.size())
        throw std::invalid_argument("quadtree: expected the split flags to end with the last leaf");
}

void Quadtree::build(std::uint32_t node, const Cell& cell, const std::vector<bool>& split_flags,
                     std::size_t& next_flag) {
    if (next_flag == split_flags.size())
        throw std::invalid_argument("quadtree: expected more split flags");
    if (!split_flags[next_flag++]) {
        nodes_[node].leaf = static_cast<std::uint32_t>(leaves_.size());
        leaves_.push_back(cell);
        return;
    }
    if (cell.level == MaxLevel)
        throw std::invalid_argument("quadtree: expected at most 14 levels");
    const auto first_child = static_cast<std::uint32_t>(nodes_.size());
    nodes_[node].first_child = first_child;
    nodes_.resize(nodes_.size() + 4);
    for (std::uint32_t i = 0; i < 4; ++i)
        build(first_child + i, cell.child(i), split_flags, next_flag);
}

Quadtree Quadtree::of(const std::function<bool(const Cell&)>& is_split) {
    std::vector<bool> flags;
    const auto visit = [&](const auto& self, const Cell& cell) -> void {
        const bool has_children = is_split(cell);
        flags.push_back(has_children);
        for (std::uint32_t i = 0; has_children && i < 4; ++i)
            self(self, cell.child(i));
    };
    for (const cubemap::Face face : cubemap::AllFaces)
        visit(visit, Cell{.face = face});
    return Quadtree(flags);
}

std::vector<bool> Quadtree::split_flags() const {
    std::vector<bool> flags;
    flags.reserve(nodes_.size());
    const auto visit = [&](const auto& self, std::uint32_t node) -> void {
        const std::uint32_t first_child = nodes_[node].first_child;
        flags.push_back(first_child != 0);
        for (std::uint32_t i = 0; first_child != 0 && i < 4; ++i)
            self(self, first_child + i);
    };
    for (std::uint32_t face = 0; face < cubemap::NumFaces; ++face)
        visit(visit, face);
    return flags;
}

void Quadtree::find_leaves(const FaceRectangle& rectangle,
                           std::vector<std::uint32_t>& leaf_indices) const {
    const bool has_area = rectangle.s0 < rectangle.s1 && rectangle.t0 < rectangle.t1;
    if (has_area)
        find(static_cast<std::uint32_t>(rectangle.face), Cell{.face = rectangle.face}, rectangle,
             leaf_indices);
}

void Quadtree::find(std::uint32_t node, const Cell& cell, const FaceRectangle& rectangle,
                    std::vector<std::uint32_t>& leaf_indices) const {
    const double size = cell.size();
    const double s = cell.x * size;
    const double t = cell.y * size;
    const bool apart = s >= rectangle.s1 || s + size <= rectangle.s0 || t >= rectangle.t1 ||
                       t + size <= rectangle.t0;
    if (apart)
        return;
    const Node& here = nodes_[node];
    if (here.first_child == 0) {
        leaf_indices.push_back(here.leaf);
        return;
    }
    for (std::uint32_t i = 0; i < 4; ++i)
        find(here.first_child + i, cell.child(i), rectangle, leaf_indices);
}

std::uint32_t Quadtree::leaf_at(const cubemap::FacePoint& point) const {
    auto node = static_cast<std::uint32_t>(point.face);
    double s = point.s;
    double t = point.t;
    while (nodes_[node].first_child != 0) {
        const std::uint32_t right = s >= 0.5 ? 1 : 0;
        const std::uint32_t below = t >= 0.5 ? 1 : 0;
        s = 2.0 * s - right;
        t = 2.0 * t - below;
        node = nodes_[node].first_child + 2 * below + right;
    }
    return nodes_[node].leaf;
}

} // namespace relumine::prt
