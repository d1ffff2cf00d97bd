// A tree of triangles in groups, which change one by one.
#pragma once

#include <cstddef>
#include <vector>

#include "prt/visibility/triangle_tree.h"

namespace relumine::prt {

/// A tree over trees, each of a group: one that changes is put in the place of the one before.
class GroupedTree {
public:
    GroupedTree() = default;
    /// The trees have one centre; those of groups without triangles are empty.
    explicit GroupedTree(std::vector<TriangleTree> groups);

    /// Cost:    a copy of all trees.
    void replace(std::size_t group, const TriangleTree& tree);
    [[nodiscard]] const TriangleTree& tree() const { return tree_; }

private:
    TriangleTree tree_;
    /// [groups] of tree_
    std::vector<TreePart> parts_;
};

} // namespace relumine::prt
