#include "prt/visibility/beam_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <optional>
#include <utility>

#include "files/parallel.h"
#include "mesh/flat_regions.h"
#include "mesh/opacity.h"
#include "prt/visibility/beam_kernels.h"
#include "prt/visibility/bit_matrix.h"
#include "prt/visibility/group_origins.h"
#include "prt/visibility/grouped_tree.h"
#include "prt/visibility/parallel_rays.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/see_through.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/shaft_leaves.h"

namespace relumine::prt {
namespace {

/// Beyond this coordinate triple products overflow, in this file's tests or in the exact tracer's.
/// Then the exact tracer answers alone.
constexpr float LargestReach = 1e12f;

/// Asks the exact tracer for rays in doubt.
void ask(const Blockers& exact, const glm::vec3& origin, const DirectionPatch& patch,
         std::uint64_t doubts, std::uint64_t& rays) {
    for (std::size_t p = 0; doubts != 0 && p < DirectionPatch::NumPackets; ++p) {
        constexpr std::uint64_t PacketBits = 0xffff;
        const auto active = static_cast<std::uint32_t>(doubts >> (p * PacketSize) & PacketBits);
        if (active == 0)
            continue;
        const std::uint64_t blocked = exact.occluded(origin, patch.packets[p], active);
        rays &= ~(blocked << (p * PacketSize));
    }
}

/// A word for each receiver with a bit per direction; or, for each 64 receivers, a word for each
/// direction with a bit per receiver.
using RayWords = std::array<std::uint64_t, ReceiverGroup::MaxSize>;

/// Turns one form of RayWords into the other.
void transpose_squares(RayWords& words) {
    for (std::size_t first = 0; first < words.size(); first += DirectionPatch::Size)
        transpose(std::span<std::uint64_t, DirectionPatch::Size>(words.data() + first,
                                                                 DirectionPatch::Size));
}

/// With more leaves per ray on average, as for receivers far apart, the exact tracer is faster.
/// Measured.
constexpr std::size_t LeavesPerRay = 4;

/// A shaft with so few leaves is not compared with its directions.
constexpr std::size_t FewLeaves = 512;
/// With more leaves for each leaf that a single direction meets, a patch is traced direction by
/// direction. Measured.
constexpr std::size_t LeavesPerDirection = 10;

/// What is asked of a tree: which rays of a group through a patch it blocks.
struct Asked {
    const ReceiverGroup& group;
    const DirectionPatch& patch;
    const PatchPlane& plane;
};

/// Traces one direction after the other, all receivers at once. Where this does not pay, the
/// remaining directions are left in doubt.
void clear_by_direction(const TriangleTree& tree, const Asked& asked, const GroupOrigins& origins,
                        std::span<std::uint64_t> rays, std::span<std::uint64_t> in_doubt) {
    static_assert(std::tuple_size_v<ReceiverBits> * DirectionPatch::Size == ReceiverGroup::MaxSize);
    const DirectionPatch& patch = asked.patch;
    RayWords lit{}, doubts{};
    std::copy(rays.begin(), rays.end(), lit.begin());
    transpose_squares(lit);
    std::size_t num_leaves = 0, num_rays = ReceiverGroup::MaxSize;
    for (std::size_t j = 0; j < patch.num_directions; ++j) {
        ReceiverBits active;
        for (std::size_t word = 0; word < active.size(); ++word)
            active[word] = lit[word * DirectionPatch::Size + j];
        if (active == ReceiverBits{})
            continue;
        if (num_leaves > LeavesPerRay * num_rays) {
            for (std::size_t word = 0; word < active.size(); ++word)
                doubts[word * DirectionPatch::Size + j] = active[word];
            continue;
        }
        const ParallelResult result =
            test_parallel_rays(tree, {patch, asked.plane, j}, origins, active);
        num_leaves += result.num_leaves;
        for (std::size_t word = 0; word < active.size(); ++word) {
            num_rays += static_cast<std::size_t>(std::popcount(active[word]));
            lit[word * DirectionPatch::Size + j] &= ~result.blocked[word];
            doubts[word * DirectionPatch::Size + j] = result.doubtful[word];
        }
    }
    transpose_squares(lit);
    transpose_squares(doubts);
    std::copy_n(lit.begin(), rays.size(), rays.begin());
    std::copy_n(doubts.begin(), rays.size(), in_doubt.begin());
}

/// Returns how many leaves a direction in the middle of a patch meets.
std::size_t leaves_along_middle(const TriangleTree& tree, const Asked& asked,
                                const GroupOrigins& origins, std::span<const std::uint64_t> rays) {
    ReceiverBits active{};
    for (std::size_t i = 0; i < rays.size(); ++i)
        active[i / 64] |= std::uint64_t{rays[i] != 0} << (i % 64);
    return num_leaves_along(tree, {asked.patch, asked.plane, asked.patch.num_directions / 2},
                            origins, active);
}

/// Clears the rays that a tree blocks for certain, and sets `in_doubt` to the remaining rays that
/// it may block. `passed` is as in clear_certain(). False: the exact tracer is faster, and nothing
/// was done.
bool clear_by_tree(const TriangleTree& tree, const PassedTriangles* passed,
                   std::size_t crowded_shaft, const Asked& asked, std::span<std::uint64_t> rays,
                   std::span<std::uint64_t> in_doubt) {
    if (tree.nodes.empty())
        return true;
    const PatchPlane& plane = asked.plane;
    const GroupOrigins origins(asked.group, tree);
    if (!plane.narrow || !(origins.reach < LargestReach))
        return false;
    thread_local ShaftLeaves leaves;
    Shaft shaft = shaft_of(plane, asked.group.mean_normal, origins.reach);
    const ReceiverCones cones = place_shaft(origins, rays, shaft);
    const auto is_crowded = [&](std::size_t most) {
        return !find_leaves(tree, shaft, most, leaves);
    };
    if (is_crowded(std::min(FewLeaves, crowded_shaft)) &&
        is_crowded(std::min(LeavesPerDirection * leaves_along_middle(tree, asked, origins, rays),
                            crowded_shaft))) {
        RayWords before{};
        std::copy(rays.begin(), rays.end(), before.begin());
        clear_by_direction(tree, asked, origins, rays, in_doubt);
        if (passed != nullptr) // it only knows which rays meet a triangle
            for (std::size_t i = 0; i < rays.size(); ++i) {
                in_doubt[i] |= before[i] & ~rays[i];
                rays[i] = before[i];
            }
        return true;
    }
    if (!leaves.found.empty())
        clear_certain(tree, passed, {asked.patch, plane, shaft}, leaves, origins, cones, rays,
                      in_doubt);
    return true;
}

/// Triangles of a mesh, and their numbers there.
struct ChosenTriangles {
    mesh::TriangleMesh mesh;
    std::vector<std::uint32_t> numbers;
};

/// Takes away all vertices without a triangle.
void drop_vertices(mesh::TriangleMesh& mesh) {
    std::vector<std::uint32_t> used;
    for (const mesh::Triangle& triangle : mesh.triangles)
        used.insert(used.end(), triangle.begin(), triangle.end());
    std::ranges::sort(used);
    used.erase(std::unique(used.begin(), used.end()), used.end());
    std::vector<glm::vec3> positions;
    for (const std::uint32_t vertex : used)
        positions.push_back(mesh.positions[vertex]);
    for (mesh::Triangle& triangle : mesh.triangles)
        for (std::uint32_t& vertex : triangle)
            vertex =
                static_cast<std::uint32_t>(std::ranges::lower_bound(used, vertex) - used.begin());
    mesh.positions = std::move(positions);
}

/// Returns the tree of triangles that stop all rays, with flat regions merged: numbers of merged
/// triangles mean nothing.
TriangleTree opaque_tree(const mesh::TriangleMesh& mesh, const std::optional<glm::vec3>& centre) {
    TriangleTree tree = triangle_tree(mesh.positions, mesh::with_flat_regions_merged(mesh), centre);
    tree.triangles = {};
    return tree;
}

} // namespace

struct BeamScene::Trees {
    /// `groups`: the triangles of each group that may move; empty: none does.
    Trees(const mesh::TriangleMesh& mesh, std::shared_ptr<const SeeThrough> passed, RayOf whose,
          std::span<const std::span<const std::uint32_t>> groups)
        : see_through(std::move(passed)), of(whose), lets_pass(mesh::lets_light_pass(mesh)) {
        if (!groups.empty())
            centre = mesh::bounds(mesh).center();
        std::vector<TriangleTree> all_opaque(std::max<std::size_t>(groups.size(), 1)),
            all_some_pass(all_opaque.size());
        files::parallel_for(std::size_t{0}, all_opaque.size(), [&](std::size_t i) {
            if (groups.empty() && !lets_pass)
                all_opaque[i] = opaque_tree(mesh, {});
            else
                find_trees(mesh, groups.empty() ? std::nullopt : std::optional(groups[i]),
                           all_opaque[i], all_some_pass[i]);
        });
        opaque = GroupedTree(std::move(all_opaque));
        some_pass = GroupedTree(std::move(all_some_pass));
    }

