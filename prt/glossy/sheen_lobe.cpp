#include "prt/glossy/sheen_lobe.h"

#include <cstddef>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/knot_table.h"

namespace relumine::prt {

namespace {

/// SheenKnots of the table for each of its sides: even in roughness and in the square root of the
/// cosine.
constexpr std::size_t SheenKnots = 32;
/// Samples of an integral: rings of equal height, and steps of half a turn.
constexpr int SheenRings = 40, SheenSpokes = 20;

float integrated_sheen(float roughness, float n_v) {
    const glm::vec3 v(std::sqrt(std::max(1.0f - n_v * n_v, 0.0f)), 0.0f, n_v);
    double sum = 0.0;
    // Dense at the horizon, where smooth fibres send their light.
    for (int i = 0; i < SheenRings; ++i)
        for (int j = 0; j < SheenSpokes; ++j) {
            const double t = (i + 0.5) / SheenRings;
            const auto z = static_cast<float>(t * t);
            const double phi = std::numbers::pi * (j + 0.5) / SheenSpokes;
            const float across = std::sqrt(std::max(1.0f - z * z, 0.0f));
            const glm::vec3 w(across * static_cast<float>(std::cos(phi)),
                              across * static_cast<float>(std::sin(phi)), z);
            const glm::vec3 h = v + w;
            const float sin2 = (h.x * h.x + h.y * h.y) / std::max(glm::dot(h, h), 1e-12f);
            sum += 2.0 * t * double{SheenLobe::unlimited(roughness, {z, n_v, sin2})};
        }
    return static_cast<float>(sum * 2.0 * std::numbers::pi / (SheenRings * SheenSpokes));
}

class SheenTable {
public:
    SheenTable() {
        for (std::size_t row = 0; row < SheenKnots; ++row)
            for (std::size_t column = 0; column < SheenKnots; ++column) {
                const float place = std::max(
                    static_cast<float>(column) / static_cast<float>(SheenKnots - 1), 0.02f);
                knots_[row][column] = integrated_sheen(
                    static_cast<float>(row) / static_cast<float>(SheenKnots - 1), place * place);
            }
    }

    [[nodiscard]] float at(float roughness, float n_v) const {
        return KnotPlace(SheenKnots, roughness, n_v).between([&](std::size_t r, std::size_t c) {
            return knots_[r][c];
        });
    }

private:
    std::array<std::array<float, SheenKnots>, SheenKnots> knots_{};
};

float from_table(float roughness, float n_v) {
    static const SheenTable table;
    return table.at(roughness, n_v);
}

} // namespace

float sheen_albedo(float roughness, float n_v) {
    return std::min(from_table(roughness, n_v), 1.0f);
}

float sheen_limit(float roughness, float n_v) {
    return 1.0f / std::max(from_table(roughness, n_v), 1.0f);
}

float SheenLobe::value(float roughness, const LobeGeometry& at) {
    return sheen_limit(roughness, at.n_v) * unlimited(roughness, at);
}

} // namespace relumine::prt
