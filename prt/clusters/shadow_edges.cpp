#include "prt/clusters/shadow_edges.h"

#include <cmath>
#include <numbers>

namespace relumine::prt {

namespace {

/// Points of the cells of two levels: 5 x 5.
constexpr std::size_t Side = 5;
using Points = std::array<std::array<bool, Side>, Side>;

/// Returns the count of the child whose first point is (x, y).
std::uint8_t count_of(const Points& lit, std::size_t x, std::size_t y) {
    std::uint8_t count = 0;
    for (std::size_t l = 0; l < SamplesPerCell; ++l)
        if (lit[y + l / 3][x + l % 3])
            count = static_cast<std::uint8_t>(count + SampleWeights[l]);
    return count;
}

} // namespace

ShadowEdges::ShadowEdges() : entries_(Counts * Counts * Counts * Counts) {
    // Fine enough that the chances change by less than 0.01 with twice as many of each.
    constexpr int Angles = 360, Offsets = 200;
    std::vector<int> lines;
    std::array<float, Counts> num_corners{};
    for (int a = 0; a < Angles; ++a)
        for (int o = 0; o < Offsets; ++o) {
            const double angle = 2.0 * std::numbers::pi * (a + 0.5) / Angles;
            const double offset = 2.0 * std::numbers::sqrt2 * (2.0 * (o + 0.5) / Offsets - 1.0);
            Points lit{};
            for (std::size_t y = 0; y < Side; ++y)
                for (std::size_t x = 0; x < Side; ++x)
                    lit[y][x] = (static_cast<double>(x) - 2.0) * std::cos(angle) +
                                    (static_cast<double>(y) - 2.0) * std::sin(angle) >
                                offset;
            std::array<std::uint8_t, 4> children;
            for (std::size_t child = 0; child < 4; ++child) {
                const std::size_t x = 2 * (child % 2), y = 2 * (child / 2);
                const std::uint8_t count = children[child] = count_of(lit, x, y);
                num_corners[count] += 4.0f;
                for (const std::size_t corner : {0u, 2u, 6u, 8u})
                    corners_[count] += lit[y + corner / 3][x + corner % 3] ? 1.0f : 0.0f;
            }
            std::uint16_t& entry = entries_[key(children)];
            if (entry == 0) {
                chances_.emplace_back();
                lines.push_back(0);
                entry = static_cast<std::uint16_t>(chances_.size());
            }
            ++lines[entry - 1u];
            for (std::size_t l = 0; l < SamplesPerCell; ++l)
                chances_[entry - 1u][l] += lit[2 * (l / 3)][2 * (l % 3)] ? 1.0f : 0.0f;
        }
    for (std::size_t entry = 0; entry < chances_.size(); ++entry)
        for (float& chance : chances_[entry])
            chance /= static_cast<float>(lines[entry]);
    for (std::size_t count = 0; count < Counts; ++count) // some counts no line makes
        corners_[count] = num_corners[count] > 0.0f ? corners_[count] / num_corners[count]
                                                    : static_cast<float>(count) / FullCount;
}

} // namespace relumine::prt
