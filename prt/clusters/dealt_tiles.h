// Which receivers each part of a precompute has.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "prt/team.h"

namespace relumine::prt {

/// Returns the places in spatial order of a part's receivers, ascending: every count-th tile of
/// VisibleCounts. So groups of receivers that are traced together, and runs of the sums, are the
/// same in any number of parts.
[[nodiscard]] std::vector<std::uint32_t> places_of(const Part& part, std::size_t num_receivers);

/// Where a receiver is among those of its part.
struct OwnPlace {
    std::uint32_t part = 0;
    std::size_t index = 0;
};

/// Returns the part that has a place, and the index that places_of() gives it there.
[[nodiscard]] OwnPlace own_place(std::size_t place, std::size_t num_parts);

/// Gives each process the values of all receivers: those of its own part are there already.
///
/// Shape:   `values` is [num_receivers] by place, the same number in all processes.
/// Throws:  as Team::sum().
template<typename Value>
void share_by_place(Team& team, std::span<Value> values) {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (!team.has_others())
        return;
    std::vector<Value> own;
    for (const std::uint32_t place : places_of(team.part(), values.size()))
        own.push_back(values[place]);
    const auto of_all = team.all_gather(to_send(std::span(own)));
    for (std::uint32_t index = 0; index < of_all.size(); ++index) {
        const std::vector<std::uint32_t> places =
            places_of({index, team.part().count}, values.size());
        if (of_all[index].size() != places.size() * sizeof(Value))
            throw std::runtime_error("expected the values of all receivers from all processes");
        for (std::size_t i = 0; i < places.size(); ++i)
            std::memcpy(&values[places[i]], of_all[index].data() + i * sizeof(Value),
                        sizeof(Value));
    }
}

} // namespace relumine::prt
