#include "relight/light_fit/transfer_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include <glm/geometric.hpp>

#include "cubemap/luminance.h"
#include "lights/place_lights.h"
#include "prt/precompute.h"
#include "relight/light_fit/light_pursuit.h"
#include "relight/light_fit/scaled_receivers.h"
#include "relight/light_fit/transfer_matrix.h"

namespace relumine::relight {

namespace {

// Candidates are the centres of light of cells of this level, 2.8 degrees wide: about 8,000 of
// them, 500 MB with 16,000 receivers.
constexpr std::uint32_t CandidateLevel = 5;

// A cell with a larger share of the power is cut further, so that a sun or a lamp can get several
// lights.
constexpr double LargestShare = 1.0 / 1024.0;
// Steps in degrees by which a light may move from its candidate's direction; candidates are 2.8
// degrees apart. Each step has two passes, as the other lights move, too.
constexpr std::array RefiningSteps = {1.4, 0.8, 0.4, 0.2, 1.0, 0.5, 0.25};
constexpr int RefiningPasses = 2;
// Chosen lights fit the receivers they were chosen with better than other receivers. So twice as
// many take part in the steps.
constexpr std::size_t RefiningFactor = 2;

/// Receivers that lights are chosen with.
constexpr std::size_t NumReceivers = 16000;

// Exchanging costs lights^2 x candidates. With more lights than this it takes longer than it is
// worth.
constexpr std::size_t MaxExchanged = 128;
constexpr int ExchangePasses = 2;

/// Unit directions where lights could be, neighbours together: the centres of light of cells of
/// CandidateLevel, and of smaller ones where there is more light.
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
    /// The level where a cell is no larger than a texel.
    std::uint32_t texel_level_;
    double most_power_ = 0.0;
    std::vector<glm::dvec3> directions_;
};

/// Appends a direction and eight around it, so many degrees to the sides and corners.
void append_around(const glm::dvec3& direction, double degrees,
                   std::vector<glm::dvec3>& directions) {
    const glm::dvec3 other =
        std::abs(direction.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0) : glm::dvec3(1.0, 0.0, 0.0);
    const double step = std::tan(degrees * std::numbers::pi / 180.0);
    const glm::dvec3 right = step * glm::normalize(glm::cross(other, direction));
    const glm::dvec3 up = glm::cross(direction, right);
    directions.push_back(direction);
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            if (x != 0 || y != 0)
                directions.push_back(glm::normalize(direction + static_cast<double>(x) * right +
                                                    static_cast<double>(y) * up));
}

/// Some receivers and the radiance they should get, both scaled.
struct Wanted {
    Wanted(const Relighter& relighter, const LightGoal& goal,
           std::span<const double> expected_errors, std::size_t count)
        : receivers(choose_receivers(relighter.transfer(), expected_errors, count)) {
        radiance.reserve(receivers.places.size());
        for (std::size_t i = 0; i < receivers.places.size(); ++i) {
            const std::uint32_t receiver = relighter.transfer().order[receivers.places[i]];
            if (!goal.weights.empty())
                receivers.scales[i] *= std::sqrt(goal.weights[receiver]);
            radiance.push_back(receivers.scales[i] * goal.radiance[receiver]);
        }
    }
    ScaledReceivers receivers;
    std::vector<glm::vec3> radiance;
};

/// Returns, by place, the part of the squared error of lights that do not know the scene. It is
/// large at the borders of shadows, and where there are many.
std::vector<double> errors_of_cuts(const Relighter& relighter, std::size_t count) {
    const cubemap::EnvironmentImage image = lights::lat_long_of(relighter.environment());
    std::vector<double> errors(relighter.transfer().num_receivers());
    for (const lights::Method method : {lights::Method::VarianceCut, lights::Method::MedianCut})
        add_squared_errors(
            relighter, {.radiance = relighter.radiance()},
            lights::place(method, image, std::min(count, image.pixels.size())).lights, errors);
    return errors;
}

std::vector<lights::DistantLight> list_of(std::span<const LightPursuit::Light> lights,
                                          std::span<const glm::dvec3> directions) {
    std::vector<lights::DistantLight> list;
    for (const LightPursuit::Light& light : lights)
        if (light.irradiance != glm::dvec3(0.0))
            list.push_back(
                {.direction = directions[light.candidate], .irradiance = light.irradiance});
    return list;
}

/// Returns the lights in these directions, fitted to the wanted radiance.
std::vector<lights::DistantLight>
fitted(const Relighter& relighter, std::span<const glm::dvec3> directions, const Wanted& wanted) {
    const TransferMatrix matrix(relighter, directions, wanted.receivers);
    LightPursuit pursuit(matrix, wanted.radiance);
    std::vector<std::size_t> all(directions.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    pursuit.take(all);
    return list_of(pursuit.lights(), directions);
}

/// Moves each direction by a step where it pays. Returns the lights in the new directions.
std::vector<lights::DistantLight> moved(const Relighter& relighter,
                                        std::vector<glm::dvec3>& directions, double step,
                                        const Wanted& wanted) {
    std::vector<glm::dvec3> nearby;
    std::vector<std::size_t> unmoved;
    for (const glm::dvec3& direction : directions) {
        unmoved.push_back(nearby.size());
        append_around(direction, step, nearby);
    }
    const TransferMatrix matrix(relighter, nearby, wanted.receivers);
    LightPursuit pursuit(matrix, wanted.radiance);
    pursuit.take(unmoved);
    for (int pass = 0; pass < RefiningPasses && pursuit.exchange(); ++pass) {
    }
    std::transform(pursuit.lights().begin(), pursuit.lights().end(), directions.begin(),
                   [&](const LightPursuit::Light& light) { return nearby[light.candidate]; });
    return list_of(pursuit.lights(), nearby);
}

/// Chooses lights among candidates, and moves them. `errors` is, by place, how much of the squared
/// error is expected there.
std::vector<lights::DistantLight> chosen_lights(const Relighter& relighter, const LightGoal& goal,
                                                std::span<const glm::dvec3> candidates,
                                                std::vector<double> errors, std::size_t count,
                                                const prt::Work& work) {
    const Wanted wanted(relighter, goal, errors, NumReceivers);
    if (wanted.receivers.places.empty() || candidates.empty())
        return {};
    const auto poll = [&](double progress) {
        work.poll();
        work.tell(progress);
    };

    std::vector<LightPursuit::Light> chosen;
    {
        const TransferMatrix matrix(relighter, candidates, wanted.receivers);
        LightPursuit pursuit(matrix, wanted.radiance);
        count = std::min(count, candidates.size());
        while (pursuit.lights().size() < count && pursuit.take_best())
            poll(0.5 * static_cast<double>(pursuit.lights().size()) / static_cast<double>(count));
        for (int pass = 0; pass < ExchangePasses && count <= MaxExchanged && pursuit.exchange();
             ++pass)
            poll(0.5);
        chosen.assign(pursuit.lights().begin(), pursuit.lights().end());
    }
    // There are far fewer directions now, so more receivers take part; most of the added ones are
    // where this list is wrong.
    add_squared_errors(relighter, goal, list_of(chosen, candidates), errors);
    const Wanted all_over(relighter, goal, errors, RefiningFactor * NumReceivers);
    std::vector<glm::dvec3> directions;
    directions.reserve(chosen.size());
    for (const LightPursuit::Light& light : chosen)
        directions.push_back(candidates[light.candidate]);
    if (count > MaxExchanged)
        return fitted(relighter, directions, all_over);
    std::vector<lights::DistantLight> result;
    for (std::size_t i = 0; i < RefiningSteps.size(); ++i) {
        poll(0.6 + 0.4 * static_cast<double>(i) / static_cast<double>(RefiningSteps.size()));
        result = moved(relighter, directions, RefiningSteps[i], all_over);
    }
    return result;
}

/// The centres of all cells of CandidateLevel.
std::vector<glm::dvec3> even_candidates() {
    std::vector<glm::dvec3> directions;
    const prt::Quadtree cells =
        prt::Quadtree::of([](const prt::Cell& cell) { return cell.level < CandidateLevel; });
    for (const prt::Cell& cell : cells.leaves())
        directions.push_back(cubemap::direction(cell.face, (cell.x + 0.5) * cell.size(),
                                                (cell.y + 0.5) * cell.size()));
    return directions;
}

} // namespace

std::vector<lights::DistantLight> transfer_lights(const Relighter& relighter, std::size_t count,
                                                  const prt::Work& work) {
    if (relighter.environment().resolution == 0 || relighter.shadow_rays().blockers == nullptr)
        throw std::invalid_argument("expected a relighter with an environment and shadow rays");
    if (relighter.transfer().num_points != 0)
        throw std::invalid_argument("expected receivers on surfaces, got points in space");
    if (count == 0)
        throw std::invalid_argument("expected at least one light");
    const std::vector<glm::dvec3> candidates = Candidates(relighter.environment()).directions();
    if (candidates.empty())
        return {};
    return chosen_lights(relighter, {.radiance = relighter.radiance()}, candidates,
                         errors_of_cuts(relighter, count), count, work);
}

std::vector<lights::DistantLight> fit_lights(const Relighter& relighter, const LightGoal& goal,
                                             std::size_t count, const prt::Work& work) {
    const std::size_t num_receivers = relighter.transfer().num_receivers();
    if (relighter.shadow_rays().blockers == nullptr)
        throw std::invalid_argument("expected a relighter with shadow rays");
    if (relighter.transfer().num_points != 0)
        throw std::invalid_argument("expected receivers on surfaces, got points in space");
    if (goal.radiance.size() != num_receivers ||
        (!goal.weights.empty() && goal.weights.size() != num_receivers))
        throw std::invalid_argument("expected a radiance for each receiver");
    if (count == 0)
        throw std::invalid_argument("expected at least one light");
    // Receivers count alike, where they count.
    std::vector<double> errors(num_receivers);
    for (std::size_t place = 0; place < num_receivers && !goal.weights.empty(); ++place)
        errors[place] = static_cast<double>(goal.weights[relighter.transfer().order[place]]);
    return chosen_lights(relighter, goal, even_candidates(), std::move(errors), count, work);
}

} // namespace relumine::relight
