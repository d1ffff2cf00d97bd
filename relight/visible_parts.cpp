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
        Cone& cone = cones_.emplace_back();
        for (const auto& [leaf, count] : samples) {
            cone.shares.push_back({leaf, static_cast<float>(count)});
            if (cone.words.empty() || cone.words.back().index != leaf / 64)
                cone.words.push_back({leaf / 64, 0});
            cone.words.back().leaves |= std::uint64_t{1} << leaf % 64;
        }
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
          size_(std::min(prt::BlockSize, own.transfer_.num_receivers() - first_)) {
        for (std::size_t i = 0; i < size_; ++i) {
            // A point without a surface sees all directions alike.
            const bool is_point = first_ + i < own.transfer_.num_points;
            const glm::vec3 normal = is_point ? glm::vec3(0.0f) : own.transfer_.normals[first_ + i];
            x_[i] = normal.x;
            y_[i] = normal.y;
            z_[i] = normal.z;
            even_[i] = is_point ? 1.0f : 0.0f;
        }
    }

    [[nodiscard]] std::size_t size() const { return size_; }

    /// Returns the parts of a cone.
    [[nodiscard]] std::array<std::uint8_t, prt::BlockSize> parts(std::size_t direction) const {
        std::array<std::uint8_t, prt::BlockSize> result{};
        if (is_below(own_.directions_[direction]))
            return result;
        const Cone& cone = own_.cones_[direction];
        bool all_visible = true, none_visible = true;
        for (const Word& word : cone.words) {
            const std::size_t at = counts_.word(block_, word.index);
            all_visible &= (word.leaves & ~counts_.visible[at]) == 0;
            none_visible &= (word.leaves & (counts_.visible[at] | counts_.mixed[at])) == 0;
        }
        if (all_visible)
            result.fill(255);
        if (all_visible || none_visible)
            return result;
        Lanes seen{}, all{};
        for (const Share& share : cone.shares)
            add(share, seen, all);
        for (std::size_t i = 0; i < size_; ++i)
            result[i] =
                static_cast<std::uint8_t>(std::min(255.0f * seen[i] / all[i] + 0.5f, 255.0f));
        return result;
    }

private:
    [[nodiscard]] Lanes cosines(const glm::vec3& direction) const {
        Lanes result;
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            result[i] = x_[i] * direction.x + y_[i] * direction.y + z_[i] * direction.z + even_[i];
        return result;
    }

    /// Whether a cone is below the horizon of all receivers.
    [[nodiscard]] bool is_below(const glm::vec3& axis) const {
        const Lanes above = cosines(axis);
        return std::none_of(above.begin(), above.begin() + static_cast<std::ptrdiff_t>(size_),
                            [&](float cosine) { return cosine > -own_.sine_of_radius_; });
    }

    void add(const Share& share, Lanes& seen, Lanes& all) const {
        Lanes weights = cosines(own_.middles_[share.leaf]);
        for (float& weight : weights)
            weight = share.weight * std::max(weight, LeastCosine);
        for (std::size_t i = 0; i < prt::BlockSize; ++i)
            all[i] += weights[i];
        const std::size_t word = counts_.word(block_, share.leaf / 64);
        const std::uint32_t bit = share.leaf % 64;
        if ((counts_.mixed[word] >> bit & 1u) != 0) {
            const std::uint8_t* mixed = counts_.mixed_counts(word, bit);
            for (std::size_t i = 0; i < prt::BlockSize; ++i)
                seen[i] += weights[i] * static_cast<float>(mixed[i]) * (1.0f / 16.0f);
        } else if ((counts_.visible[word] >> bit & 1u) != 0) {
            for (std::size_t i = 0; i < prt::BlockSize; ++i)
                seen[i] += weights[i];
        }
    }

    const VisibleParts& own_;
    const prt::VisibleCounts& counts_;
    std::size_t block_, first_, size_;
    /// Normals; and what is added to their cosines.
    Lanes x_{}, y_{}, z_{}, even_{};
};

void VisibleParts::find(std::span<std::uint8_t> parts) const {
    const std::size_t stride = num_directions();
    if (stride == 0 || parts.size() % stride != 0 ||
        parts.size() / stride > transfer_.num_receivers())
        throw std::invalid_argument("expected as many parts as directions for each receiver");
    const std::size_t num_asked = parts.size() / stride;
    constexpr std::size_t Grain = 16;
    files::parallel_for(
        files::IndexRange<std::size_t>(0, transfer_.counts.num_blocks(), Grain),
        [&](const auto& some) {
            for (std::size_t b = some.begin(); b < some.end(); ++b) {
                const Block block(*this, b);
                const std::span<const std::uint32_t> receivers =
                    std::span(transfer_.order).subspan(b * prt::BlockSize, block.size());
                if (std::none_of(receivers.begin(), receivers.end(),
                                 [&](std::uint32_t receiver) { return receiver < num_asked; }))
                    continue;
                for (std::size_t direction = 0; direction < stride; ++direction) {
                    const auto of_lanes = block.parts(direction);
                    for (std::size_t i = 0; i < block.size(); ++i)
                        if (receivers[i] < num_asked)
                            parts[receivers[i] * stride + direction] = of_lanes[i];
                }
            }
        });
}

} // namespace relumine::relight
