#include "relight/surfaces/other_side.h"

#include "prt/glossy/surface_sampling.h"

namespace relumine::relight {

std::optional<OtherSide> other_side(const mesh::TriangleMesh& mesh, const prt::MeshPoint& point,
                                    const MeshLight& light, const prt::TwinTriangles& twins,
                                    const prt::TextureView* view) {
    if (light.textures == nullptr || !light.textures->has(point.triangle) ||
        !prt::passes_light_on(mesh, point.triangle))
        return std::nullopt;
    const auto behind = twins.other_side({point.triangle, point.barycentric});
    if (!behind)
        return std::nullopt;
    return OtherSide{{behind->triangle, behind->barycentric}, prt::passed_on_at(mesh, point, view)};
}

} // namespace relumine::relight
