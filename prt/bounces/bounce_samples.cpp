#include "prt/bounces/bounce_samples.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "prt/bounces/matrix_rows.h"
#include "prt/bounces/similar_receivers.h"
#include "prt/clusters/dealt_tiles.h"

namespace relumine::prt {

namespace {

void require_samples(bool condition) {
    if (!condition)
        throw std::invalid_argument("expected the bounces of all receivers");
}

/// Puts lists of all parts together by their places. Frees those of the parts.
template<typename ListsOf>
PlaceLists joined_lists(std::span<BounceSamples> parts, std::size_t num_receivers,
                        const ListsOf& lists_of) {
    if (parts.size() == 1)
        return std::move(lists_of(parts[0]));
    PlaceLists joined;
    for (std::size_t place = 0; place < num_receivers; ++place) {
        const OwnPlace own = own_place(place, parts.size());
        joined.append(lists_of(parts[own.part])[own.index]);
    }
    for (BounceSamples& part : parts)
        lists_of(part) = {};
    return joined;
}

template<typename Value, typename ValuesOf>
std::vector<Value> joined_values(std::span<const BounceSamples> parts, std::size_t num_receivers,
                                 const ValuesOf& values_of) {
    std::vector<Value> joined(num_receivers);
    for (std::size_t place = 0; place < num_receivers; ++place) {
        const OwnPlace own = own_place(place, parts.size());
        joined[place] = values_of(parts[own.part])[own.index];
    }
    return joined;
}

PlaceLists joined_averaged(std::span<BounceSamples> parts, const Receivers& receivers,
                           const Transfer& transfer) {
    const std::size_t n = transfer.num_receivers();
    if (parts.front().averaged)
        return joined_lists(parts, n,
                            [](BounceSamples& part) -> PlaceLists& { return *part.averaged; });
    const std::vector<float> distances = joined_values<float>(
        parts, n, [](const BounceSamples& part) -> const auto& { return part.distances; });
    std::vector<std::uint32_t> all(n);
    std::iota(all.begin(), all.end(), 0u);
    return shared_samples(receivers, transfer, 0, n, distances, all);
}

/// Parts without points say nothing of directions.
PointRows joined_points(std::span<BounceSamples> parts, std::size_t num_points) {
    std::size_t width = 0;
    for (const BounceSamples& part : parts)
        width = std::max<std::size_t>(width, part.points.num_directions);
    const auto num_parts = static_cast<std::uint32_t>(parts.size());
    for (std::uint32_t i = 0; i < num_parts; ++i)
        require_samples(parts[i].points.emitters.size() ==
                        places_of({i, num_parts}, num_points).size() * width);
    if (parts.size() == 1)
        return std::move(parts[0].points);
    PointRows joined{.num_directions = static_cast<std::uint32_t>(width)};
    joined.emitters.reserve(num_points * width);
    for (std::size_t place = 0; place < num_points; ++place) {
        const OwnPlace own = own_place(place, parts.size());
        const auto row =
            std::span(parts[own.part].points.emitters).subspan(own.index * width, width);
        joined.emitters.insert(joined.emitters.end(), row.begin(), row.end());
    }
    return joined;
}

} // namespace

double closed_part(const glm::vec3& normal, float open_part) {
    if (normal == glm::vec3(0.0f))
        return 0.0;
    return std::clamp(1.0 - static_cast<double>(open_part), 0.0, 1.0);
}

PlaceLists shared_samples(const Receivers& receivers, const Transfer& transfer, std::size_t begin,
                          std::size_t end, std::span<const float> distances,
                          std::span<const std::uint32_t> wanted, const PlaceLists* before) {
    std::vector<glm::vec3> positions;
    for (std::size_t place = begin; place < end; ++place)
        positions.push_back(receivers.positions[transfer.order[place]]);
    const auto is_added = [&receivers](std::uint32_t receiver) {
        return receiver >= receivers.num_own();
    };
    const auto at = [&transfer](std::size_t place) {
        return transfer.order.begin() + static_cast<std::ptrdiff_t>(place);
    };
    const auto first_added = static_cast<std::size_t>(std::find_if(at(begin), at(end), is_added) -
                                                      transfer.order.begin());
    PlaceLists lists;
    for (const auto& [first, last] : {std::pair(begin, first_added), std::pair(first_added, end)}) {
        const std::size_t size = last - first;
        std::vector<std::uint32_t> of_range;
        for (const std::uint32_t place : wanted)
            if (place >= first && place < last)
                of_range.push_back(place - static_cast<std::uint32_t>(first));
        PlaceLists part = similar_receivers(std::span(positions).subspan(first - begin, size),
                                            std::span(transfer.normals).subspan(first, size),
                                            distances.subspan(first - begin, size), {}, of_range,
                                            {before, first});
        for (std::uint32_t& place : part.places)
            place += static_cast<std::uint32_t>(first);
        for (std::size_t i = 0; i < part.size(); ++i)
            lists.append(part[i]);
    }
    return lists;
}

float row_weight(const BounceMatrix& matrix, std::size_t place, double closure,
                 std::span<const std::uint32_t> num_hits) {
    double num_shared = 0.0, num_emitters = 0.0;
    for (const std::uint32_t other : matrix.averaged[place]) {
        num_shared += static_cast<double>(num_hits[other]);
        num_emitters += static_cast<double>(matrix.emitters[other].size());
    }
    return num_emitters > 0.0 ? static_cast<float>(closure / num_shared) : 0.0f;
}

BounceMatrix join_bounces(const Receivers& receivers, const Transfer& transfer,
                          std::vector<BounceSamples>&& parts, BounceStatistics* statistics) {
    require_samples(!parts.empty());
    const std::size_t n = transfer.num_receivers();
    BounceStatistics found;
    double squared_errors = 0.0;
    for (std::uint32_t i = 0; i < parts.size(); ++i) {
        const BounceSamples& part = parts[i];
        const std::size_t num_own =
            places_of({i, static_cast<std::uint32_t>(parts.size())}, n).size();
        require_samples(part.open_parts.size() == num_own && part.distances.size() == num_own &&
                        part.num_hits.size() == num_own && part.emitters.size() == num_own &&
                        part.averaged.has_value() == parts.front().averaged.has_value() &&
                        (!part.averaged || part.averaged->size() == num_own));
        found.num_rays += part.num_rays;
        squared_errors += part.squared_errors;
    }
    BounceMatrix result;
    result.averaged = joined_averaged(parts, receivers, transfer);
    const auto num_hits = joined_values<std::uint32_t>(
        parts, n, [](const BounceSamples& part) -> const auto& { return part.num_hits; });
    const auto open_parts = joined_values<float>(
        parts, n, [](const BounceSamples& part) -> const auto& { return part.open_parts; });
    result.emitters =
        joined_lists(parts, n, [](BounceSamples& part) -> PlaceLists& { return part.emitters; });
    const auto num_rows = static_cast<double>(n);
    for (std::size_t place = 0; place < n; ++place) {
        const double closure = closed_part(transfer.normals[place], open_parts[place]);
        result.weights.push_back(row_weight(result, place, closure, num_hits));
        found.mean_closure += closure / num_rows;
        found.num_hits += num_hits[place];
    }
    if (parts.size() == 1 && parts[0].num_directions.size() == n)
        result.rays = {std::move(parts[0].num_directions), std::move(parts[0].num_hits),
                       std::move(parts[0].distances)};
    result.points = joined_points(parts, transfer.num_points);
    result.spectral_radius = spectral_radius(result);
    found.num_emitters = result.emitters.places.size();
    found.mean_averaged = static_cast<double>(result.averaged.places.size()) / num_rows;
    found.rms_error = std::sqrt(squared_errors / num_rows);
    if (statistics != nullptr)
        *statistics = found;
    return result;
}

} // namespace relumine::prt
