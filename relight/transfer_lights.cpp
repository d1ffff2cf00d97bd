// Based on: Pati, Rezaiifar, Krishnaprasad, "Orthogonal Matching Pursuit", 1993, with non-negative weights.
#include "relight/transfer_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
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

// Exchanging costs lights^2 x candidates; beyond this many lights it takes longer than it gives.
constexpr std::size_t MaxExchanged = 128;
const int ExchangePasses = getenv("EP") ? atoi(getenv("EP")) : 2;

using Rgb = glm::dvec3;

/// Candidates of one task of sums over lights: tens of microseconds, and they stay in the cache.
constexpr std::size_t CandidatesPerTask = 1024;

/// The cells of CandidateLevel below one, depth first.
void append_cells(const prt::Cell& cell, std::vector<prt::Cell>& cells) {
    if (cell.level == CandidateLevel) {
        cells.push_back(cell);
        return;
    }
    for (std::uint32_t i = 0; i < 4; ++i)
        append_cells(cell.child(i), cells);
}

/// Unit directions where lights could be; neighbours stand together.
std::vector<glm::dvec3> candidates_of(const cubemap::CubeMap& environment) {
    const LightBinning binning(environment.resolution);
    std::vector<glm::dvec3> directions;
    std::vector<prt::Cell> cells;
    for (const cubemap::Face face : cubemap::AllFaces)
        append_cells({.face = face}, cells);
    for (const VectorIrradiance& sum : binning.sums(environment, cells)) {
        const glm::dvec3 luminance = sum.luminance();
        if (luminance != glm::dvec3(0.0))
            directions.push_back(glm::normalize(luminance));
    }
    return directions;
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

/// The lights so far and their fit.
class Pursuit {
public:
    Pursuit(const TransferMatrix& matrix, std::span<const glm::vec3> radiance)
        : matrix_(matrix), taken_(matrix.num_candidates(), false), norms_(matrix.num_candidates()) {
        for (std::size_t j = 0; j < norms_.size(); ++j)
            norms_[j] = static_cast<double>(TransferMatrix::dot(matrix.column(j), matrix.column(j)));
        std::vector<float> channel(radiance.size());
        for (int c = 0; c < 3; ++c) {
            std::transform(radiance.begin(), radiance.end(), channel.begin(),
                           [c](const glm::vec3& b) { return b[c]; });
            targets_[static_cast<std::size_t>(c)] = matrix.products(channel);
        }
        correlations_ = targets_;
    }

    /// Takes the candidate that lowers the error most; false where none does.
    bool take_best() {
        correlate();
        const std::size_t best = best_candidate();
        if (gain(best) <= 0.0)
            return false;
        take(chosen_.size(), best);
        fit();
        return true;
    }

    double error(std::span<const glm::vec3> b) const {
        double sum = 0, all = 0;
        for (std::size_t i = 0; i < b.size(); ++i) {
            Rgb x(0.0);
            for (std::size_t k = 0; k < chosen_.size(); ++k)
                x += irradiances_[k] * double(matrix_.column(chosen_[k])[i]);
            sum += glm::dot(x - Rgb(b[i]), x - Rgb(b[i]));
            all += glm::dot(Rgb(b[i]), Rgb(b[i]));
        }
        return std::sqrt(sum / all);
    }
    void take_this(std::size_t candidate) {
        if (!taken_[candidate])
            take(chosen_.size(), candidate);
    }
    /// Tries to put every light where it helps most while the others stay. Returns whether any moved.
    bool exchange() {
        bool moved = false;
        for (std::size_t k = 0; k < chosen_.size(); ++k) {
            const std::size_t old = chosen_[k];
            taken_[old] = false;
            irradiances_[k] = Rgb(0.0);
            correlate();
            const std::size_t best = best_candidate();
            // A hair more is rounding, and could go on for ever.
            if (best != old && gain(best) > (1.0 + 1e-6) * gain(old)) {
                take(k, best);
                moved = true;
            } else {
                taken_[old] = true;
            }
            fit();
        }
        return moved;
    }

    /// Fits all irradiances to the radiance, none below zero.
    void fit() {
        const std::size_t n = chosen_.size();
        std::vector<double> gram(n * n);
        for (std::size_t l = 0; l < n; ++l)
            for (std::size_t k = 0; k < n; ++k) // products_[l][k] and [k][l] are the same sum
                gram[l * n + k] = static_cast<double>(products_[l][chosen_[k]]);
        tbb::parallel_for(0, 3, [&](int channel) {
            std::vector<double> target(n);
            std::vector<double> x(n);
            for (std::size_t k = 0; k < n; ++k) {
                target[k] = static_cast<double>(targets_[static_cast<std::size_t>(channel)][chosen_[k]]);
                x[k] = irradiances_[k][channel];
            }
            fit_non_negative(gram, target, x);
            for (std::size_t k = 0; k < n; ++k)
                irradiances_[k][channel] = x[k];
        });
    }

    [[nodiscard]] std::size_t num_lights() const { return chosen_.size(); }
    [[nodiscard]] std::size_t candidate(std::size_t light) const { return chosen_[light]; }
    [[nodiscard]] const Rgb& irradiance(std::size_t light) const { return irradiances_[light]; }

private:
    void take(std::size_t light, std::size_t candidate) {
        if (light == chosen_.size()) {
            chosen_.emplace_back();
            irradiances_.emplace_back(0.0);
            products_.emplace_back();
        }
        chosen_[light] = candidate;
        products_[light] = matrix_.products(matrix_.column(candidate));
        taken_[candidate] = true;
    }

    /// What each candidate has in common with the error that is left.
    void correlate() {
        const tbb::blocked_range<std::size_t> all(0, matrix_.num_candidates(), CandidatesPerTask);
        tbb::parallel_for(all, [&](const auto& some) {
            for (std::size_t c = 0; c < 3; ++c) {
                float* correlations = correlations_[c].data();
                std::copy(targets_[c].begin() + static_cast<std::ptrdiff_t>(some.begin()),
                          targets_[c].begin() + static_cast<std::ptrdiff_t>(some.end()),
                          correlations + some.begin());
                for (std::size_t l = 0; l < chosen_.size(); ++l) {
                    const auto irradiance = static_cast<float>(irradiances_[l][static_cast<int>(c)]);
                    const float* products = products_[l].data();
                    for (std::size_t j = some.begin(); irradiance != 0.0f && j < some.end(); ++j)
                        correlations[j] -= irradiance * products[j];
                }
            }
        });
    }

    /// How much the squared error falls when the candidate gets the irradiance that suits it best.
    [[nodiscard]] double gain(std::size_t candidate) const {
        double useful = 0.0;
        for (const std::vector<float>& correlations : correlations_) {
            const auto common = static_cast<double>(std::max(correlations[candidate], 0.0f));
            useful += common * common;
        }
        return norms_[candidate] > 0.0 ? useful / norms_[candidate] : 0.0;
    }

    [[nodiscard]] std::size_t best_candidate() const {
        std::size_t best = 0;
        double best_gain = -1.0;
        for (std::size_t j = 0; j < norms_.size(); ++j)
            if (!taken_[j] && gain(j) > best_gain) {
                best = j;
                best_gain = gain(j);
            }
        return best;
    }

    const TransferMatrix& matrix_;
    std::vector<bool> taken_;
    std::vector<double> norms_;                      ///< [candidates] t_j.t_j
    std::array<std::vector<float>, 3> targets_;      ///< [channel][candidates] t_j.B
    std::array<std::vector<float>, 3> correlations_; ///< the same of the error that is left, B - sum E_l t_l
    std::vector<std::size_t> chosen_;                ///< [lights] candidate
    std::vector<Rgb> irradiances_;                   ///< [lights] E_l
    std::vector<std::vector<float>> products_;       ///< [lights][candidates] t_l.t_j
};

} // namespace

