#include "viewer/thing_hand.h"

#include <utility>

#include <glm/geometric.hpp>

namespace relumine::viewer {

std::optional<SeenThing> thing_at(const LitScene& lit, const Ray& ray) {
    const Scene& scene = lit.scene();
    require_movable(scene);
    const std::optional<prt::Hit> hit =
        lit.rays().of_mesh().closest_hit(ray.origin, ray.direction, prt::RayOf::Eye);
    if (!hit)
        return std::nullopt;
    return SeenThing{.name = scene.mesh.groups[scene.mesh.triangle_groups[hit->triangle]],
                     .point = ray.origin + hit->distance * ray.direction};
}

std::optional<glm::dvec3> step_to(const glm::dvec3& point, const Ray& ray, const glm::vec3& normal,
                                  double reach) {
    const glm::dvec3 plane(normal), origin(ray.origin), direction(ray.direction);
    const double distance = glm::dot(plane, point - origin) / glm::dot(plane, direction);
    if (!(distance > 0.0 && distance < reach))
        return std::nullopt;
    return origin + distance * direction - point;
}

bool ThingHand::begin(const Ray& ray) {
    const std::optional<SeenThing> seen = thing_at(desk_.lit(), ray);
    if (!seen)
        return false;
    middle_ = middle_of(desk_.lit().scene(), seen->name);
    point_ = seen->point;
    step_ = GroupStep{.name = seen->name};
    is_shown_ = false;
    return true;
}

void ThingHand::move_to(const Ray& ray, const glm::vec3& normal, double turn_degrees) {
    if (!step_)
        return;
    if (is_shown_ && !desk_.is_dragging()) { // undo took it back
        let_go();
        return;
    }
    constexpr double ManyScenes = 4.0;
    const double reach =
        ManyScenes * static_cast<double>(mesh::bounds(desk_.lit().scene().mesh).diagonal() +
                                         glm::length(ray.origin - glm::vec3(point_)));
    const glm::dvec3 by = step_to(point_, ray, normal, reach).value_or(glm::dvec3(0.0));
    if (by == glm::dvec3(0.0) && turn_degrees == 0.0)
        return;
    point_ += by;
    step_->by += by;
    step_->degrees += turn_degrees;
    try {
        desk_.drag(move_of(*step_, middle_));
    } catch (...) {
        let_go();
        throw;
    }
    is_shown_ = true;
    seconds_.push_back(desk_.last_cost().seconds);
}

void ThingHand::let_go() {
    step_.reset();
    if (desk_.is_dragging())
        desk_.undo();
}

void ThingHand::end() {
    if (!std::exchange(step_, std::nullopt) || !desk_.is_dragging())
        return;
    desk_.drop();
}

void ThingHand::take_away() {
    if (!step_)
        return;
    const std::string name = step_->name;
    let_go();
    desk_.move({.name = name, .going = Going::Away});
}

} // namespace relumine::viewer
