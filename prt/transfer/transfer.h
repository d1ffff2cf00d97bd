// The result of the precompute: light clusters, and how much of each reaches every receiver.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

#include "prt/receivers/receivers.h"
#include "prt/receivers/surface.h"
#include "prt/transfer/glossy_transfer.h"
#include "prt/transfer/quadtree.h"
#include "prt/transfer/visible_counts.h"

namespace relumine::prt {

/// Light transfer of a set of receivers; immutable once made.
///
/// The diffuse part is for albedo 1: T_C(x) = c(x, C)/16 * max(dot(n(x), w), 0) / pi [JN, Eqs. 2
/// and 10]. The colour is a factor that is applied when the light is known.
///
/// Unit:    1/sr.
struct Transfer {
    /// The leaves are the clusters.
    Quadtree quadtree;
    /// [num_receivers] receiver index by place in spatial order.
    std::vector<std::uint32_t> order;
    /// [num_receivers] by place; unit length or zero.
    std::vector<glm::vec3> normals;
    /// By place.
    VisibleCounts counts;
    /// [num_receivers] by place; empty means Lambert of albedo 1 everywhere.
    std::vector<Surface> surfaces = {};
    /// The view-dependent part; present only with surfaces.
    std::optional<GlossyTransfer> glossy = {};
    /// So many places at the beginning are points without a surface: T_C(x) = c(x, C)/16 / pi.
    std::size_t num_points = 0;

    [[nodiscard]] std::size_t num_receivers() const { return order.size(); }
    [[nodiscard]] std::size_t num_clusters() const { return quadtree.num_leaves(); }
};

/// Copies the receivers' surfaces into the transfer, and for a glossy part their directions to the
/// eye. Receivers with an eye and highlights of which nothing is stored get a glossy part without
/// cells.
void set_surfaces(Transfer& transfer, const Receivers& receivers);

} // namespace relumine::prt
