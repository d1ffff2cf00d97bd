// Based on: glTF 2.0, Sections 3.5 and 3.11, Appendix C (interpolation of key frames).
#include "mesh/formats/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>

#include "files/counted.h"
#include "mesh/formats/gltf_accessors.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

enum class Interpolation { Step, Linear, Cubic };

/// The keys of one property: `width` numbers each.
struct Keys {
    std::vector<float> times, values;
    Interpolation interpolation = Interpolation::Linear;
    std::size_t width = 0;

    /// Returns number `part` of a key: 0 its value. Cubic keys have an in-tangent and an
    /// out-tangent, too, -1 and 1.
    [[nodiscard]] std::vector<double> at(std::size_t key, int part = 0) const {
        const std::size_t element = interpolation == Interpolation::Cubic
                                        ? 3 * key + static_cast<std::size_t>(part + 1)
                                        : key;
        const auto first = values.begin() + static_cast<std::ptrdiff_t>(element * width);
        return {first, first + static_cast<std::ptrdiff_t>(width)};
    }
};

Interpolation interpolation_of(const Json& sampler) {
    const std::string name = text(sampler, "interpolation", "LINEAR");
    if (name == "LINEAR")
        return Interpolation::Linear;
    if (name == "STEP")
        return Interpolation::Step;
    if (name == "CUBICSPLINE")
        return Interpolation::Cubic;
    throw std::runtime_error(fmt::format(
        "expected LINEAR, STEP or CUBICSPLINE as an animation's \"interpolation\", got {}",
        excerpt(name)));
}

/// What the keys of a channel are: vectors, or lists of numbers of any length.
struct KeyType {
    std::uint32_t num_components = 1;
    bool is_list = false;
};

Keys read_keys(Document& document, const Json& sampler, const std::string& path, KeyType type) {
    Keys keys;
    keys.interpolation = interpolation_of(sampler);
    keys.times = read_floats(document, whole(sampler, "input"), 1).values;
    const auto is_late = [](float a, float b) {
        return !(a < b);
    };
    if (!std::all_of(keys.times.begin(), keys.times.end(),
                     [](float time) { return std::isfinite(time); }) ||
        std::adjacent_find(keys.times.begin(), keys.times.end(), is_late) != keys.times.end())
        throw std::runtime_error("expected ascending times of an animation's keys, got others");
    const Floats values = read_floats(document, whole(sampler, "output"), type.num_components);
    keys.values = values.values;
    const std::size_t num_keys =
        keys.times.size() * (keys.interpolation == Interpolation::Cubic ? 3 : 1);
    keys.width = type.is_list ? values.count / num_keys : type.num_components;
    if (keys.width == 0 || keys.values.size() != keys.width * num_keys)
        throw std::runtime_error(
            fmt::format("expected {} values of an animation's \"{}\", one for each key, got {}",
                        num_keys, path, values.count));
    if (!std::all_of(keys.values.begin(), keys.values.end(),
                     [](float value) { return std::isfinite(value); }))
        throw std::runtime_error(
            fmt::format("expected finite values of an animation's \"{}\", got others", path));
    return keys;
}

/// Goes from one rotation to the other on the shorter way, at even speed.
std::vector<double> turned(const std::vector<double>& a, const std::vector<double>& b, double t) {
    const glm::dquat turned =
        glm::slerp(glm::dquat(a[3], a[0], a[1], a[2]), glm::dquat(b[3], b[0], b[1], b[2]), t);
    return {turned.x, turned.y, turned.z, turned.w};
}

