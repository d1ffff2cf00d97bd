#include "prt/glossy/ggx_energy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "prt/glossy/ggx_lobe.h"
#include "prt/glossy/knot_table.h"
#include "prt/glossy/stretched_lobe.h"

namespace relumine::prt {

namespace {

/// Knots of the table for each of its sides. The roughness is even; the cosine is the square of
/// what is even, since the integrals change fast at grazing views.
constexpr std::size_t Knots = 32;

/// Lambda of Smith's masking for a cosine.
double smith(double cosine, double alpha2) {
    const double c2 = std::max(cosine * cosine, 1e-14);
    return 0.5 * (std::sqrt(1.0 + alpha2 * (1.0 - c2) / c2) - 1.0);
}

/// A lobe that is as rough in all directions.
struct RoundShape {
    double alpha;
    [[nodiscard]] glm::dvec3 widened(const glm::dvec3& v) const {
        return {alpha * v.x, alpha * v.y, v.z};
    }
    [[nodiscard]] double lambda(const glm::dvec3& w) const { return smith(w.z, alpha * alpha); }
};

/// A lobe of two roughnesses.
struct StretchedShape {
    double along, across;
    [[nodiscard]] glm::dvec3 widened(const glm::dvec3& v) const {
        return {along * v.x, across * v.y, v.z};
    }
    [[nodiscard]] double lambda(const glm::dvec3& w) const {
        const double x = along * w.x, y = across * w.y;
        return 0.5 * (std::sqrt(1.0 + (x * x + y * y) / std::max(w.z * w.z, 1e-14)) - 1.0);
    }
};

/// Which samples an integral takes: rings of a disc, and spokes over a part of the turn.
struct DiscSamples {
    int rings, spokes;
    double turn;
};

/// Samples the normals that the eye sees [Heitz]. Calls use(cosine between eye and normal, weight,
/// weight times the part of the light that leaves, G2 / G1).
template<typename Shape, typename Use>
void for_facets(const Shape& shape, const glm::dvec3& v, const DiscSamples& samples,
                const Use& use) {
    const glm::dvec3 stretched = glm::normalize(shape.widened(v));
    const glm::dvec3 flat(-stretched.y, stretched.x, 0.0);
    const double length = glm::length(flat);
    const glm::dvec3 t1 = length > 0.0 ? flat / length : glm::dvec3(0.0, 1.0, 0.0);
    const glm::dvec3 t2 = glm::cross(stretched, t1);
    const double lambda_v = shape.lambda(v);
    // Samples are dense at the disc's rim, where the few steep normals are that decide over rays at
    // the horizon.
    for (int i = 0; i < samples.rings; ++i)
        for (int j = 0; j < samples.spokes; ++j) {
            const double rest = 1.0 - (i + 0.5) / samples.rings, weight = rest * rest;
            const double r = std::sqrt(1.0 - rest * rest * rest);
            const double phi = samples.turn * ((j + 0.5) / samples.spokes - 0.5);
            const double x = r * std::cos(phi), s = 0.5 * (1.0 + stretched.z);
            const double y = (1.0 - s) * std::sqrt(1.0 - x * x) + s * r * std::sin(phi);
            const glm::dvec3 n =
                x * t1 + y * t2 + std::sqrt(std::max(1.0 - x * x - y * y, 0.0)) * stretched;
            const glm::dvec3 h =
                glm::normalize(shape.widened(glm::dvec3(n.x, n.y, std::max(n.z, 0.0))));
            const double v_h = glm::dot(v, h);
            const glm::dvec3 w = 2.0 * v_h * h - v;
            const double left =
                w.z > 0.0 ? weight * (1.0 + lambda_v) / (1.0 + lambda_v + shape.lambda(w)) : 0.0;
            use(v_h, weight, left);
        }
}

/// The eye at an azimuth.
glm::dvec3 eye_at(double n_v, double azimuth = 0.0) {
    const double across = std::sqrt(std::max(1.0 - n_v * n_v, 0.0));
    return {across * std::cos(azimuth), across * std::sin(azimuth), n_v};
}

RoundShape round_shape(double roughness) {
    return {double{ggx_alpha(static_cast<float>(roughness))}};
}

template<typename Shape>
GgxAlbedo integrated(const Shape& shape, const glm::dvec3& v, const DiscSamples& samples) {
    double all = 0.0, grazing = 0.0, weights = 0.0;
    for_facets(shape, v, samples, [&](double v_h, double weight, double value) {
        weights += weight;
        if (!(value > 0.0))
            return;
        all += value;
        const double c = std::clamp(1.0 - v_h, 0.0, 1.0);
        grazing += value * (c * c) * (c * c) * c;
    });
    return {static_cast<float>(all / weights), static_cast<float>(grazing / weights)};
}

class Table {
public:
    Table() {
        // Not in parallel: threads that wait for others would take work that asks for the table.
        for (std::size_t row = 0; row < Knots; ++row)
            for (std::size_t column = 0; column < Knots; ++column) {
                const double place = std::max(static_cast<double>(column) / (Knots - 1), 0.01);
                // The lobe is the same on both sides: half of the disc is enough.
                knots_[row][column] =
                    integrated(round_shape(static_cast<double>(row) / (Knots - 1)),
                               eye_at(place * place), {64, 16, std::numbers::pi});
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

/// The integrals of stretched lobes. Knots are even in roughness, anisotropy, the angle between
/// tangent and eye, and the square root of the cosine.
class StretchedTable {
public:
    StretchedTable() {
        knots_.reserve(Roughnesses * Anisotropies * Azimuths * Cosines);
        const auto even = [](std::size_t i, std::size_t count) {
            return static_cast<double>(i) / static_cast<double>(count - 1);
        };
        for (std::size_t r = 0; r < Roughnesses; ++r)
            for (std::size_t a = 0; a < Anisotropies; ++a)
                for (std::size_t k = 0; k < Azimuths; ++k)
                    for (std::size_t c = 0; c < Cosines; ++c) {
                        const auto roughness = static_cast<float>(even(r, Roughnesses));
                        const auto anisotropy = static_cast<float>(even(a, Anisotropies));
                        const double place = std::max(even(c, Cosines), 0.01);
                        knots_.push_back(integrated(
                            StretchedShape{double{alpha_along(roughness, anisotropy)},
                                           double{ggx_alpha(roughness)}},
                            eye_at(place * place, 0.5 * std::numbers::pi * even(k, Azimuths)),
                            {24, 32, 2.0 * std::numbers::pi}));
                    }
    }

    [[nodiscard]] GgxAlbedo at(const Surface& surface, const EyeCosines& n_v) const {
        const Place r(surface.roughness_or_exponent, Roughnesses),
            a(surface.anisotropy, Anisotropies),
            k(std::acos(std::sqrt(std::clamp(n_v.along, 0.0f, 1.0f))) * 2.0f *
                  std::numbers::inv_pi_v<float>,
              Azimuths),
            c(std::sqrt(std::clamp(n_v.base, 0.0f, 1.0f)), Cosines);
        GgxAlbedo sum{.all = 0.0f};
        for (unsigned corner = 0; corner < 16; ++corner) {
            std::size_t index = 0;
            float weight = 1.0f;
            for (const auto& [place, bit] : {std::pair{r, 0u}, {a, 1u}, {k, 2u}, {c, 3u}}) {
                const unsigned next = corner >> bit & 1u;
                index = index * place.count + place.first + next;
                weight *= next != 0 ? place.share : 1.0f - place.share;
            }
            sum.all += weight * knots_[index].all;
            sum.grazing += weight * knots_[index].grazing;
        }
        return sum;
    }

private:
    static constexpr std::size_t Roughnesses = 16, Anisotropies = 9, Azimuths = 5, Cosines = 16;

    /// A place between two knots.
    struct Place {
        Place(float value, std::size_t num) : count(num) {
            const float at = std::clamp(value, 0.0f, 1.0f) * static_cast<float>(num - 1);
            first = std::min(static_cast<std::size_t>(at), num - 2);
            share = at - static_cast<float>(first);
        }
        std::size_t count, first;
        float share;
    };

    std::vector<GgxAlbedo> knots_;
};

} // namespace

GgxAlbedo ggx_albedo(float roughness, float n_v) {
    static const Table table;
    return table.at(roughness, n_v);
}

GgxAlbedo ggx_albedo(const Surface& surface, const EyeCosines& n_v) {
    if (!is_stretched(surface))
        return ggx_albedo(surface.roughness_or_exponent, n_v.base);
    static const StretchedTable table;
    return table.at(surface, n_v);
}

std::array<LobeFacet, 12> lobe_facets(float roughness, float n_v) {
    std::array<LobeFacet, 12> facets{};
    constexpr int FewRings = 3, FewSpokes = 4;
    static_assert(FewRings * FewSpokes == facets.size());
    std::size_t i = 0;
    float sum = 0.0f;
    for_facets(round_shape(double{roughness}), eye_at(double{n_v}),
               {FewRings, FewSpokes, std::numbers::pi}, [&](double v_h, double, double value) {
                   facets[i] = {static_cast<float>(v_h), static_cast<float>(value)};
                   sum += facets[i++].share;
               });
    for (LobeFacet& facet : facets)
        facet.share /= std::max(sum, std::numeric_limits<float>::min());
    return facets;
}

} // namespace relumine::prt
