// Work on a list whose elements do not depend on each other, shared by processes.
#pragma once

#include <cstddef>
#include <cstring>
#include <span>
#include <stdexcept>
#include <type_traits>
#include <vector>

#include "prt/team.h"

namespace relumine {

/// Returns compute(indices): a value for each index. Where processes share the work, each computes
/// a slice of neighbours, and all get all values. Null: this process does it all.
///
/// Throws:  as Team::sum().
template<typename Value, typename Index, typename Compute>
std::vector<Value> in_slices(prt::Team* team, std::span<const Index> indices,
                             const Compute& compute) {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (team == nullptr)
        return compute(indices);
    const prt::Part part = team->part();
    const auto begin_of = [&](std::size_t process) {
        return indices.size() * process / part.count;
    };
    const std::size_t begin = begin_of(part.index);
    const std::vector<Value> own =
        compute(indices.subspan(begin, begin_of(part.index + 1) - begin));
    std::vector<Value> values(indices.size());
    std::size_t at = 0;
    for (const std::vector<std::byte>& slice : team->all_gather(prt::to_send(std::span(own)))) {
        if (slice.size() > (values.size() - at) * sizeof(Value))
            throw std::runtime_error("expected a value of each index");
        if (!slice.empty())
            std::memcpy(values.data() + at, slice.data(), slice.size());
        at += slice.size() / sizeof(Value);
    }
    if (at != values.size())
        throw std::runtime_error("expected a value of each index");
    return values;
}

} // namespace relumine
