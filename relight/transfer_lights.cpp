#include "relight/transfer_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "prt/precompute.h"
#include "relight/light_pursuit.h"
#include "relight/transfer_matrix.h"

namespace relumine::relight {

namespace {

// Candidates are the centres of light of cells of this level, 2.8 degrees wide: about 8,000 of them, 400 MB with 12,000 receivers.
constexpr std::uint32_t CandidateLevel = 5;

// A cell with a larger share of the power is cut further, so that a sun or a lamp can be given several lights.
constexpr double LargestShare = 1.0 / 1024.0;
// Steps in degrees by which a light may move from its candidate's direction: those are 2.8 degrees apart.
constexpr std::array RefiningSteps = {1.2, 0.6, 0.3};

// Exchanging costs lights^2 x candidates; beyond this many lights it takes longer than it gives.
constexpr std::size_t MaxExchanged = 128;
constexpr int ExchangePasses = 5;

/// Unit directions where lights could be, neighbours together: the centres of light of cells of CandidateLevel, and of smaller ones where there
/// is more light.
class Candidates {
public:
    explicit Candidates(const cubemap::CubeMap& environment)
        : environment_(environment), binning_(environment.resolution),
          texel_level_(static_cast<std::uint32_t>(std::bit_width(environment.resolution - 1))) {
        most_power_ = cubemap::luminance(cubemap::total_power(environment)) * LargestShare;
        for (const cubemap::Face face : cubemap::AllFaces)
            add({.face = face});
    }

    [[nodiscard]] std::vector<glm::dvec3>&& directions() && { return std::move(directions_); }

private:
    void add(const prt::Cell& cell) {
        if (cell.level >= CandidateLevel) {
            const glm::dvec3 luminance = binning_.sum(environment_, cell).luminance();
            const double power = glm::length(luminance);
            if (power <= most_power_ || cell.level >= texel_level_) {
                if (power > 0.0)
                    directions_.push_back(luminance / power);
                return;
            }
        }
        for (std::uint32_t i = 0; i < 4; ++i)
            add(cell.child(i));
    }

    const cubemap::CubeMap& environment_;
    LightBinning binning_;
    std::uint32_t texel_level_; ///< where a cell is no larger than a texel
    double most_power_ = 0.0;
    std::vector<glm::dvec3> directions_;
};

/// A direction and eight around it, so many degrees to the sides and corners.
void append_around(const glm::dvec3& direction, double degrees, std::vector<glm::dvec3>& directions) {
    const glm::dvec3 other =
        std::abs(direction.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const double step = std::tan(degrees * std::numbers::pi / 180.0);
    const glm::dvec3 right = step * glm::normalize(glm::cross(other, direction));
    const glm::dvec3 up = glm::cross(direction, right);
    directions.push_back(direction);
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            if (x != 0 || y != 0)
                directions.push_back(
                    glm::normalize(direction + static_cast<double>(x) * right + static_cast<double>(y) * up));
}

/// Evenly spread places of receivers that have a normal.
std::vector<std::size_t> places_of(const prt::Transfer& transfer, std::size_t count) {
    std::vector<std::size_t> lit;
    for (std::size_t place = 0; place < transfer.num_receivers(); ++place)
        if (transfer.normals[place] != glm::vec3(0.0f))
            lit.push_back(place);
    if (lit.size() <= count)
        return lit;
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < count; ++i)
        places.push_back(lit[i * lit.size() / count]);
    return places;
}

} // namespace

std::vector<lights::DistantLight> transfer_lights(const Relighter& relighter, std::size_t count,
                                                  const TransferLightOptions& options) {
    if (relighter.environment().resolution == 0 || relighter.shadow_rays().blockers == nullptr)
        throw std::invalid_argument("expected a relighter with an environment and shadow rays");
    if (count == 0)
        throw std::invalid_argument("expected at least one light");
    std::vector<glm::dvec3> candidates = Candidates(relighter.environment()).directions();
    const prt::Transfer& transfer = relighter.transfer();
    const std::vector<std::size_t> places = places_of(transfer, options.num_receivers);
    if (candidates.empty() || places.empty())
        return {};
    std::vector<glm::vec3> radiance;
    radiance.reserve(places.size());
    for (const std::size_t place : places)
        radiance.push_back(relighter.radiance()[transfer.order[place]]);
    const auto poll = [&](double progress) {
        if (options.stop.stop_requested())
            throw prt::Cancelled();
        if (options.on_progress)
            options.on_progress(progress);
    };

    std::vector<LightPursuit::Light> chosen;
    {
        const TransferMatrix matrix(relighter, candidates, places);
        LightPursuit pursuit(matrix, radiance);
        count = std::min(count, candidates.size());
        while (pursuit.lights().size() < count && pursuit.take_best())
            poll(0.5 * static_cast<double>(pursuit.lights().size()) / static_cast<double>(count));
        for (int pass = 0; pass < ExchangePasses && count <= MaxExchanged && pursuit.exchange(); ++pass)
            poll(0.5);
        chosen.assign(pursuit.lights().begin(), pursuit.lights().end());
    }
    // Then each may move by less than the candidates' distance.
    for (const double step : RefiningSteps) {
        poll(0.75);
        std::vector<glm::dvec3> nearby;
        std::vector<std::size_t> unmoved;
        for (const LightPursuit::Light& light : chosen) {
            unmoved.push_back(nearby.size());
            append_around(candidates[light.candidate], step, nearby);
        }
        const TransferMatrix matrix(relighter, nearby, places);
        LightPursuit pursuit(matrix, radiance);
        pursuit.take(unmoved);
        for (int pass = 0; pass < ExchangePasses && count <= MaxExchanged && pursuit.exchange(); ++pass)
            poll(0.75);
        chosen.assign(pursuit.lights().begin(), pursuit.lights().end());
        candidates = std::move(nearby);
    }
    std::vector<lights::DistantLight> result;
    for (const LightPursuit::Light& light : chosen)
        if (light.irradiance != glm::dvec3(0.0))
            result.push_back({.direction = candidates[light.candidate], .irradiance = light.irradiance});
    return result;
}

} // namespace relumine::relight
