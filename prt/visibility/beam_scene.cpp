#include "prt/visibility/beam_scene.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "mesh/flat_regions.h"
#include "mesh/opacity.h"
#include "prt/visibility/beam_kernels.h"
#include "prt/visibility/bit_matrix.h"
#include "prt/visibility/group_origins.h"
#include "prt/visibility/parallel_rays.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/see_through.h"
#include "prt/visibility/shaft.h"
#include "prt/visibility/shaft_leaves.h"
#include "prt/visibility/triangle_tree.h"

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

/// Returns the triangles of a mesh that stop all rays, or those that stop some of them.
ChosenTriangles chosen_triangles(const mesh::TriangleMesh& mesh, const SeeThrough& see_through,
                                 RayOf of, SeeThrough::All all) {
    ChosenTriangles chosen;
    chosen.mesh.positions = mesh.positions;
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
        if (see_through.all_at(i, of) == all) {
            chosen.mesh.triangles.push_back(mesh.triangles[i]);
            chosen.numbers.push_back(i);
        }
    return chosen;
}

/// Returns the tree of triangles that stop all rays, with flat regions merged: numbers of merged
/// triangles mean nothing.
TriangleTree opaque_tree(const mesh::TriangleMesh& mesh) {
    TriangleTree tree = triangle_tree(mesh.positions, mesh::with_flat_regions_merged(mesh));
    tree.triangles = {};
    return tree;
}

} // namespace

struct BeamScene::Trees {
    Trees(const mesh::TriangleMesh& mesh, std::shared_ptr<const SeeThrough> passed, RayOf whose)
        : see_through(std::move(passed)), of(whose) {
        if (!mesh::lets_light_pass(mesh)) {
            opaque = opaque_tree(mesh);
            return;
        }
        const auto chosen = [&](SeeThrough::All all) {
            return chosen_triangles(mesh, *see_through, of, all);
        };
        opaque = opaque_tree(chosen(SeeThrough::All::Stop).mesh);
        const auto [thin, numbers] = chosen(SeeThrough::All::Differ);
        some_pass = triangle_tree(thin.positions, thin.triangles);
        for (std::size_t leaf = 0; leaf < some_pass.leaves.size(); ++leaf)
            for (std::size_t lane = 0; lane < some_pass.leaves[leaf].size; ++lane) {
                std::uint32_t& number = some_pass.triangles[leaf][lane];
                number = numbers[number];
            }
    }
    std::shared_ptr<const SeeThrough> see_through;
    RayOf of;
    /// Trees of the triangles that stop all rays, and of those that stop some of them.
    TriangleTree opaque, some_pass;
};

BeamScene::BeamScene(const mesh::TriangleMesh& mesh, const RayScene& exact,
                     std::size_t crowded_shaft)
    : BeamScene(mesh, exact, exact.see_through(), crowded_shaft) {}

BeamScene::BeamScene(const mesh::TriangleMesh& mesh, const Blockers& exact,
                     std::shared_ptr<const SeeThrough> see_through, std::size_t crowded_shaft)
    : trees_(std::make_unique<const Trees>(mesh, see_through, RayOf::Light)), exact_(&exact),
      crowded_shaft_(std::min(crowded_shaft, CrowdedShaft)) {
    if (const Blockers* settled = exact.settled())
        settled_.reset(new BeamScene(
            std::make_unique<const Trees>(mesh, std::move(see_through), RayOf::SettledLight),
            *settled, crowded_shaft_));
}

BeamScene::BeamScene(std::unique_ptr<const Trees> trees, const Blockers& exact,
                     std::size_t crowded_shaft)
    : trees_(std::move(trees)), exact_(&exact), crowded_shaft_(crowded_shaft) {}

BeamScene::~BeamScene() = default;
BeamScene::BeamScene(BeamScene&&) noexcept = default;
BeamScene& BeamScene::operator=(BeamScene&&) noexcept = default;

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
    if (!clear_by_tree(trees_->opaque, nullptr, crowded_shaft_, asked, rays,
                       std::span(doubts).first(rays.size()))) {
        exact_->clear_blocked(group, patch, rays);
        return;
    }
    if (!trees_->some_pass.nodes.empty()) {
        const PassedTriangles passed{*trees_->see_through, trees_->of};
        RayWords more{};
        if (!clear_by_tree(trees_->some_pass, &passed, crowded_shaft_, asked, rays,
                           std::span(more).first(rays.size())))
            std::copy(rays.begin(), rays.end(), more.begin());
        for (std::size_t i = 0; i < rays.size(); ++i)
            doubts[i] |= more[i];
    }
    for (std::size_t i = 0; i < rays.size(); ++i)
        ask(*exact_, group.origins[i], patch, doubts[i] & rays[i], rays[i]);
}

} // namespace relumine::prt
