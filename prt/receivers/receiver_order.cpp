#include "prt/receivers/receiver_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <span>

#include <glm/common.hpp>

#include "files/parallel.h"
#include "prt/receivers/block_size.h"
#include "prt/visibility/blockers.h"

namespace relumine::prt {

namespace {

/// Weight of a turn of the normal by one radian, as a part of the scene's extent. Best for bunny
/// and dragon; half or twice the weight costs 2 to 3 % more mixed blocks.
constexpr double NormalWeight = 1.0 / 32.0;

/// Receivers that are traced together, in whole blocks.
constexpr std::size_t GroupSize = ReceiverGroup::MaxSize;
static_assert(GroupSize % BlockSize == 0);

/// With fewer receivers a task is not worth its start.
constexpr std::size_t MinTask = 4096;

constexpr std::size_t NumAxes = 6;

struct Place {
    std::array<float, NumAxes> at{};
    std::uint32_t receiver = 0;
};

/// Returns the sum over axes of the extent, times the number of places.
float spread(std::span<const Place> places) {
    std::array<float, NumAxes> low = places.front().at;
    std::array<float, NumAxes> high = low;
    for (const Place& place : places)
        for (std::size_t axis = 0; axis < NumAxes; ++axis) {
            low[axis] = std::min(low[axis], place.at[axis]);
            high[axis] = std::max(high[axis], place.at[axis]);
        }
    float sum = 0.0f;
    for (std::size_t axis = 0; axis < NumAxes; ++axis)
        sum += high[axis] - low[axis];
    return sum * static_cast<float>(places.size());
}

/// Puts the `middle` lowest places along an axis first. Ties go by index, so the halves do not
/// depend on the order before.
void halve(std::span<Place> places, std::size_t middle, std::size_t axis) {
    std::nth_element(places.begin(), places.begin() + static_cast<std::ptrdiff_t>(middle),
                     places.end(), [axis](const Place& a, const Place& b) {
                         return a.at[axis] < b.at[axis] ||
                                (a.at[axis] == b.at[axis] && a.receiver < b.receiver);
                     });
}

void sort_into_groups(std::span<Place> places) {
    if (places.size() <= BlockSize) {
        std::sort(places.begin(), places.end(),
                  [](const Place& a, const Place& b) { return a.receiver < b.receiver; });
        return;
    }
    const std::size_t unit = places.size() > GroupSize ? GroupSize : BlockSize;
    const std::size_t middle = (places.size() + unit - 1) / unit / 2 * unit;
    std::size_t best_axis = 0;
    float best_spread = std::numeric_limits<float>::max();
    for (std::size_t axis = 0; axis < NumAxes; ++axis) {
        halve(places, middle, axis);
        const float sum = spread(places.first(middle)) + spread(places.subspan(middle));
        if (sum < best_spread) {
            best_spread = sum;
            best_axis = axis;
        }
    }
    halve(places, middle, best_axis);
    const std::array halves = {places.first(middle), places.subspan(middle)};
    if (places.size() > MinTask) {
        files::parallel_for(std::size_t{0}, halves.size(),
                            [&](std::size_t half) { sort_into_groups(halves[half]); });
    } else {
        sort_into_groups(halves[0]);
        sort_into_groups(halves[1]);
    }
}

} // namespace

std::vector<std::uint32_t> spatial_order(const Receivers& receivers) {
    glm::dvec3 low(std::numeric_limits<double>::max());
    glm::dvec3 high(std::numeric_limits<double>::lowest());
    for (const glm::vec3& position : receivers.positions) {
        low = glm::min(low, glm::dvec3(position));
        high = glm::max(high, glm::dvec3(position));
    }
    const double extent = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-300});

    std::vector<Place> places(receivers.size());
    for (std::uint32_t i = 0; i < places.size(); ++i) {
        const glm::dvec3 position = (glm::dvec3(receivers.positions[i]) - low) / extent;
        const glm::dvec3 normal = glm::dvec3(receivers.normals[i]) * NormalWeight;
        places[i].receiver = i;
        for (int axis = 0; axis < 3; ++axis) {
            places[i].at[static_cast<std::size_t>(axis)] = static_cast<float>(position[axis]);
            places[i].at[static_cast<std::size_t>(axis) + 3] = static_cast<float>(normal[axis]);
        }
    }
    const auto receives = [&](const Place& place) {
        return place.receiver < receivers.num_points() ||
               receivers.normals[place.receiver] != glm::vec3(0.0f);
    };
    const auto end_of_receiving = std::stable_partition(places.begin(), places.end(), receives);
    const auto end_of_own =
        std::partition_point(places.begin(), end_of_receiving, [&](const Place& place) {
            return place.receiver < receivers.num_own();
        });
    const std::span<Place> all(places);
    const auto num_own = static_cast<std::size_t>(end_of_own - places.begin());
    const auto num_receiving = static_cast<std::size_t>(end_of_receiving - places.begin());
    sort_into_groups(all.first(num_own));
    sort_into_groups(all.subspan(num_own, num_receiving - num_own));
    sort_into_groups(all.subspan(num_receiving));

    std::vector<std::uint32_t> order(places.size());
    std::transform(places.begin(), places.end(), order.begin(),
                   [](const Place& place) { return place.receiver; });
    return order;
}

} // namespace relumine::prt
