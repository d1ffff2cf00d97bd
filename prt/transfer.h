// The result of the precompute: light clusters and how much of each reaches every receiver.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/clusters/quadtree.h"
#include "prt/clusters/visible_counts.h"
#include "prt/glossy/glossy_transfer.h"
#include "prt/glossy/surface.h"
#include "prt/receivers/receivers.h"

namespace relumine::prt {

/// Light transfer of a set of receivers. The diffuse part is for albedo 1, colour is a factor
/// applied when the light is known: T_C(x) = c(x, C)/16 * max(dot(n(x), w), 0) / pi, unit 1/sr [JN,
/// Eqs. 2 and 10]. Immutable once made.
struct Transfer {
    /// Its leaves are the clusters
    Quadtree quadtree;
    /// [num_receivers] place in spatial order -> receiver index
    std::vector<std::uint32_t> order;
    /// [num_receivers] by place, unit or zero
    std::vector<glm::vec3> normals;
    /// By place
    VisibleCounts counts;
    /// [num_receivers] by place; or empty: Lambert, albedo 1
    std::vector<Surface> surfaces = {};
    /// What depends on the view; only with surfaces
    std::optional<GlossyTransfer> glossy = {};

    [[nodiscard]] std::size_t num_receivers() const { return order.size(); }
    [[nodiscard]] std::size_t num_clusters() const { return quadtree.num_leaves(); }
};

/// Copies the receivers' surfaces, and for a glossy part their directions to the eye, into the
/// transfer.
void set_surfaces(Transfer& transfer, const Receivers& receivers);

} // namespace relumine::prt