std::vector<double> value_at(const Keys& keys, double seconds, bool is_rotation) {
    const std::size_t last = keys.times.size() - 1;
    if (!(seconds > double{keys.times.front()}))
        return keys.at(0);
    if (seconds >= double{keys.times.back()})
        return keys.at(last);
    const auto next = static_cast<std::size_t>(
        std::upper_bound(keys.times.begin(), keys.times.end(), seconds) - keys.times.begin());
    const std::size_t key = next - 1;
    if (keys.interpolation == Interpolation::Step)
        return keys.at(key);
    const double length = double{keys.times[next]} - double{keys.times[key]};
    const double t = (seconds - double{keys.times[key]}) / length;
    const std::vector<double> a = keys.at(key), b = keys.at(next);
    if (keys.interpolation == Interpolation::Linear && is_rotation)
        return turned(a, b, t);
    std::vector<double> result(keys.width);
    if (keys.interpolation == Interpolation::Linear) {
        for (std::size_t i = 0; i < keys.width; ++i)
            result[i] = (1.0 - t) * a[i] + t * b[i];
        return result;
    }
    // Hermite's polynomials: Appendix C.5.
    const std::vector<double> out = keys.at(key, 1), in = keys.at(next, -1);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < keys.width; ++i)
        result[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * a[i] + length * (t3 - 2.0 * t2 + t) * out[i] +
                    (3.0 * t2 - 2.0 * t3) * b[i] + length * (t3 - t2) * in[i];
    return result;
}

/// Finds an animation by its name, or by its number.
std::uint64_t index_of(const Document& document, const std::string& animation) {
    const std::size_t count = document.count("animations");
    std::string names;
    for (std::size_t i = 0; i < count; ++i) {
        const std::string name =
            text(document.element("animations", i), "name", fmt::format("{}", i));
        if (name == animation)
            return i;
        constexpr std::size_t MostNames = 8;
        if (i < MostNames)
            names += (i == 0 ? "" : ", ") + excerpt(name);
        else if (i == MostNames)
            names += " ...";
    }
    if (!animation.empty() && animation.size() < 9 &&
        animation.find_first_not_of("0123456789") == std::string::npos &&
        std::stoull(animation) < count)
        return std::stoull(animation);
    throw std::runtime_error(
        fmt::format("expected an animation of the file ({}) for its pose, got {}",
                    count == 0 ? "which has none" : names, excerpt(animation)));
}

/// Returns the value that a channel gives to the property at a pointer.
Json pointed_value(Document& document, const Json& sampler, const std::string& pointer,
                   double seconds) {
    const std::uint64_t output = whole(sampler, "output");
    const Json& accessor = document.element("accessors", output);
    const bool is_list = pointer.ends_with("/weights");
    const std::uint32_t width = is_list ? 1 : num_components(document, output);
    const Keys keys = read_keys(document, sampler, pointer, {width, is_list});
    document.take_memory(keys.width * sizeof(Json));
    const std::vector<double> value =
        value_at(keys, seconds, pointer.ends_with("/rotation") && pointer.starts_with("/nodes/"));
    if (keys.width > 1 || is_list)
        return value;
    constexpr std::uint64_t Byte = 5121;
    if (whole(accessor, "componentType") == Byte && !flag(accessor, "normalized"))
        return value[0] != 0.0;
    return value[0];
}

} // namespace

bool is_hidden(const Json& node) {
    const Json& extension = child(child(node, "extensions"), "KHR_node_visibility");
    return extension.find("visible") != nullptr && !flag(extension, "visible");
}

glm::dmat4 matrix_of(const Placement& placement) {
    const auto& [t, r, s] = placement;
    const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    if (!(length > 0.0))
        throw std::runtime_error("expected a unit quaternion as \"rotation\", got zeros");
    const glm::dmat3 rotation =
        glm::mat3_cast(glm::dquat(r[3] / length, r[0] / length, r[1] / length, r[2] / length));
    return {glm::dvec4(rotation[0] * s[0], 0.0), glm::dvec4(rotation[1] * s[1], 0.0),
            glm::dvec4(rotation[2] * s[2], 0.0), glm::dvec4(t[0], t[1], t[2], 1.0)};
}

