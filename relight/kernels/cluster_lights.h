// From an environment to the light of each cluster.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/luminance.h"
#include "prt/transfer/quadtree.h"

namespace relumine::relight {

/// Vector irradiance of a part of the environment, per colour channel: the sum of L_j dw_j w_j over
/// its lights j. A surface of normal n has the irradiance dot(n, vector) if it sees the whole part
/// and no light of it comes from behind.
///
/// Unit:    radiance times sr.
struct VectorIrradiance {
    glm::dvec3 red{0.0};
    glm::dvec3 green{0.0};
    glm::dvec3 blue{0.0};

    VectorIrradiance& operator+=(const VectorIrradiance& other);
    VectorIrradiance& operator-=(const VectorIrradiance& other);
    bool operator==(const VectorIrradiance&) const = default;
    /// Returns the vector of the luminance (Rec. 709 weights).
    [[nodiscard]] glm::dvec3 luminance() const { return cubemap::luminance(red, green, blue); }
    /// Returns the irradiance of a surface with this normal that sees all of the light, never below
    /// zero.
    [[nodiscard]] glm::dvec3 on(const glm::vec3& normal) const {
        const glm::dvec3 n(normal);
        return glm::max(glm::dvec3(glm::dot(n, red), glm::dot(n, green), glm::dot(n, blue)), 0.0);
    }
    /// Returns the length of the luminance vector: for a small part of the environment, the light's
    /// power in luminance.
    [[nodiscard]] double power() const { return glm::length(luminance()); }
};

class BandSums;

/// Sums an environment's texels into cells. Keeps the texels' solid angles for one resolution, so
/// that many sums are cheap.
///
/// Differs from [JN, Eq. 8], where a cluster has one scalar L_C = sum of L_j. The vector keeps
/// where inside the cluster the light comes from. It costs nothing when relighting, and lowers the
/// error of bright small lights in large clusters.
class LightBinning {
public:
    explicit LightBinning(std::uint32_t face_resolution);

    [[nodiscard]] std::uint32_t resolution() const { return resolution_; }

    /// Returns the vector irradiance of one cell. A texel that the cell covers in part counts by
    /// the part's solid angle and direction, so cells need not fit texels. Sums are in double, in a
    /// fixed order.
    ///
    /// Cost:    O(texels of the cell).
    [[nodiscard]] VectorIrradiance sum(const cubemap::CubeMap& environment,
                                       const prt::Cell& cell) const;

    /// Whether it is known that all texels are radiance.
    enum class Texels { Checked, Unchecked };

    /// Returns sum() of every cell; parallel.
    ///
    /// Throws:  std::invalid_argument for unchecked texels that require_radiance() refuses.
    [[nodiscard]] std::vector<VectorIrradiance> sums(const cubemap::CubeMap& environment,
                                                     std::span<const prt::Cell> cells,
                                                     Texels texels = Texels::Checked) const;
    /// Returns sum() of every cell that `bands` has arranged for this resolution; parallel.
    [[nodiscard]] std::vector<VectorIrradiance> sums(const cubemap::CubeMap& environment,
                                                     const BandSums& bands,
                                                     Texels texels = Texels::Checked) const;

    /// Adds to the cell's texels the derivative of a number by their radiance, given its derivative
    /// by the cell's vector irradiance: the transpose of sum().
    ///
    /// Shape:   `texels` has this object's resolution.
    void add_derivative(const prt::Cell& cell, const VectorIrradiance& derivative,
                        cubemap::CubeMap& texels) const;

private:
    std::uint32_t resolution_;
    /// [R * R] solid angle over the length of (u, v, 1). The weight times L (u, v, 1) is L dw w.
    std::vector<float> weights_;
};

} // namespace relumine::relight
