#include "relight/harmonics/cluster_harmonics.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "prt/clusters/lattice.h"

namespace relumine::relight {

namespace {

/// Groups are cells of this level, 3.6 degrees wide at most, or leaves that are larger. Not
/// measured: light moves by 2.5 degrees at most, and finer groups cost more products.
constexpr std::uint32_t GroupLevel = 5;

struct CellMiddle {
    /// Unit length.
    glm::dvec3 direction;
    double coherence;
    double solid_angle;
};

/// The sum of a cell's directions is half the sum, over its edges, of the edge's angle times the
/// edge's normal: Lambert's formula for polygons.
CellMiddle middle_of(const prt::Cell& cell) {
    const auto corner = [&](double x, double y) {
        return cubemap::direction(cell.face, (cell.x + x) * cell.size(),
                                  (cell.y + y) * cell.size());
    };
    const std::array<glm::dvec3, 4> corners = {corner(0, 0), corner(1, 0), corner(1, 1),
                                               corner(0, 1)};
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const glm::dvec3 cross = glm::cross(corners[i], corners[(i + 1) % corners.size()]);
        const double sine = glm::length(cross);
        sum += 0.5 * std::atan2(sine, glm::dot(corners[i], corners[(i + 1) % corners.size()])) /
               sine * cross;
    }
    const double s0 = cell.x * cell.size(), t0 = cell.y * cell.size();
    const double solid_angle = cubemap::solid_angle(s0, t0, s0 + cell.size(), t0 + cell.size());
    const glm::dvec3 centre = corner(0.5, 0.5);
    const double length = glm::length(sum);
    // Corners run one way around on some faces and the other way on others.
    return {.direction = glm::dot(sum, centre) < 0.0 ? -sum / length : sum / length,
            .coherence = std::min(1.0, length / solid_angle),
            .solid_angle = solid_angle};
}

/// Returns the factor of each band for directions that are spread about their middle.
std::array<double, 3> band_factors(double coherence) {
    return {1.0, coherence, coherence * coherence * coherence};
}

HarmonicGroup group_at(const prt::Cell& cell) {
    const CellMiddle middle = middle_of(cell);
    const std::array<double, MaxHarmonics> values = harmonics(middle.direction);
    const std::array<double, 3> factors = band_factors(middle.coherence);
    HarmonicGroup group;
    for (std::size_t k = 0; k < values.size(); ++k)
        group.basis[k] = static_cast<float>(values[k] * factors[band_of(k)]);
    const double width = std::sqrt(middle.solid_angle);
    for (int axis = 0; axis < 3; ++axis)
        group.slope[static_cast<std::size_t>(axis)] =
            static_cast<float>(middle.direction[axis] / width);
    return group;
}

/// Returns the cell of a group that a leaf is in.
prt::Cell group_cell(const prt::Cell& leaf) {
    prt::Cell cell = leaf;
    if (leaf.level > GroupLevel) {
        const std::uint32_t shift = leaf.level - GroupLevel;
        cell.level = GroupLevel;
        cell.x = static_cast<decltype(cell.x)>(leaf.x >> shift);
        cell.y = static_cast<decltype(cell.y)>(leaf.y >> shift);
    }
    return cell;
}

} // namespace

std::array<std::array<double, MaxHarmonics>, 3> harmonics_of(const VectorIrradiance& light,
                                                             double coherence) {
    std::array<std::array<double, MaxHarmonics>, 3> result{};
    const std::array<double, 3> factors = band_factors(coherence);
    const std::array<glm::dvec3, 3> channels = {light.red, light.green, light.blue};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        const double length = glm::length(channels[channel]);
        if (!(length > 0.0))
            continue;
        const double flux = length / coherence;
        const std::array<double, MaxHarmonics> values = harmonics(channels[channel] / length);
        for (std::size_t k = 0; k < MaxHarmonics; ++k)
            result[channel][k] = flux * factors[band_of(k)] * values[k];
    }
    return result;
}

ClusterHarmonics::ClusterHarmonics(const prt::Quadtree& quadtree, std::uint32_t order)
    : order_(order), coherences_(quadtree.num_leaves()), values_(quadtree.num_leaves() * stride()),
      prefix_(((quadtree.num_leaves() + 63) / 64 * 64 + 1) * stride()),
      fluxes_(quadtree.num_leaves() * 3) {
    prt::Cell last;
    for (std::size_t leaf = 0; leaf < coherences_.size(); ++leaf) {
        const prt::Cell& cell = quadtree.leaves()[leaf];
        coherences_[leaf] = middle_of(cell).coherence;
        const prt::Cell of_group = group_cell(cell);
        if (groups_.empty() || of_group != last)
            groups_.push_back(group_at(of_group));
        last = of_group;
        group_of_.push_back(static_cast<std::uint32_t>(groups_.size() - 1));
    }
}

void ClusterHarmonics::set(std::size_t cluster, const VectorIrradiance& light) {
    constexpr double Scale = 1.0 / prt::FullCount;
    const double coherence = coherences_[cluster];
    const auto coefficients = harmonics_of(light, coherence);
    const std::size_t count = num_harmonics(order_);
    double* value = values_.data() + cluster * stride();
    for (const auto& channel : coefficients)
        for (std::size_t k = 0; k < count; ++k)
            *value++ = channel[k] * Scale;
    const double flux = Scale / coherence;
    fluxes_[cluster * 3] = static_cast<float>(glm::length(light.red) * flux);
    fluxes_[cluster * 3 + 1] = static_cast<float>(glm::length(light.green) * flux);
    fluxes_[cluster * 3 + 2] = static_cast<float>(glm::length(light.blue) * flux);
}

void ClusterHarmonics::sum_prefix() {
    for (std::size_t i = 0; i < values_.size(); ++i)
        prefix_[i + stride()] = prefix_[i] + values_[i];
}

void HarmonicChanges::clear() {
    words.clear();
    values.clear();
    word_values.clear();
    fluxes.clear();
    groups.clear();
}

void HarmonicChanges::set(ClusterHarmonics& lights, std::size_t cluster,
                          const VectorIrradiance& light) {
    const std::size_t first_value = values.size(), first_flux = fluxes.size();
    const std::span<const double> own = lights.of(cluster);
    const std::span<const float> flux = lights.fluxes().subspan(cluster * 3, 3);
    values.insert(values.end(), own.begin(), own.end());
    fluxes.insert(fluxes.end(), flux.begin(), flux.end());
    lights.set(cluster, light);
    if (std::equal(own.begin(), own.end(), values.begin() + static_cast<long>(first_value))) {
        values.resize(first_value);
        fluxes.resize(first_flux);
        return;
    }
    for (std::size_t i = 0; i < own.size(); ++i)
        values[first_value + i] = own[i] - values[first_value + i];
    for (std::size_t i = 0; i < flux.size(); ++i)
        fluxes[first_flux + i] = static_cast<double>(flux[i]) - fluxes[first_flux + i];
    if (words.empty() || words.back().word != cluster / 64) {
        words.push_back({.word = static_cast<std::uint32_t>(cluster / 64),
                         .first = static_cast<std::uint32_t>(groups.size())});
        word_values.resize(word_values.size() + own.size());
    }
    double* of_word = word_values.data() + word_values.size() - own.size();
    for (std::size_t i = 0; i < own.size(); ++i)
        of_word[i] += values[first_value + i];
    words.back().clusters |= std::uint64_t{1} << (cluster % 64);
    groups.push_back(lights.group_of()[cluster]);
}

} // namespace relumine::relight
