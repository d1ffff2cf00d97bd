// Based on: Chen, Billings, Luo, "Orthogonal Least Squares Methods and Their Application to Non-linear System Identification", 1989,
// with non-negative weights and exchanges.
#include "relight/transfer_lights.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "prt/precompute.h"
#include "relight/non_negative_fit.h"

namespace relumine::relight {

namespace {

// Candidates are the centres of light of cells of this level, 2.8 degrees wide; at most 6,144 of them, 200 MB with 8,192 receivers.
constexpr std::uint32_t CandidateLevel = 5;

// A cell with a larger share of the power is cut further, so that a sun or a lamp can be given several lights.
constexpr double LargestShare = 1.0 / 1024.0;

// A column is a combination of others when less than this part of it is new: well above float rounding.
constexpr float LeastNewPart = 1e-4f;

// An exchange that lowers the error by less is rounding, and could go on for ever.
constexpr double LeastGain = 1e-9;

// Steps in degrees by which a light may move from its candidate's direction: those are 2.8 degrees apart.
constexpr std::array RefiningSteps = {1.2, 0.6, 0.3};

// Exchanging costs lights^2 x candidates; beyond this many lights it takes longer than it gives.
constexpr std::size_t MaxExchanged = 128;
constexpr int ExchangePasses = 8;

using Rgb = glm::dvec3;

/// Candidates of one task of sums over lights: tens of microseconds, and they stay in the cache.
constexpr std::size_t CandidatesPerTask = 1024;

/// Unit directions where lights could be, neighbours together: the centres of light of cells of CandidateLevel, and of smaller ones where there
/// is more light.
class Candidates {
public:
    explicit Candidates(const cubemap::CubeMap& environment)
        : environment_(environment), binning_(environment.resolution),
          texel_level_(static_cast<std::uint32_t>(std::bit_width(environment.resolution - 1))) {
        const glm::dvec3 power = cubemap::total_power(environment);
        const glm::dvec3 luminance_weights(0.2126, 0.7152, 0.0722);
        most_power_ = glm::dot(luminance_weights, power) * LargestShare;
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

/// The transfer of every candidate to the chosen receivers, [candidates][receivers], 1/sr.
class TransferMatrix {
public:
    TransferMatrix(const Relighter& relighter, std::span<const glm::dvec3> candidates,
                   std::span<const std::size_t> places)
        : num_candidates_(candidates.size()), num_receivers_(places.size()),
          elements_(candidates.size() * places.size()) {
        const ShadowRays& rays = relighter.shadow_rays();
        const prt::Transfer& transfer = relighter.transfer();
        tbb::parallel_for(
            std::size_t{0}, (candidates.size() + prt::PacketSize - 1) / prt::PacketSize, [&](std::size_t p) {
                const std::size_t begin = p * prt::PacketSize;
                const std::size_t end = std::min(begin + prt::PacketSize, candidates.size());
                prt::DirectionPacket packet;
                for (std::size_t lane = 0; lane < prt::PacketSize; ++lane)
                    packet.set(lane, candidates[std::min(begin + lane, end - 1)]);
                packet.num_directions = static_cast<std::uint32_t>(end - begin);
                for (std::size_t i = 0; i < places.size(); ++i) {
                    const glm::vec3& normal = transfer.normals[places[i]];
                    const glm::vec3 origin =
                        prt::ray_origin(rays.positions[transfer.order[places[i]]], normal, rays.bias);
                    const auto all = static_cast<std::uint32_t>((1u << (end - begin)) - 1);
                    const std::uint32_t occluded = rays.blockers->occluded(origin, packet, all);
                    for (std::size_t j = begin; j < end; ++j) {
                        const float cosine = glm::dot(
                            normal, glm::vec3(packet.x[j - begin], packet.y[j - begin], packet.z[j - begin]));
                        if (cosine > 0.0f && (occluded >> (j - begin) & 1u) == 0)
                            elements_[j * num_receivers_ + i] = cosine * std::numbers::inv_pi_v<float>;
                    }
                }
            });
    }

    [[nodiscard]] std::size_t num_candidates() const { return num_candidates_; }

    /// Products of all candidates' columns with a vector over the receivers.
    [[nodiscard]] std::vector<float> products(std::span<const float> vector) const {
        std::vector<float> result(num_candidates_);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, num_candidates_, 64), [&](const auto& some) {
            for (std::size_t j = some.begin(); j < some.end(); ++j)
                result[j] = dot(column(j), vector);
        });
        return result;
    }

    [[nodiscard]] std::span<const float> column(std::size_t candidate) const {
        return {elements_.data() + candidate * num_receivers_, num_receivers_};
    }

