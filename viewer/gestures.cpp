#include "viewer/gestures.h"

#include <utility>
#include <variant>

namespace relumine::viewer {

namespace {

glm::dvec3 before_turn(const LightDesk& desk, const glm::dvec3& direction) {
    return turned(direction, -desk.state().rotation_degrees);
}

} // namespace

Held held_at(const LightDesk& desk, const glm::dvec3& direction, double tolerance_degrees) {
    const auto layers = desk.layers();
    const auto held = [&](std::size_t index) {
        return Held{index,
                    grip_at(layers[index].region, before_turn(desk, direction), tolerance_degrees)};
    };
    if (desk.selected())
        if (const Held selected = held(*desk.selected()); selected.grip != Grip::None)
            return selected;
    for (std::size_t i = layers.size(); i-- > 0;)
        if (layers[i].on)
            if (const Held here = held(i); here.grip != Grip::None)
                return here;
    return {};
}

void Gestures::begin_drag(const Held& held, const glm::dvec3& direction) {
    if (held.grip == Grip::None)
        return;
    desk_.select(held.index);
    drag_ = Drag{.held = held,
                 .region = desk_.layers()[held.index].region,
                 .from = before_turn(desk_, direction)};
}

void Gestures::begin_stroke(const cubemap::LightLayer& brush, const glm::dvec3& direction) {
    cubemap::LightLayer layer = brush;
    std::get<cubemap::Stroke>(layer.region).points = {before_turn(desk_, direction)};
    put_on_top(desk_, std::move(layer));
    seconds_.push_back(desk_.last_cost().seconds);
    painting_ = true;
}

void Gestures::move_to(const glm::dvec3& direction, double lasso_spacing_degrees) {
    if (!drag_ && !painting_) {
        if (!lasso_.empty() && angle_between(lasso_.back(), direction) >= lasso_spacing_degrees)
            lasso_.push_back(direction);
        return;
    }
    const std::size_t index = drag_ ? drag_->held.index : desk_.layers().size() - 1;
    const glm::dvec3 to = before_turn(desk_, direction);
    cubemap::LightLayer layer = desk_.layers()[index];
    if (drag_) {
        layer.region = drag_->held.grip == Grip::Body ? moved(drag_->region, drag_->from, to)
                                                      : resized(drag_->region, drag_->from, to);
    } else {
        auto& stroke = std::get<cubemap::Stroke>(layer.region);
        if (angle_between(stroke.points.back(), to) < 0.25 * stroke.radius_degrees)
            return;
        stroke.points.push_back(to);
    }
    change(desk_, index, layer);
    seconds_.push_back(desk_.last_cost().seconds);
}

void Gestures::end() {
    if (!drag_ && !painting_)
        return;
    drag_.reset();
    painting_ = false;
    desk_.finish();
}

bool Gestures::end_lasso(cubemap::LightLayer layer) {
    std::vector<glm::dvec3> points = std::exchange(lasso_, {});
    if (points.size() < 3)
        return false;
    for (glm::dvec3& point : points)
        point = before_turn(desk_, point);
    std::get<cubemap::Lasso>(layer.region).points = std::move(points);
    add(desk_, std::move(layer));
    return true;
}

} // namespace relumine::viewer