NodePoses read_pose(Document& document, const Pose& pose, std::vector<std::string>& warnings) {
    const Json& animation = document.element("animations", index_of(document, pose.animation));
    const Json::Array& samplers = items(animation, "samplers");
    NodePoses poses;
    Changes changes;
    for (const Json& channel : items(animation, "channels")) {
        const Json& target = child(channel, "target");
        const std::string path = text(target, "path");
        const Json& pointer = child(child(target, "extensions"), "KHR_animation_pointer");
        const bool is_pointer = path == "pointer" && pointer.find("pointer") != nullptr;
        if (!is_pointer && (!target.find("node") || (path != "translation" && path != "rotation" &&
                                                     path != "scale" && path != "weights")))
            continue; // of extensions
        const std::uint64_t sampler = whole(channel, "sampler");
        if (sampler >= samplers.size())
            throw std::runtime_error(fmt::format(
                "expected an animation's samplers below {}, got {}", samplers.size(), sampler));
        if (is_pointer) {
            const std::string property = text(pointer, "pointer");
            changes.add(property,
                        pointed_value(document, samplers[sampler], property, pose.seconds));
            continue;
        }
        const std::uint64_t node = whole(target, "node");
        static_cast<void>(document.element("nodes", node)); // checks the range
        const bool is_list = path == "weights";
        const Keys keys = read_keys(document, samplers[sampler], path,
                                    {is_list              ? 1u
                                     : path == "rotation" ? 4u
                                                          : 3u,
                                     is_list});
        NodePose& moved = poses[node];
        (path == "translation" ? moved.translation
         : path == "rotation"  ? moved.rotation
         : path == "scale"     ? moved.scale
                               : moved.weights) = value_at(keys, pose.seconds, path == "rotation");
    }
    std::vector<std::string> lost;
    if (!changes.empty())
        document.change(changes, lost);
    if (!lost.empty())
        warnings.push_back(fmt::format("{} of the animation, which the file does not have: {}",
                                       files::counted(lost.size(), "pointer"),
                                       excerpt(lost.front())));
    return poses;
}

glm::dmat4 local_transform(const Json& node, const NodePose& moved) {
    const bool is_moved = moved.translation || moved.rotation || moved.scale;
    if (node.find("matrix") && !is_moved) {
        const std::vector<double> m = numbers(node, "matrix", std::vector<double>(16, 0.0));
        glm::dmat4 matrix(1.0);
        for (int i = 0; i < 16; ++i)
            matrix[i / 4][i % 4] = m[static_cast<std::size_t>(i)];
        return matrix;
    }
    const Placement none;
    return matrix_of(
        {.translation = moved.translation.value_or(numbers(node, "translation", none.translation)),
         .rotation = moved.rotation.value_or(numbers(node, "rotation", none.rotation)),
         .scale = moved.scale.value_or(numbers(node, "scale", none.scale))});
}

std::optional<FileCamera> camera_at(const Json& camera, const glm::dmat4& transform) {
    const Json* perspective = camera.find("perspective");
    const Json* orthographic = camera.find("orthographic");
    if (perspective == nullptr && orthographic == nullptr)
        return std::nullopt;
    const double fov = perspective != nullptr ? number(*perspective, "yfov", 0.0) : 0.5;
    const double half_height =
        perspective != nullptr ? 0.0 : std::abs(number(*orthographic, "ymag", 0.0));
    const glm::dvec3 eye(transform[3]), ahead = -glm::dvec3(transform[2]);
    const double length = glm::length(ahead);
    constexpr double Farthest = 1e18;
    if (!(fov > 0.0 && fov < std::numbers::pi) || !(length > 0.0 && length < Farthest) ||
        !(glm::length(eye) < Farthest) ||
        (perspective == nullptr && !(half_height > 0.0 && half_height < Farthest)))
        return std::nullopt;
    const glm::vec3 up(transform[1]);
    return FileCamera{Camera{.eye = glm::vec3(eye),
                             .target = glm::vec3(eye + ahead / length),
                             .fov_degrees = static_cast<float>(fov * 180.0 / std::numbers::pi),
                             .roll_degrees = glm::length(up) > 0.0f
                                                 ? roll_of(glm::vec3(ahead / length), up)
                                                 : 0.0f},
                      eye, ahead / length, half_height};
}

} // namespace relumine::mesh::gltf
