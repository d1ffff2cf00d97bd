// Which cells of the sky a block of receivers is lit from through its highlight: a cut of the
// quadtree, made while the eye moves.
//
// Based on: R. Ng, R. Ramamoorthi, P. Hanrahan, "Triple Product Wavelet Integrals for All-Frequency
// Relighting", SIGGRAPH 2004: light, visibility and BRDF apart. Differs: in cells, not in wavelets,
// so that each block stops where the product needs nothing finer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "relight/moving_eye/eye_kernel.h"
#include "relight/moving_eye/sky_cells.h"
#include "relight/moving_eye/visibility_pyramid.h"

namespace relumine::relight {

/// The lobes of a block's receivers as one.
struct BlockLobe {
    /// Means, unit length.
    glm::vec3 normal, to_eye;
    float n_v = 0.0f;
    /// The square of the narrowest lobe's alpha.
    float alpha2 = 1.0f;
    /// How far the receivers' half vectors are from the mean's, seen from their normals.
    float spread = 0.0f;
    /// Factor on the lobe in radiance.
    float weight = 0.0f;
};

/// Returns the lobe of the receivers that face the eye; nothing where none has a highlight and
/// does.
///
/// Shape:   surfaces has one element per receiver of the block.
[[nodiscard]] std::optional<BlockLobe> lobe_of(const prt::BlockSurfaces& block,
                                               std::span<const prt::Surface> surfaces);

/// Finds cuts. For one thread.
class EyeCut {
public:
    /// Both must outlive this object. A cell stays whole where its share of a block's radiance is
    /// off by no more than `error`, or some more for lobes narrower than roughness 0.3.
    EyeCut(const VisibilityPyramid& visibility, const SkyCells& sky, float error)
        : visibility_(visibility), sky_(sky), error_(error) {}

    /// A cell of the sky that is divided, and how the block sees it.
    struct Item {
        std::uint32_t cell = 0;
        /// Children that are part of the cut, and those that are divided further: a bit each.
        std::uint16_t whole = 0, divided = 0;
        VisibilityPyramid::Place place = {};
    };

    /// Appends the cells that light a block through a lobe. Faces are always divided.
    void find(std::size_t block, const BlockLobe& lobe, LitCells& cells);

    /// Returns the cells that the last search divided; good until the next one.
    [[nodiscard]] std::span<const Item> divided() const {
        return std::span(search_.divided).first(search_.num_divided);
    }

    /// Takes the last change of the sky to a cut, by the cells that its search divided: appends
    /// the light that came, and the light that went with a negative part. Returns false where
    /// other cells would be divided now: the cut must be found again, and what was appended is of
    /// no use.
    ///
    /// Cost:    that of cells above the change, in place of all.
    [[nodiscard]] bool update(std::size_t block, const BlockLobe& lobe, std::span<Item> divided,
                              LitCells& cells) const;

    /// A cell that receivers see in part.
    struct Partly {
        CellLight light = nullptr;
        VisibilityPyramid::Place place = {};
    };
    /// What a search has found; its room stays for the next one.
    struct Search {
        /// Cells that are divided, coarse ones first.
        std::vector<Item> divided;
        std::vector<CellLight> open;
        std::vector<Partly> partly;
        std::size_t num_divided = 0, num_open = 0, num_partly = 0;
    };

private:
    const VisibilityPyramid& visibility_;
    const SkyCells& sky_;
    float error_;
    Search search_;
};

} // namespace relumine::relight
