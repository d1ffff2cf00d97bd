// The light of all cells of all levels, for receivers that each cut the quadtree in their own way.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cubemap/cube_map.h"
#include "lights/light_list.h"
#include "prt/transfer/cell_index.h"
#include "relight/kernels/cluster_lights.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

/// Sum of L_j dw_j over the texels j of each cell, RGB.
///
/// Unit:    radiance times sr.
class LightPyramid {
public:
    /// Covers cells down to `deepest_level`.
    ///
    /// Memory:  12 bytes per cell, about 8 * 4^level cells.
    explicit LightPyramid(std::uint32_t deepest_level);

    /// Sums a whole environment without the lights in `without`, which are lit in another way.
    /// `binning` has the environment's resolution. Any resolution works: texels on borders of cells
    /// are shared by area.
    ///
    /// Cost:    O(6 R^2 + cells).
    /// Threads: parallel; the same bits for any number of threads.
    void set(const cubemap::CubeMap& environment, const LightBinning& binning,
             std::span<const SharpLight> without);

    /// Takes distant lights in place of an environment. Each light goes into the deepest cell that
    /// holds it.
    void set_lights(std::span<const lights::DistantLight> lights);

    /// [num_cells * 3] by prt::cell_index(): red, green, blue.
    [[nodiscard]] std::span<const float> light() const { return light_; }

private:
    void set_deepest(const cubemap::CubeMap& environment, const LightBinning& binning);
    void remove(const SharpLight& sharp);
    void sum_levels();

    std::uint32_t deepest_level_;
    /// The resolution of solid_angles_.
    std::uint32_t resolution_ = 0;
    /// [n * n], n = the finer of texels and cells along a face's edge.
    std::vector<double> solid_angles_;
    std::vector<float> light_;
};

} // namespace relumine::relight
