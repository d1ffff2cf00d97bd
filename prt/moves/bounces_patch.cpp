#include "prt/moves/bounces_patch.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <utility>

namespace relumine::prt {

namespace {

std::vector<std::uint32_t> without(std::span<const std::uint32_t> all,
                                   std::span<const std::uint32_t> some) {
    std::vector<std::uint32_t> result;
    std::ranges::set_difference(all, some, std::back_inserter(result));
    return result;
}

/// Moves the beginnings behind each list of a patch by the sizes of its own list there.
void shift(PlaceLists& lists, const ListsPatch& patch, const PlaceLists& by, bool is_forward) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < patch.lists.size(); ++i) {
        sum += by[i].size();
        const std::size_t end = i + 1 < patch.lists.size() ? patch.lists[i + 1] : lists.size();
        for (std::size_t list = patch.lists[i] + std::size_t{1}; list <= end; ++list)
            lists.begin[list] = is_forward ? lists.begin[list] + sum : lists.begin[list] - sum;
    }
}

/// Takes places out, from the front.
void remove(PlaceLists& lists, const ListsPatch& patch) {
    std::uint32_t* const places = lists.places.data();
    std::uint32_t* to = places;
    const std::uint32_t* from = places;
    const auto keep_up_to = [&](const std::uint32_t* end) {
        if (to != from)
            std::copy(from, end, to);
        to += end - from;
        from = end;
    };
    for (std::size_t i = 0; i < patch.lists.size(); ++i) {
        const std::uint32_t* const end = places + lists.begin[patch.lists[i] + std::size_t{1}];
        keep_up_to(places + lists.begin[patch.lists[i]]);
        for (const std::uint32_t gone : patch.removed[i]) {
            keep_up_to(std::lower_bound(from, end, gone));
            ++from;
        }
    }
    keep_up_to(places + lists.places.size());
    lists.places.resize(static_cast<std::size_t>(to - places));
    shift(lists, patch, patch.removed, false);
}

/// Puts places in, from the back.
void add(PlaceLists& lists, const ListsPatch& patch) {
    const std::size_t size = lists.places.size(), more = patch.added.places.size();
    if (size + more > lists.places.capacity())
        lists.places.reserve(size + more + (size + more) / 64); // the next move hardly needs more
    lists.places.resize(size + more);
    std::uint32_t* const places = lists.places.data();
    std::uint32_t* to = places + size + more;
    const std::uint32_t* from = places + size;
    const auto keep_down_to = [&](const std::uint32_t* begin) {
        if (to != from)
            std::copy_backward(begin, from, to);
        to -= from - begin;
        from = begin;
    };
    for (std::size_t i = patch.lists.size(); i-- > 0;) {
        const std::uint32_t* const begin = places + lists.begin[patch.lists[i]];
        keep_down_to(places + lists.begin[patch.lists[i] + std::size_t{1}]);
        const std::span<const std::uint32_t> added = patch.added[i];
        for (std::size_t k = added.size(); k-- > 0;) {
            keep_down_to(std::upper_bound(begin, from, added[k]));
            *--to = added[k];
        }
    }
    shift(lists, patch, patch.added, true);
}

} // namespace

void ListsPatch::append(std::uint32_t list, std::span<const std::uint32_t> removes,
                        std::span<const std::uint32_t> adds) {
    const std::vector<std::uint32_t> lost = without(removes, adds), won = without(adds, removes);
    if (lost.empty() && won.empty())
        return;
    lists.push_back(list);
    removed.append(lost);
    added.append(won);
}

ListsPatch difference(const PlaceLists& from, const PlaceLists& to) {
    ListsPatch patch;
    for (std::uint32_t list = 0; list < from.size(); ++list)
        if (!std::ranges::equal(from[list], to[list]))
            patch.append(list, from[list], to[list]);
    return patch;
}

void exchange(PlaceLists& lists, ListsPatch& patch) {
    if (patch.lists.empty())
        return;
    remove(lists, patch);
    add(lists, patch);
    std::swap(patch.removed, patch.added);
}

void exchange(BounceMatrix& matrix, BouncesPatch& patch) {
    exchange(matrix.emitters, patch.emitters);
    exchange(matrix.averaged, patch.averaged);
    matrix.weights.swap(patch.weights);
    matrix.rays.distances.swap(patch.distances);
    matrix.rays.num_hits.swap(patch.num_hits);
    std::swap(matrix.spectral_radius, patch.spectral_radius);
    std::swap(matrix.rays.early_radius, patch.early_radius);
}

} // namespace relumine::prt
