// Interpolates layers between key frames.
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/layers/layer_file.h"

namespace relumine::cubemap {

namespace {

/// The two keys around a frame that name a field. One of them may be missing.
struct Around {
    const KeyFrame* before = nullptr;
    const KeyFrame* after = nullptr;
    const std::vector<double>* values_before = nullptr;
    const std::vector<double>* values_after = nullptr;
};

Around keys_around(std::span<const KeyFrame> frames, double frame, const std::string& layer,
                   std::string_view field) {
    Around around;
    for (const KeyFrame& key : frames) {
        const auto change =
            std::find_if(key.changes.begin(), key.changes.end(),
                         [&](const KeyedValue& c) { return c.layer == layer && c.field == field; });
        if (change == key.changes.end())
            continue;
        if (key.frame <= frame) {
            around.before = &key;
            around.values_before = &change->values;
        } else {
            around.after = &key;
            around.values_after = &change->values;
            break;
        }
    }
    return around;
}

/// Moves along the great circle at constant speed; the length changes linearly. Between opposite
/// directions the turn is about an axis perpendicular to them.
glm::dvec3 turned_toward(const glm::dvec3& from, const glm::dvec3& to, double t) {
    const double from_length = glm::length(from), to_length = glm::length(to);
    if (from == to || !(from_length > 0.0) || !(to_length > 0.0))
        return t < 1.0 ? from : to;
    const glm::dvec3 start = from / from_length, end = to / to_length;
    glm::dvec3 side = end - start * glm::dot(start, end);
    const double sine = glm::length(side);
    const double angle = std::atan2(sine, glm::dot(start, end));
    if (sine > 1e-12)
        side /= sine;
    else
        side =
            glm::normalize(glm::cross(start, std::abs(start.y) < 0.9 ? glm::dvec3(0.0, 1.0, 0.0)
                                                                     : glm::dvec3(1.0, 0.0, 0.0)));
    const double length = from_length + (to_length - from_length) * t;
    return length * (start * std::cos(angle * t) + side * std::sin(angle * t));
}

std::vector<double> between(const LayerField& field, const std::vector<double>& from,
                            const std::vector<double>& to, double t) {
    if (field.flag != nullptr)
        return from;
    std::vector<double> result(from.size());
    if (field.direction == nullptr && field.points == nullptr) {
        for (std::size_t i = 0; i < from.size(); ++i)
            result[i] = from[i] + (to[i] - from[i]) * t;
        return result;
    }
    for (std::size_t i = 0; i + 2 < from.size(); i += 3) {
        const glm::dvec3 point =
            turned_toward({from[i], from[i + 1], from[i + 2]}, {to[i], to[i + 1], to[i + 2]}, t);
        result[i] = point.x;
        result[i + 1] = point.y;
        result[i + 2] = point.z;
    }
    return result;
}

} // namespace

std::vector<LightLayer> layers_at(const LightLayers& layers, double frame) {
    std::vector<LightLayer> result = layers.layers;
    if (layers.frames.empty())
        return result;
    for (LightLayer& layer : result) {
        for (const LayerField& field : fields(layer)) {
            const Around around = keys_around(layers.frames, frame, layer.name, field.name);
            if (around.before == nullptr && around.after == nullptr)
                continue;
            const auto& from =
                around.before != nullptr ? *around.values_before : *around.values_after;
            const auto& to = around.after != nullptr ? *around.values_after : from;
            const bool fits = field.points != nullptr ? from.size() % 3 == 0
                                                      : from.size() == values(field).size();
            if (!fits || from.size() != to.size())
                throw std::invalid_argument(
                    fmt::format("light layer \"{}\": expected as many numbers of \"{}\" at all key "
                                "frames, got {} and {}",
                                layer.name, field.name, from.size(), to.size()));
            if (around.before == nullptr || around.after == nullptr) {
                set_values(field, from);
            } else {
                const double t =
                    (frame - around.before->frame) / (around.after->frame - around.before->frame);
                set_values(field, between(field, from, to, t));
            }
        }
        validate(layer);
    }
    return result;
}

} // namespace relumine::cubemap