    [[nodiscard]] static float dot(std::span<const float> a, std::span<const float> b) {
        // Sixteen partial sums, which the compiler keeps in vector registers; the same order always.
        std::array<float, 16> sums{};
        std::size_t i = 0;
        for (; i + sums.size() <= a.size(); i += sums.size())
            for (std::size_t lane = 0; lane < sums.size(); ++lane)
                sums[lane] += a[i + lane] * b[i + lane];
        for (; i < a.size(); ++i)
            sums[0] += a[i] * b[i];
        return std::accumulate(sums.begin(), sums.end(), 0.0f);
    }

private:
    std::size_t num_candidates_;
    std::size_t num_receivers_;
    std::vector<float> elements_;
};

/// The lights so far and their fit. With the Gram-Schmidt basis q_k of the chosen columns at hand it is known of every candidate how much of
/// it is new, so the next light is the one that lowers the error most after all others have been fitted anew to it.
class Pursuit {
public:
    Pursuit(const TransferMatrix& matrix, std::span<const glm::vec3> radiance)
        : matrix_(matrix), norms_(matrix.num_candidates()) {
        for (std::size_t j = 0; j < norms_.size(); ++j)
            norms_[j] = TransferMatrix::dot(matrix.column(j), matrix.column(j));
        new_norms_ = norms_;
        std::vector<float> channel(radiance.size());
        for (std::size_t c = 0; c < 3; ++c) {
            std::transform(radiance.begin(), radiance.end(), channel.begin(),
                           [c](const glm::vec3& b) { return b[static_cast<int>(c)]; });
            targets_[c] = matrix.products(channel);
        }
        correlations_ = targets_;
    }

    /// Takes these candidates.
    void take(std::span<const std::size_t> lights) {
        for (const std::size_t candidate : lights)
            push_back(candidate, Rgb(0.0));
        fit();
    }

    /// Takes the candidate that lowers the error most; false where none does.
    bool take_best() {
        correlate();
        const std::size_t best = best_candidate();
        if (gain(best) <= 0.0)
            return false;
        push_back(best, Rgb(0.0));
        fit();
        return true;
    }

    /// Takes every light away once and puts it where it lowers the error most. Returns whether any moved.
    bool exchange() {
        bool moved = false;
        for (std::size_t i = 0; i < chosen_.size(); ++i) {
            const double old_error = error();
            const Light old = chosen_.front();
            pop_front();
            const std::vector<Light> others = chosen_;
            fit();
            correlate();
            const std::size_t best = best_candidate();
            if (best != old.candidate && gain(best) > 0.0) {
                push_back(best, Rgb(0.0));
                fit();
                if (error() < (1.0 - LeastGain) * old_error) {
                    moved = true;
                    continue;
                }
                pop_back();
            }
            chosen_ = others;
            push_back(old.candidate, old.irradiance);
        }
        return moved;
    }

    struct Light {
        std::size_t candidate = 0;
        Rgb irradiance{0.0};
    };
    [[nodiscard]] std::span<const Light> lights() const { return chosen_; }
    /// Squared error, less that without lights.
    [[nodiscard]] double error() const {
        double sum = 0.0;
        for (std::size_t k = 0; k < chosen_.size(); ++k) {
            Rgb slope(0.0);
            for (std::size_t l = 0; l < chosen_.size(); ++l)
                slope += chosen_[l].irradiance * static_cast<double>(products_[l][chosen_[k].candidate]);
            sum += glm::dot(chosen_[k].irradiance, slope - 2.0 * target(chosen_[k].candidate));
        }
        return sum;
    }

private:
    void push_back(std::size_t candidate, const Rgb& irradiance) {
        std::vector<float> products = matrix_.products(matrix_.column(candidate));
        std::vector<float> row = products;
        tbb::parallel_for(candidates(), [&](const auto& some) {
            for (const std::vector<float>& other : basis_) {
                const float common = other[candidate];
                for (std::size_t j = some.begin(); j < some.end(); ++j)
                    row[j] -= common * other[j];
            }
        });
        const float scale = 1.0f / std::sqrt(std::max(row[candidate], std::numeric_limits<float>::min()));
        for (std::size_t j = 0; j < row.size(); ++j) {
            row[j] *= scale;
            new_norms_[j] -= row[j] * row[j];
        }
        chosen_.push_back({candidate, irradiance});
        products_.push_back(std::move(products));
        basis_.push_back(std::move(row));
    }

    void pop_back() {
        const std::vector<float>& row = basis_.back();
        for (std::size_t j = 0; j < row.size(); ++j)
            new_norms_[j] += row[j] * row[j];
        basis_.pop_back();
        products_.pop_back();
        chosen_.pop_back();
    }

    /// Turns the basis until only its last vector has a part in the first light (Givens), then lets both go.
    void pop_front() {
        for (std::size_t k = 1; k < chosen_.size(); ++k) {
            const std::size_t candidate = chosen_[k].candidate;
            const float a = basis_[k - 1][candidate];
            const float b = basis_[k][candidate];
            const float length = std::hypot(a, b);
            const float cosine = length > 0.0f ? a / length : 1.0f;
            const float sine = length > 0.0f ? b / length : 0.0f;
            tbb::parallel_for(candidates(), [&](const auto& some) {
                float* first = basis_[k - 1].data();
                float* second = basis_[k].data();
                for (std::size_t j = some.begin(); j < some.end(); ++j) {
                    const float turned = cosine * first[j] + sine * second[j];
                    second[j] = cosine * second[j] - sine * first[j];
                    first[j] = turned;
                }
            });
        }
        std::rotate(chosen_.begin(), chosen_.begin() + 1, chosen_.end());
        std::rotate(products_.begin(), products_.begin() + 1, products_.end());
        pop_back();
    }

