#include "cubemap/layers/region.h"

#include <algorithm>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>

#include "cubemap/layers/shapes/sphere_lines.h"

namespace relumine::cubemap {

namespace {

/// Returns the rotation that takes one direction to another on the shortest way.
glm::dmat3 rotation_between(const glm::dvec3& from, const glm::dvec3& to) {
    const glm::dvec3 a = glm::normalize(from);
    const glm::dvec3 b = glm::normalize(to);
    const glm::dvec3 axis = glm::cross(a, b);
    const double cosine = glm::dot(a, b);
    if (cosine < -0.999999) { // opposite: no shortest way, half a turn about any axis across
        const glm::dvec3 across = any_across(a);
        return 2.0 * glm::outerProduct(across, across) - glm::dmat3(1.0);
    }
    // Rodrigues' formula: R = c I + [axis]x + axis axis^T / (1 + c); columns.
    const double k = 1.0 / (1.0 + cosine);
    return {glm::dvec3(cosine + k * axis.x * axis.x, axis.z + k * axis.x * axis.y,
                       -axis.y + k * axis.x * axis.z),
            glm::dvec3(-axis.z + k * axis.x * axis.y, cosine + k * axis.y * axis.y,
                       axis.x + k * axis.y * axis.z),
            glm::dvec3(axis.y + k * axis.x * axis.z, -axis.x + k * axis.y * axis.z,
                       cosine + k * axis.z * axis.z)};
}

/// Changes every direction and point of a region.
template<typename Change>
void change_directions(Region& region, const Change& change) {
    for (const LayerField& field : fields(region)) {
        if (field.direction != nullptr)
            *field.direction = change(*field.direction);
        if (field.points != nullptr)
            std::transform(field.points->begin(), field.points->end(), field.points->begin(),
                           change);
    }
}

/// For reading.
std::vector<LayerField> fields_of(const Region& region) {
    return fields(const_cast<Region&>(region));
}

} // namespace

double smoothstep(double t) {
    const double c = std::clamp(t, 0.0, 1.0);
    return c * c * (3.0 - 2.0 * c);
}

std::string_view type_name(const Region& region) {
    return words(region).name;
}

const ShapeWords& words(const Region& region) {
    return std::visit(
        []<typename Shape>(const Shape&) -> const ShapeWords& { return Shape::Words; }, region);
}

std::vector<LayerField> fields(Region& region) {
    return std::visit([](auto& kind) { return kind.fields(); }, region);
}

Region as_added(const Region& shape) {
    return std::visit([]<typename Shape>(const Shape&) -> Region { return Shape::as_added(); },
                      shape);
}

void validate(const Region& region) {
    for (const LayerField& field : fields_of(region))
        check(field);
    std::visit([](const auto& kind) { kind.check(); }, region);
}

RegionShape shape(const Region& region) {
    validate(region);
    return std::visit(
        []<typename Shape>(const Shape& kind) -> RegionShape {
            return typename Shape::Prepared(kind);
        },
        region);
}

double coverage(const Region& region, const glm::dvec3& direction) {
    glm::dvec3 checked = direction;
    check(direction_field(checked));
    return std::visit(
        [w = glm::normalize(direction)](const auto& prepared) {
            double product = 1.0;
            for (const double ramp : prepared.ramps(w))
                product *= smoothstep(ramp);
            return product;
        },
        shape(region));
}

Region hardened(Region region) {
    for (const LayerField& field : fields(region))
        if (field.name.starts_with("softness"))
            *field.number = 0.0;
    return region;
}

glm::dvec3 middle(const Region& region) {
    for (const LayerField& field : fields_of(region)) {
        if (field.direction != nullptr)
            return glm::normalize(*field.direction);
        if (field.points != nullptr)
            return mean_direction(*field.points);
    }
    return {0.0, 0.0, 1.0};
}

std::vector<glm::dvec3> outline(const Region& region) {
    return std::visit([](const auto& kind) { return kind.outline(); }, region);
}

Region turned(Region region, double degrees_about_y) {
    std::visit([&](auto& kind) { kind.turn_upright(degrees_about_y); }, region);
    change_directions(region, [&](const glm::dvec3& w) { return turned(w, degrees_about_y); });
    return region;
}

Region moved(Region region, const glm::dvec3& from, const glm::dvec3& to) {
    change_directions(region, [rotation = rotation_between(from, to)](const glm::dvec3& w) {
        return rotation * w;
    });
    return region;
}

Region centred(Region region, const glm::dvec3& direction) {
    const glm::dvec3 from = middle(region);
    return moved(std::move(region), from, direction);
}

Region resized(Region region, const glm::dvec3& from, const glm::dvec3& to) {
    std::visit([&](auto& kind) { kind.resize(glm::normalize(from), glm::normalize(to)); }, region);
    return region;
}

} // namespace relumine::cubemap
