#include "relight/visible_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include <glm/geometric.hpp>

#include "cubemap/face.h"
#include "files/parallel.h"

namespace relumine::relight {

namespace {

using Lanes = std::array<float, prt::BlockSize>;

/// Samples of a cone. A cone of ten degrees holds a dozen clusters of the usual width.
constexpr std::uint32_t NumSamples = 64;

/// What lies below the horizon keeps so much of a weight, so that cones below it have a mean, too.
constexpr float LeastCosine = 0.02f;

/// Returns direction i of a spiral that covers a cone evenly.
glm::vec3 sample(const glm::vec3& axis, float radius, std::uint32_t i) {
    const float part = (static_cast<float>(i) + 0.5f) / static_cast<float>(NumSamples);
    const float cosine = 1.0f - part * (1.0f - std::cos(radius));
    const float sine = std::sqrt(std::max(1.0f - cosine * cosine, 0.0f));
    const float turn = static_cast<float>(i) * std::numbers::pi_v<float> * (3.0f - std::sqrt(5.0f));
    const glm::vec3 other =
        std::abs(axis.y) < 0.9f ? glm::vec3(0.0f, 1.0f, 0.0f) : glm::vec3(1.0f, 0.0f, 0.0f);
    const glm::vec3 right = glm::normalize(glm::cross(axis, other));
    return cosine * axis +
           sine * (std::cos(turn) * right + std::sin(turn) * glm::cross(axis, right));
}

} // namespace

VisibleParts::VisibleParts(const prt::Transfer& transfer, std::span<const glm::vec3> directions,
                           float radius)
    : transfer_(transfer), sine_of_radius_(std::sin(radius)) {
    if (!(radius >= 0.0f && radius <= 0.5f * std::numbers::pi_v<float>))
        throw std::invalid_argument("radius: expected 0 to pi / 2");
    for (const glm::vec3& direction : directions) {
        const float length = glm::length(direction);
        if (!(std::isfinite(length) && length > 0.0f))
            throw std::invalid_argument("directions: expected vectors with a length");
        const glm::vec3& axis = directions_.emplace_back(direction / length);
        std::map<std::uint32_t, std::uint32_t> samples;
        for (std::uint32_t i = 0; i < NumSamples; ++i)
            ++samples[transfer.quadtree.leaf_at(cubemap::face_point(sample(axis, radius, i)))];
        std::vector<Share>& cone = cones_.emplace_back();
        for (const auto& [leaf, count] : samples)
            cone.push_back({leaf, static_cast<float>(count)});
    }
    for (const prt::Cell& leaf : transfer.quadtree.leaves()) {
        const double size = leaf.size();
        middles_.push_back(
            cubemap::direction(leaf.face, (leaf.x + 0.5) * size, (leaf.y + 0.5) * size));
    }
}

/// What the receivers of one block see.
class VisibleParts::Block {
public:
    Block(const VisibleParts& own, std::size_t block)
        : own_(own), counts_(own.transfer_.counts), block_(block), first_(block * prt::BlockSize),
          size_(std::min(prt::BlockSize, own.transfer_.num_receivers() - first_)) {}

    /// Returns the parts of a cone.
    [[nodiscard]] std::array<std::uint8_t, prt::BlockSize> parts(std::size_t direction) const {
        std::array<std::uint8_t, prt::BlockSize> result{};
        if (is_below(own_.directions_[direction]))
            return result;
        const std::vector<Share>& cone = own_.cones_[direction];
        const auto is_visible = [&](const Share& share) {
            return bit(counts_.visible, share);
        };
        const auto is_mixed = [&](const Share& share) {
            return bit(counts_.mixed, share);
        };
        if (std::all_of(cone.begin(), cone.end(), is_visible)) {
            result.fill(255);
            return result;
        }
        if (std::none_of(cone.begin(), cone.end(),
                         [&](const Share& share) { return is_visible(share) || is_mixed(share); }))
            return result;
        Lanes seen{}, all{};
        for (const Share& share : cone)
            add(share, seen, all);
        for (std::size_t i = 0; i < size_; ++i)
            result[i] =
                static_cast<std::uint8_t>(std::min(255.0f * seen[i] / all[i] + 0.5f, 255.0f));
        return result;
    }

    [[nodiscard]] std::size_t size() const { return size_; }

private:
    [[nodiscard]] bool bit(const std::vector<std::uint64_t>& bits, const Share& share) const {
        return (bits[counts_.word(block_, share.leaf / 64)] >> share.leaf % 64 & 1u) != 0;
    }

    /// Whether a cone is below the horizon of all receivers.
    [[nodiscard]] bool is_below(const glm::vec3& axis) const {
        for (std::size_t i = 0; i < size_; ++i)
            if (first_ + i < own_.transfer_.num_points ||
                glm::dot(own_.transfer_.normals[first_ + i], axis) > -own_.sine_of_radius_)
                return false;
        return true;
    }

    void add(const Share& share, Lanes& seen, Lanes& all) const {
        const std::size_t word = counts_.word(block_, share.leaf / 64);
        const bool is_mixed = bit(counts_.mixed, share);
        const std::uint8_t* mixed =
            is_mixed ? counts_.mixed_counts(word, share.leaf % 64) : nullptr;
        const float even = bit(counts_.visible, share) ? 1.0f : 0.0f;
        for (std::size_t i = 0; i < size_; ++i) {
            const std::size_t place = first_ + i;
            const float cosine =
                place < own_.transfer_.num_points
                    ? 1.0f
                    : glm::dot(own_.transfer_.normals[place], own_.middles_[share.leaf]);
            const float weight = share.weight * std::max(cosine, LeastCosine);
            all[i] += weight;
            seen[i] += weight * (is_mixed ? static_cast<float>(mixed[i]) / 16.0f : even);
        }
    }

    const VisibleParts& own_;
    const prt::VisibleCounts& counts_;
    std::size_t block_, first_, size_;
};

void VisibleParts::find(std::span<std::uint8_t> parts) const {
    const std::size_t stride = num_directions();
    if (stride == 0 || parts.size() % stride != 0 ||
        parts.size() / stride > transfer_.num_receivers())
        throw std::invalid_argument("expected a part for each receiver and direction");
    constexpr std::size_t Grain = 16;
    files::parallel_for(files::IndexRange<std::size_t>(0, transfer_.counts.num_blocks(), Grain),
                        [&](const auto& some) {
                            for (std::size_t b = some.begin(); b < some.end(); ++b) {
                                const Block block(*this, b);
                                for (std::size_t direction = 0; direction < stride; ++direction) {
                                    const auto of_lanes = block.parts(direction);
                                    for (std::size_t i = 0; i < block.size(); ++i) {
                                        const std::size_t at =
                                            transfer_.order[b * prt::BlockSize + i] * stride +
                                            direction;
                                        if (at < parts.size())
                                            parts[at] = of_lanes[i];
                                    }
                                }
                            }
                        });
}

} // namespace relumine::relight
