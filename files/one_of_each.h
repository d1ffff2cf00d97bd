// The kinds of a variant as values, for lists of names and for readers that look one up.
#pragma once

#include <array>
#include <cstddef>
#include <utility>
#include <variant>

namespace relumine::files {

/// Returns a default value of each type of a variant.
template<typename Variant>
[[nodiscard]] auto one_of_each() {
    return []<std::size_t... I>(std::index_sequence<I...>) {
        return std::array{Variant(std::in_place_index<I>)...};
    }(std::make_index_sequence<std::variant_size_v<Variant>>{});
}

} // namespace relumine::files
