// The light of all cells of all levels, for receivers that each cut the quadtree in their own way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "prt/clusters/cell_index.h"
#include "relight/cluster_lights.h"
#include "relight/sharp_lights.h"

namespace relumine::relight {

/// Sum of L_j dw_j over the texels j of each cell, RGB, unit of radiance times sr.
class LightPyramid {
public:
    /// Cells down to `deepest_level`. Memory: 12 bytes a cell, 8 * 4^level cells.
    explicit LightPyramid(std::uint32_t deepest_level);

    /// Sums a whole environment but for the lights in `without`, which are lit in another way.
    /// `binning` is of the environment's resolution; any resolution will do, texels on borders of
    /// cells are shared by area. O(6 R^2 + cells); parallel, the same bits for any number of
    /// threads.
    void set(const cubemap::CubeMap& environment, const LightBinning& binning,
             std::span<const SharpLight> without);

    /// Distant lights in place of an environment, each in the deepest cell that holds it.
    void set_lights(std::span<const lights::DistantLight> lights);

    /// [num_cells * 3] by prt::cell_index(), red, green, blue.
    [[nodiscard]] std::span<const float> light() const { return light_; }

private:
    void set_deepest(const cubemap::CubeMap& environment, const LightBinning& binning);
    void remove(const SharpLight& sharp);
    void sum_levels();

    std::uint32_t deepest_level_;
    /// That solid_angles_ are of
    std::uint32_t resolution_ = 0;
    /// [n * n] of the finer of texels and cells
    std::vector<double> solid_angles_;
    std::vector<float> light_;
};

} // namespace relumine::relight