    void follow(const mesh::TriangleMesh& mesh, std::uint32_t group,
                std::span<const std::uint32_t> numbers) {
        TriangleTree of_opaque, of_some_pass;
        find_trees(mesh, numbers, of_opaque, of_some_pass);
        opaque.replace(group, of_opaque);
        if (lets_pass)
            some_pass.replace(group, of_some_pass);
    }

    std::shared_ptr<const SeeThrough> see_through;
    RayOf of;
    bool lets_pass;
    /// The middle of all trees, where groups move
    std::optional<glm::vec3> centre;
    /// Trees of the triangles that stop all rays, and of those that stop some of them.
    GroupedTree opaque, some_pass;

private:
    using Numbers = std::optional<std::span<const std::uint32_t>>;

    /// Returns those triangles of some numbers, or of all, that stop all rays, or some.
    [[nodiscard]] ChosenTriangles chosen(const mesh::TriangleMesh& mesh, const Numbers& numbers,
                                         SeeThrough::All all) const {
        ChosenTriangles result;
        result.mesh.positions = mesh.positions;
        const std::size_t count = numbers ? numbers->size() : mesh.num_triangles();
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t number = numbers ? (*numbers)[i] : static_cast<std::uint32_t>(i);
            if (lets_pass && see_through->all_at(number, of) != all)
                continue;
            result.mesh.triangles.push_back(mesh.triangles[number]);
            result.numbers.push_back(number);
        }
        if (numbers)
            drop_vertices(result.mesh);
        return result;
    }

