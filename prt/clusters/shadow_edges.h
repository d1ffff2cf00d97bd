// What the counts of four cells say of the samples of the cell that they make up.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "prt/clusters/lattice.h"

namespace relumine::prt {

/// The chance that a sample is lit, by counts. Shadows have edges that are straight lines across a
/// cell, of all directions and places alike.
///
/// So a cell of 15 sixteenths has one dark corner, any of four; where it is known that its
/// neighbours to the right and below see all, the dark corner is the other one.
class ShadowEdges {
public:
    ShadowEdges();

    /// The chances of the nine samples of a cell, by the counts of its children.
    using Chances = std::array<float, SamplesPerCell>;

    /// Returns the chance that a corner of a cell with this count is lit.
    [[nodiscard]] float corner(std::size_t count) const { return corners_[count]; }

    /// Returns the chances where a line makes these counts, and null where none does.
    [[nodiscard]] const Chances* samples(const std::array<std::uint8_t, 4>& children) const {
        const std::uint16_t entry = entries_[key(children)];
        return entry == 0 ? nullptr : &chances_[entry - 1u];
    }

private:
    static constexpr std::size_t Counts = FullCount + 1;
    [[nodiscard]] static std::size_t key(const std::array<std::uint8_t, 4>& children) {
        return children[0] + Counts * (children[1] + Counts * (children[2] + Counts * children[3]));
    }

    std::array<float, Counts> corners_{};
    /// By key(): 0, or 1 more than the place in `chances_`.
    std::vector<std::uint16_t> entries_;
    std::vector<Chances> chances_;
};

} // namespace relumine::prt
