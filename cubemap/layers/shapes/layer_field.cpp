#include "cubemap/layers/shapes/layer_field.h"

#include <cassert>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::cubemap {

namespace {

void check_direction(std::string_view what, const glm::dvec3& direction) {
    // The square must also be finite and above 0, or normalising would fail.
    if (!std::isnormal(glm::dot(direction, direction)))
        refuse(what, "of finite length above 0",
               fmt::format("({}, {}, {})", direction.x, direction.y, direction.z));
}

void check_number(const LayerField& field) {
    const auto& [from, to] = field.range;
    const double value = *field.number;
    if (std::isinf(from) && std::isinf(to)) {
        if (!std::isfinite(value))
            refuse(field.name, "to be finite", fmt::format("{}", value));
    } else if (value > 0.0 && value < field.least_but_zero) {
        refuse(field.name, fmt::format("to be 0 or from {} to {}", field.least_but_zero, to),
               fmt::format("{}", value));
    } else if (!(value >= from && value <= to) || (field.below_end && value == to)) {
        refuse(field.name,
               fmt::format("from {} to {}{}", from, field.below_end ? "below " : "", to),
               fmt::format("{}", value));
    }
}

} // namespace

LayerField direction_field(glm::dvec3& direction) {
    return {.name = "direction", .required = true, .direction = &direction};
}

LayerField points_field(std::vector<glm::dvec3>& points, std::size_t at_least) {
    return {.name = "points", .required = true, .at_least = at_least, .points = &points};
}

LayerField softness_field(double& softness) {
    return {.name = "softness", .range = {0.0, 1.0}, .number = &softness};
}

std::vector<double> values(const LayerField& field) {
    if (field.flag != nullptr)
        return {*field.flag ? 1.0 : 0.0};
    if (field.number != nullptr)
        return {*field.number};
    if (field.single != nullptr)
        return {static_cast<double>(*field.single)};
    if (field.colour != nullptr)
        return {static_cast<double>(field.colour->x), static_cast<double>(field.colour->y),
                static_cast<double>(field.colour->z)};
    if (field.direction != nullptr)
        return {field.direction->x, field.direction->y, field.direction->z};
    std::vector<double> result;
    for (const glm::dvec3& point : *field.points)
        result.insert(result.end(), {point.x, point.y, point.z});
    return result;
}

void set_values(const LayerField& field, std::span<const double> numbers) {
    assert((field.points != nullptr
                ? numbers.size() % 3 == 0
                : numbers.size() == (field.colour || field.direction ? 3u : 1u)) &&
           "a field takes as many numbers as it has");
    if (field.flag != nullptr) {
        *field.flag = numbers[0] != 0.0;
    } else if (field.number != nullptr) {
        *field.number = numbers[0];
    } else if (field.single != nullptr) {
        *field.single = static_cast<float>(numbers[0]);
    } else if (field.colour != nullptr) {
        *field.colour = glm::vec3(glm::dvec3(numbers[0], numbers[1], numbers[2]));
    } else if (field.direction != nullptr) {
        *field.direction = {numbers[0], numbers[1], numbers[2]};
    } else {
        field.points->clear();
        for (std::size_t i = 0; i < numbers.size(); i += 3)
            field.points->emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    }
}

void check(const LayerField& field) {
    if (field.number != nullptr)
        check_number(field);
    if (field.direction != nullptr)
        check_direction(field.name, *field.direction);
    if (field.points == nullptr)
        return;
    if (field.points->size() < field.at_least)
        refuse(field.name, fmt::format("of at least {} directions", field.at_least),
               fmt::format("{}", field.points->size()));
    for (const glm::dvec3& point : *field.points)
        check_direction(field.name, point);
}

void refuse(std::string_view what, std::string_view expected, const std::string& got) {
    throw std::invalid_argument(fmt::format("expected {} {}, got {}", what, expected, got));
}

} // namespace relumine::cubemap