std::vector<lights::DistantLight> transfer_lights(const Relighter& relighter, std::size_t count,
                                                  const TransferLightOptions& options) {
    if (relighter.environment().resolution == 0 || relighter.shadow_rays().blockers == nullptr)
        throw std::invalid_argument("expected a relighter with an environment and shadow rays");
    if (count == 0)
        throw std::invalid_argument("expected at least one light");
    const std::vector<glm::dvec3> candidates = candidates_of(relighter.environment());
    const prt::Transfer& transfer = relighter.transfer();
    const std::vector<std::size_t> places = places_of(transfer, options.num_receivers);
    if (candidates.empty() || places.empty())
        return {};

    const TransferMatrix matrix(relighter, candidates, places);
    std::vector<glm::vec3> radiance;
    for (const std::size_t place : places)
        radiance.push_back(relighter.radiance()[transfer.order[place]]);
    Pursuit pursuit(matrix, radiance);
    for (const glm::dvec3& d : options.start) {
        std::size_t best = 0;
        for (std::size_t j = 0; j < candidates.size(); ++j)
            if (glm::dot(candidates[j], d) > glm::dot(candidates[best], d))
                best = j;
        pursuit.take_this(best);
    }
    if (!options.start.empty())
        pursuit.fit();
    fprintf(stderr, "start %zu error %.5f\n", pursuit.num_lights(), pursuit.error(radiance));
    for (std::size_t i = 0; i < std::min(count, candidates.size()) - options.start.size() && pursuit.take_best(); ++i) {
        if (options.stop.stop_requested())
            throw prt::Cancelled();
        if (options.on_progress)
            options.on_progress(static_cast<double>(i + 1) / static_cast<double>(count));
    }
    for (int pass = 0; pass < ExchangePasses && pursuit.num_lights() <= MaxExchanged; ++pass)
    {
        fprintf(stderr, "pass %d error %.5f\n", pass, pursuit.error(radiance));
        if (!pursuit.exchange())
            break;
    }

    std::vector<lights::DistantLight> chosen;
    for (std::size_t light = 0; light < pursuit.num_lights(); ++light)
        if (pursuit.irradiance(light) != Rgb(0.0))
            chosen.push_back({.direction = candidates[pursuit.candidate(light)],
                              .irradiance = pursuit.irradiance(light)});
    return chosen;
}

} // namespace relumine::relight
