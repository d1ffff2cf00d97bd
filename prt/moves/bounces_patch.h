// Bounces that replace some of a matrix, and go back.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "prt/bounces/bounce_matrix.h"

namespace relumine::prt {

/// What some lists of PlaceLists lose and get.
struct ListsPatch {
    /// Ascending
    std::vector<std::uint32_t> lists = {};
    /// For each of them, ascending; a place as often as it goes or comes
    PlaceLists removed = {}, added = {};

    /// Adds a list behind those that are there, unless nothing of it differs. The places are
    /// ascending; what is among both stays.
    void append(std::uint32_t list, std::span<const std::uint32_t> removes,
                std::span<const std::uint32_t> adds);
};

/// Returns what leads from some lists to others, as many.
[[nodiscard]] ListsPatch difference(const PlaceLists& from, const PlaceLists& to);

/// Makes the changes of a patch, which then takes them back. Lists have what they are to lose.
///
/// Cost:    O(all places), which move within their memory.
void exchange(PlaceLists& lists, ListsPatch& patch);

/// What a move changes in a matrix of bounces, to be exchanged with what the matrix has.
///
/// Memory:  12 bytes for each row, and the places that are others.
struct BouncesPatch {
    ListsPatch emitters = {}, averaged = {};
    /// As BounceMatrix and BounceRays have them
    std::vector<float> weights = {}, distances = {};
    std::vector<std::uint32_t> num_hits = {};
    float spectral_radius = 0.0f, early_radius = 0.0f;
};

/// A second call undoes the first.
void exchange(BounceMatrix& matrix, BouncesPatch& patch);

} // namespace relumine::prt
