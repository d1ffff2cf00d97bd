#include "prt/glossy/ggx_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/knot_table.h"

namespace relumine::prt {

namespace {

/// Knots of the table for each of its sides. The roughness is even; the cosine is the square of
/// what is even, since the integrals change fast at grazing views.
constexpr std::size_t Knots = 32;
/// Samples of an integral.
constexpr int Rings = 64, Spokes = 16;

/// Lambda of Smith's masking for a cosine.
double smith(double cosine, double alpha2) {
    const double c2 = std::max(cosine * cosine, 1e-14);
    return 0.5 * (std::sqrt(1.0 + alpha2 * (1.0 - c2) / c2) - 1.0);
}

/// Integrates with samples of the normals that the eye sees [Heitz]: what is left is G2 / G1.
GgxAlbedo integrated(double roughness, double n_v) {
    const double alpha = double{ggx_alpha(static_cast<float>(roughness))};
    const glm::dvec3 v(std::sqrt(std::max(1.0 - n_v * n_v, 0.0)), 0.0, n_v);
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * v.x, 0.0, v.z));
    const glm::dvec3 t1(0.0, 1.0, 0.0), t2 = glm::cross(stretched, t1);
    const double lambda_v = smith(n_v, alpha * alpha);
    double all = 0.0, grazing = 0.0, weights = 0.0;
    // The lobe is the same on both sides: half of the disc is enough. Samples are dense at its rim,
    // where the few steep normals are that decide over rays at the horizon.
    for (int i = 0; i < Rings; ++i)
        for (int j = 0; j < Spokes; ++j) {
            const double rest = 1.0 - (i + 0.5) / Rings, weight = rest * rest;
            const double r = std::sqrt(1.0 - rest * rest * rest);
            const double phi = std::numbers::pi * ((j + 0.5) / Spokes - 0.5);
            weights += weight;
            const double x = r * std::cos(phi), s = 0.5 * (1.0 + stretched.z);
            const double y = (1.0 - s) * std::sqrt(1.0 - x * x) + s * r * std::sin(phi);
            const glm::dvec3 n =
                x * t1 + y * t2 + std::sqrt(std::max(1.0 - x * x - y * y, 0.0)) * stretched;
            const glm::dvec3 h =
                glm::normalize(glm::dvec3(alpha * n.x, alpha * n.y, std::max(n.z, 0.0)));
            const double v_h = glm::dot(v, h);
            const double n_w = 2.0 * v_h * h.z - v.z;
            if (!(n_w > 0.0))
                continue;
            const double value =
                weight * (1.0 + lambda_v) / (1.0 + lambda_v + smith(n_w, alpha * alpha));
            all += value;
            const double c = std::clamp(1.0 - v_h, 0.0, 1.0);
            grazing += value * (c * c) * (c * c) * c;
        }
    return {static_cast<float>(all / weights), static_cast<float>(grazing / weights)};
}

class Table {
public:
    Table() {
        // Not in parallel: threads that wait for others would take work that asks for the table.
        for (std::size_t row = 0; row < Knots; ++row)
            for (std::size_t column = 0; column < Knots; ++column) {
                const double place = std::max(static_cast<double>(column) / (Knots - 1), 0.01);
                knots_[row][column] =
                    integrated(static_cast<double>(row) / (Knots - 1), place * place);
            }
    }

    [[nodiscard]] GgxAlbedo at(float roughness, float n_v) const {
        const KnotPlace place(Knots, roughness, n_v);
        const auto between = [&](auto part) {
            return place.between([&](std::size_t r, std::size_t c) { return knots_[r][c].*part; });
        };
        return {between(&GgxAlbedo::all), between(&GgxAlbedo::grazing)};
    }

private:
    std::array<std::array<GgxAlbedo, Knots>, Knots> knots_{};
};

} // namespace

GgxAlbedo ggx_albedo(float roughness, float n_v) {
    static const Table table;
    return table.at(roughness, n_v);
}

} // namespace relumine::prt
