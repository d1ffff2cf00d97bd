#include "relight/moving_eye/seen_blocks.h"

#include <algorithm>
#include <limits>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"
#include "prt/bounces/point_rows.h"

namespace relumine::relight {

namespace {

/// Planes around all receivers, spread evenly: an eye that is not outside of one, as one that looks
/// into a valley, has all that faces it lit.
constexpr std::uint32_t NumPlanes = 96;
constexpr std::size_t BlocksPerTask = 64;

/// A square of a cell, [0, 1]^2.
struct Square {
    float s0, t0, s1, t1;
};

/// Whether a block sees something within a square of a cell.
bool sees_some(const VisibilityPyramid& visibility, std::size_t block,
               const VisibilityPyramid::Place& place, const Square& square) {
    using Kind = VisibilityPyramid::Kind;
    if (place.kind() != Kind::Branch && place.kind() != Kind::Quad)
        return place.kind() != Kind::Hidden;
    const VisibilityPyramid::Sights seen = visibility.sights(place);
    for (std::uint32_t i = 0; i < 4; ++i) {
        const float s = 0.5f * static_cast<float>(i & 1u), t = 0.5f * static_cast<float>(i >> 1u);
        if (((seen.visible | seen.mixed) >> i & 1u) == 0 || square.s0 > s + 0.5f || square.s1 < s ||
            square.t0 > t + 0.5f || square.t1 < t)
            continue;
        if ((seen.visible >> i & 1u) != 0 ||
            sees_some(visibility, block, visibility.child(block, place, seen, i),
                      {2.0f * (square.s0 - s), 2.0f * (square.t0 - t), 2.0f * (square.s1 - s),
                       2.0f * (square.t1 - t)}))
            return true;
    }
    return false;
}

} // namespace

SeenBlocks::SeenBlocks(const prt::Transfer& transfer, const VisibilityPyramid& visibility,
                       std::span<const glm::vec3> positions, std::span<const Triangle> triangles)
    : transfer_(transfer), visibility_(visibility), positions_(positions),
      spheres_(transfer.counts.num_blocks()), seen_(spheres_.size()), needed_(spheres_.size()) {
    for (std::size_t block = 0; block < spheres_.size(); ++block) {
        const auto own =
            positions.subspan(block * prt::BlockSize,
                              std::min(prt::BlockSize, positions.size() - block * prt::BlockSize));
        glm::vec3 low = own[0], high = own[0];
        for (const glm::vec3& position : own) {
            low = glm::min(low, position);
            high = glm::max(high, position);
        }
        Sphere& sphere = spheres_[block];
        sphere.middle = 0.5f * (low + high);
        for (const glm::vec3& position : own)
            sphere.radius = std::max(sphere.radius, glm::distance(sphere.middle, position));
    }
    for (const glm::dvec3& direction : prt::even_directions(NumPlanes)) {
        const glm::vec3 normal(direction);
        float farthest = std::numeric_limits<float>::lowest();
        for (const glm::vec3& position : positions)
            farthest = std::max(farthest, glm::dot(normal, position));
        hull_.emplace_back(normal, -farthest);
    }
    find_neighbours(triangles);
}

void SeenBlocks::find_neighbours(std::span<const Triangle> triangles) {
    std::vector<std::uint32_t> block_of(positions_.size());
    for (std::size_t place = 0; place < positions_.size(); ++place)
        block_of[transfer_.order[place]] = static_cast<std::uint32_t>(place / prt::BlockSize);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (const Triangle& triangle : triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::uint32_t a = block_of[triangle[i]], b = block_of[triangle[(i + 1) % 3]];
            if (a != b) {
                pairs.emplace_back(a, b);
                pairs.emplace_back(b, a);
            }
        }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    first_.assign(spheres_.size() + 1, 0);
    for (const auto& [block, neighbour] : pairs) {
        ++first_[block + 1];
        neighbours_.push_back(neighbour);
    }
    for (std::size_t block = 0; block < spheres_.size(); ++block)
        first_[block + 1] += first_[block];
}

bool SeenBlocks::is_outside(const glm::vec3& eye) const {
    return std::any_of(hull_.begin(), hull_.end(), [&](const glm::vec4& plane) {
        return glm::dot(glm::vec3(plane), eye) + plane.w > 0.0f;
    });
}

bool SeenBlocks::faces(std::size_t block, const glm::vec3& eye) const {
    const std::size_t first = block * prt::BlockSize;
    const std::size_t end = std::min(first + prt::BlockSize, positions_.size());
    for (std::size_t i = first; i < end; ++i)
        if (glm::dot(transfer_.normals[i], eye - positions_[i]) > 0.0f)
            return true;
    return false;
}

/// Looks at all directions in which the eye may be from the block's sphere.
bool SeenBlocks::sees(std::size_t block, const glm::vec3& eye) const {
    const glm::vec3 ray = eye - spheres_[block].middle;
    const float length = glm::length(ray);
    if (!(length > 2.0f * spheres_[block].radius))
        return true;
    const cubemap::FacePoint at = cubemap::face_point(glm::dvec3(ray));
    const auto s = static_cast<float>(at.s), t = static_cast<float>(at.t);
    // A direction that turns by an angle moves by so many times it at most, 2 in u or v being 1 in
    // s or t.
    const float u = 2.0f * s - 1.0f, v = 2.0f * t - 1.0f;
    const float reach = 0.75f * (1.0f + u * u + v * v) * spheres_[block].radius / length;
    const Square square{s - reach, t - reach, s + reach, t + reach};
    if (square.s0 < 0.0f || square.t0 < 0.0f || square.s1 > 1.0f || square.t1 > 1.0f)
        return true;
    return sees_some(visibility_, block,
                     visibility_.face(block, static_cast<std::uint32_t>(at.face)), square);
}

std::span<const std::uint8_t> SeenBlocks::find(const glm::vec3& eye,
                                               std::span<const glm::vec4> sides) {
    const bool outside = is_outside(eye);
    const auto is_inside = [&](std::size_t block) {
        return std::all_of(sides.begin(), sides.end(), [&](const glm::vec4& side) {
            return glm::dot(glm::vec3(side), spheres_[block].middle) + side.w >=
                   -spheres_[block].radius * glm::length(glm::vec3(side));
        });
    };
    const auto for_blocks = [&](const auto& work) {
        files::parallel_for(files::IndexRange<std::size_t>(0, spheres_.size(), BlocksPerTask),
                            [&](const auto& some) {
                                for (std::size_t block = some.begin(); block < some.end(); ++block)
                                    work(block);
                            });
    };
    constexpr std::uint8_t Faces = 1, Seen = 2;
    for_blocks([&](std::size_t block) {
        seen_[block] = !faces(block, eye)                                   ? 0
                       : is_inside(block) && (!outside || sees(block, eye)) ? Faces | Seen
                                                                            : Faces;
    });
    for_blocks([&](std::size_t block) {
        const auto neighbours =
            std::span(neighbours_).subspan(first_[block], first_[block + 1] - first_[block]);
        const bool is_needed =
            (seen_[block] & Seen) != 0 ||
            ((seen_[block] & Faces) != 0 &&
             std::any_of(neighbours.begin(), neighbours.end(),
                         [&](std::uint32_t other) { return (seen_[other] & Seen) != 0; }));
        needed_[block] = is_needed ? 1 : 0;
    });
    return needed_;
}

} // namespace relumine::relight
