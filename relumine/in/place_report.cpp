#include "relumine/in/place_report.h"

#include <fmt/format.h>

#include "relumine/in/places.h"

namespace relumine {

std::string place_text(const mesh::TriangleMesh& mesh, const glm::vec3& position) {
    if (mesh.offset == glm::dvec3(0.0))
        return fmt::format("{}, {}, {}", position.x, position.y, position.z);
    const glm::dvec3 place = place_of(mesh, position);
    return fmt::format("{:.10g}, {:.10g}, {:.10g}", place.x, place.y, place.z);
}

files::Json place_json(const mesh::TriangleMesh& mesh, const glm::vec3& position) {
    if (mesh.offset == glm::dvec3(0.0))
        return files::Json(position);
    return files::Json(place_of(mesh, position));
}

} // namespace relumine