    void find_trees(const mesh::TriangleMesh& mesh, const Numbers& numbers, TriangleTree& stopping,
                    TriangleTree& passing) const {
        stopping = opaque_tree(chosen(mesh, numbers, SeeThrough::All::Stop).mesh, centre);
        if (!lets_pass)
            return;
        const auto [thin, in_mesh] = chosen(mesh, numbers, SeeThrough::All::Differ);
        passing = triangle_tree(thin.positions, thin.triangles, centre);
        for (std::size_t leaf = 0; leaf < passing.leaves.size(); ++leaf)
            for (std::size_t lane = 0; lane < passing.leaves[leaf].size; ++lane) {
                std::uint32_t& number = passing.triangles[leaf][lane];
                number = in_mesh[number];
            }
    }
};

BeamScene::BeamScene(const mesh::TriangleMesh& mesh, const RayScene& exact,
                     std::size_t crowded_shaft)
    : BeamScene(mesh, exact, exact.see_through(), crowded_shaft) {}

BeamScene::BeamScene(const mesh::TriangleMesh& mesh, const Blockers& exact,
                     std::shared_ptr<const SeeThrough> see_through, std::size_t crowded_shaft)
    : exact_(&exact), crowded_shaft_(std::min(crowded_shaft, CrowdedShaft)) {
    std::vector<std::span<const std::uint32_t>> groups;
    if (const RayScene* rays = exact.ray_scene())
        groups = rays->groups();
    trees_ = std::make_unique<Trees>(mesh, see_through, RayOf::Light, groups);
    if (const Blockers* settled = exact.settled())
        settled_.reset(new BeamScene(
            std::make_unique<Trees>(mesh, std::move(see_through), RayOf::SettledLight, groups),
            *settled, crowded_shaft_));
}

BeamScene::BeamScene(std::unique_ptr<Trees> trees, const Blockers& exact, std::size_t crowded_shaft)
    : trees_(std::move(trees)), exact_(&exact), crowded_shaft_(crowded_shaft) {}

BeamScene::~BeamScene() = default;
BeamScene::BeamScene(BeamScene&&) noexcept = default;
BeamScene& BeamScene::operator=(BeamScene&&) noexcept = default;

void BeamScene::follow(const mesh::TriangleMesh& mesh, std::uint32_t group) {
    trees_->follow(mesh, group, exact_->ray_scene()->groups()[group]);
    if (settled_)
        settled_->trees_->follow(mesh, group, exact_->ray_scene()->groups()[group]);
}

std::uint32_t BeamScene::occluded(const glm::vec3& origin, const DirectionPacket& directions,
                                  std::uint32_t active) const {
    return exact_->occluded(origin, directions, active);
}

void BeamScene::clear_blocked(const ReceiverGroup& group, const DirectionPatch& patch,
                              std::span<std::uint64_t> rays) const {
    if (rays.empty())
        return;
    const PatchPlane plane = patch_plane(patch);
    const Asked asked{group, patch, plane};
    RayWords doubts{};
    if (!clear_by_tree(trees_->opaque.tree(), nullptr, crowded_shaft_, asked, rays,
                       std::span(doubts).first(rays.size()))) {
        exact_->clear_blocked(group, patch, rays);
        return;
    }
    if (!trees_->some_pass.tree().nodes.empty()) {
        const PassedTriangles passed{*trees_->see_through, trees_->of};
        RayWords more{};
        if (!clear_by_tree(trees_->some_pass.tree(), &passed, crowded_shaft_, asked, rays,
                           std::span(more).first(rays.size())))
            std::copy(rays.begin(), rays.end(), more.begin());
        for (std::size_t i = 0; i < rays.size(); ++i)
            doubts[i] |= more[i];
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
        ask(*exact_, group.origins[i], patch, doubts[i] & rays[i], rays[i]);
}

} // namespace relumine::prt