    /// Fits all irradiances to the radiance, none below zero.
    void fit() {
        const std::size_t n = chosen_.size();
        std::vector<double> gram(n * n);
        for (std::size_t l = 0; l < n; ++l)
            for (std::size_t k = 0; k < n; ++k) // products_[l] of k and of k of l are the same sum
                gram[l * n + k] = static_cast<double>(products_[l][chosen_[k].candidate]);
        tbb::parallel_for(0, 3, [&](int channel) {
            std::vector<double> targets(n);
            std::vector<double> x(n);
            for (std::size_t k = 0; k < n; ++k) {
                targets[k] = target(chosen_[k].candidate)[channel];
                x[k] = chosen_[k].irradiance[channel];
            }
            fit_non_negative(gram, targets, x);
            for (std::size_t k = 0; k < n; ++k)
                chosen_[k].irradiance[channel] = x[k];
        });
    }

    /// What each candidate has in common with the error that is left.
    void correlate() {
        tbb::parallel_for(candidates(), [&](const auto& some) {
            for (std::size_t c = 0; c < 3; ++c) {
                float* correlations = correlations_[c].data();
                std::copy_n(targets_[c].data() + some.begin(), some.size(), correlations + some.begin());
                for (std::size_t l = 0; l < chosen_.size(); ++l) {
                    const auto irradiance = static_cast<float>(chosen_[l].irradiance[static_cast<int>(c)]);
                    const float* products = products_[l].data();
                    for (std::size_t j = some.begin(); j < some.end(); ++j)
                        correlations[j] -= irradiance * products[j];
                }
            }
        });
    }

    /// How much the squared error falls when the candidate is taken and all irradiances are fitted anew, whatever their sign.
    [[nodiscard]] double gain(std::size_t candidate) const {
        if (!(new_norms_[candidate] > LeastNewPart * norms_[candidate]))
            return 0.0; // a combination of those that are there
        double useful = 0.0;
        for (const std::vector<float>& correlations : correlations_) {
            const auto common = static_cast<double>(std::max(correlations[candidate], 0.0f));
            useful += common * common;
        }
        return useful / static_cast<double>(new_norms_[candidate]);
    }

    [[nodiscard]] std::size_t best_candidate() const {
        std::size_t best = 0;
        for (std::size_t j = 1; j < norms_.size(); ++j)
            if (gain(j) > gain(best))
                best = j;
        return best;
    }

    [[nodiscard]] Rgb target(std::size_t candidate) const {
        return {targets_[0][candidate], targets_[1][candidate], targets_[2][candidate]};
    }

    [[nodiscard]] tbb::blocked_range<std::size_t> candidates() const {
        return {0, norms_.size(), CandidatesPerTask};
    }

    const TransferMatrix& matrix_;
    std::vector<float> norms_;                  ///< [candidates] t_j.t_j
    std::vector<float> new_norms_;              ///< the same of the part of t_j that no chosen column has
    std::array<std::vector<float>, 3> targets_; ///< [channel][candidates] t_j.B
    std::array<std::vector<float>, 3> correlations_; ///< the same of the error that is left, B - sum E_l t_l
    std::vector<Light> chosen_;
    std::vector<std::vector<float>> products_; ///< [lights][candidates] t_l.t_j
    std::vector<std::vector<float>> basis_;    ///< [lights][candidates] q_l.t_j
};

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
    for (const std::size_t place : places)
        radiance.push_back(relighter.radiance()[transfer.order[place]]);
    const auto poll = [&](double progress) {
        if (options.stop.stop_requested())
            throw prt::Cancelled();
        if (options.on_progress)
            options.on_progress(progress);
    };

    std::vector<Pursuit::Light> chosen;
    {
        const TransferMatrix matrix(relighter, candidates, places);
        Pursuit pursuit(matrix, radiance);
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
        for (const Pursuit::Light& light : chosen) {
            unmoved.push_back(nearby.size());
            append_around(candidates[light.candidate], step, nearby);
        }
        const TransferMatrix matrix(relighter, nearby, places);
        Pursuit pursuit(matrix, radiance);
        pursuit.take(unmoved);
        for (int pass = 0; pass < ExchangePasses && count <= MaxExchanged && pursuit.exchange(); ++pass)
            poll(0.75);
        chosen.assign(pursuit.lights().begin(), pursuit.lights().end());
        candidates = std::move(nearby);
    }
    std::vector<lights::DistantLight> result;
    for (const Pursuit::Light& light : chosen)
        if (light.irradiance != Rgb(0.0))
            result.push_back({.direction = candidates[light.candidate], .irradiance = light.irradiance});
    return result;
}

} // namespace relumine::relight
