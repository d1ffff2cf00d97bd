// Diffuse light from surface to surface: the matrix that a bounce multiplies with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "prt/bounces/point_rows.h"
#include "prt/team.h"

namespace relumine::prt {

/// A list of places for each receiver.
struct PlaceLists {
    /// [size() + 1] the first of each list in `places`.
    std::vector<std::uint64_t> begin = {0};
    /// Ascending within a list. A place may stand there twice.
    std::vector<std::uint32_t> places = {};

    [[nodiscard]] std::size_t size() const { return begin.size() - 1; }
    [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t list) const {
        return {places.data() + begin[list],
                static_cast<std::size_t>(begin[list + 1] - begin[list])};
    }
    void append(std::span<const std::uint32_t> list) {
        places.insert(places.end(), list.begin(), list.end());
        begin.push_back(places.size());
    }
    bool operator==(const PlaceLists&) const = default;
};

/// The most directions that a receiver looks into
inline constexpr std::uint32_t MostBounceDirections = 3072;

/// How the rows of a matrix were sampled, by place: what moves need to sample parts of them anew.
struct BounceRays {
    /// Directions that each receiver looked into, and rays that met a surface
    std::vector<std::uint32_t> num_directions = {}, num_hits = {};
    /// BounceSamples::distances
    std::vector<float> distances = {};
    /// What the power iteration of spectral_radius() finds in its first bounces; 0: not known
    float early_radius = 0.0f;
    bool operator==(const BounceRays&) const = default;
};

/// Sampled form factors. The radiance that a receiver of albedo 1 gets from others is
///
///     weights[x] * (sum over y in averaged[x] of (sum over z in emitters[y] of X(z)))
///
/// where X is the radiance of each emitter: a receiver's own samples, and those of similar
/// receivers near it, count alike. Colour is no part of this, so albedo stays editable
/// [direct-to-indirect transfer: Hasan, Pellacini and Bala 2006].
struct BounceMatrix {
    /// [num_rows] by place.
    std::vector<float> weights;
    /// What the rays of each receiver hit.
    PlaceLists emitters;
    /// Receivers that share their samples; each is a member of its own list.
    PlaceLists averaged;
    /// The largest eigenvalue: how much of the light a further bounce keeps at albedo 1. Light
    /// grows for ever at albedos of 1/spectral_radius and more.
    float spectral_radius = 0.0f;
    /// Rows of the points in space, whose lists above are empty.
    PointRows points = {};
    /// Only of scenes whose things can be moved
    BounceRays rays = {};

    [[nodiscard]] std::size_t num_rows() const { return weights.size(); }
    bool operator==(const BounceMatrix&) const = default;
};

/// Throws:  std::invalid_argument where the arrays contradict each other, a place is none of the
///          receivers, a weight is negative or not finite, or a row's sum is above 1.
void require_bounces(const BounceMatrix& matrix, std::size_t num_receivers);

/// Checks the rows of points as require_bounces() does.
void require_points(const PointRows& rows, std::size_t num_receivers);

/// Checks what require_bounces() does of all but the emitters, of which it takes the numbers.
///
/// Shape:   `num_emitters` is [num_rows].
/// Throws:  as require_bounces().
void require_rows(const BounceMatrix& matrix, std::span<const std::uint32_t> num_emitters);

/// Returns a place before which no receiver sends light to another, and from which on receivers get
/// light from each other only: where added vertices begin, or 0.
[[nodiscard]] std::size_t first_emitter(const BounceMatrix& matrix);

/// Returns first_emitter(), given the lowest place that any row has and the lists of those who
/// share samples.
[[nodiscard]] std::size_t first_emitter(std::size_t lowest_place, const PlaceLists& averaged);

/// Processes that share the rows of a matrix have so many neighbouring ones in turn.
inline constexpr std::size_t RowsPerRun = 1024;

/// Returns true where a process has a row. Runs are counted from row 0 to `first`, which is
/// first_emitter(), and from there on.
[[nodiscard]] inline bool has_row(const Part& part, std::size_t row, std::size_t first) {
    return (row < first ? row : row - first) / RowsPerRun % part.count == part.index;
}

/// Returns the largest eigenvalue of a square matrix of bounces, from below, by power iteration.
///
/// Cost:    some 30 bounces.
[[nodiscard]] float spectral_radius(const BounceMatrix& matrix);

} // namespace relumine::prt
