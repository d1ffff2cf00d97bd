// Based on: glTF 2.0, Sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
#include "mesh/formats/gltf_deformation.h"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "mesh/formats/gltf_accessors.h"

namespace relumine::mesh::gltf {

Frame::Frame(const glm::dmat4& of) : matrix(of) {
    const glm::dmat3 linear(matrix);
    cofactors = glm::dmat3(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                           glm::cross(linear[0], linear[1]));
    is_mirrored = glm::dot(linear[0], cofactors[0]) < 0.0;
}

glm::dvec3 Frame::normal(const glm::vec3& own) const {
    const glm::dvec3 normal = cofactors * glm::dvec3(own);
    const double length = glm::length(normal);
    return length > 0.0 ? normal / (is_mirrored ? -length : length) : normal;
}

glm::vec4 Frame::tangent(const glm::vec4& own) const {
    const double sign = (own.w < 0.0f) != is_mirrored ? -1.0 : 1.0;
    return glm::dvec4(glm::dmat3(matrix) * glm::dvec3(own), std::isnan(own.w) ? own.w : sign);
}

Skin::Skin(Document& document, std::uint64_t index,
           const std::function<glm::dmat4(std::uint64_t)>& world) {
    const Json& skin = document.element("skins", index);
    for (const Json& joint : items(skin, "joints")) {
        const std::uint64_t node = whole_value(joint, "joints");
        static_cast<void>(document.element("nodes", node)); // checks the range
        matrices_.push_back(world(node));
    }
    if (matrices_.empty())
        throw std::runtime_error(fmt::format("expected joints of skin {}, got none", index));
    if (!skin.find("inverseBindMatrices"))
        return;
    const Floats inverse = read_floats(document, whole(skin, "inverseBindMatrices"), 16);
    if (inverse.count < matrices_.size())
        throw std::runtime_error(
            fmt::format("expected {} inverse bind matrices of skin {}, one for each joint, got {}",
                        matrices_.size(), index, inverse.count));
    for (std::size_t joint = 0; joint < matrices_.size(); ++joint) {
        glm::dmat4 matrix(1.0);
        for (int i = 0; i < 16; ++i) {
            const float value = inverse.values[16 * joint + static_cast<std::size_t>(i)];
            if (!std::isfinite(value))
                throw std::runtime_error(fmt::format(
                    "expected finite inverse bind matrices of skin {}, got {}", index, value));
            matrix[i / 4][i % 4] = double{value};
        }
        matrices_[joint] = matrices_[joint] * matrix;
    }
}

Frame Skin::frame(std::span<const Influences> sets, std::size_t vertex) const {
    glm::dmat4 sum(0.0);
    double weights = 0.0;
    for (const Influences& set : sets)
        for (int i = 0; i < 4; ++i) {
            const double weight = double{set.weights[vertex][i]};
            if (!(weight > 0.0))
                continue;
            sum += weight * matrices_[static_cast<std::size_t>(set.joints[vertex][i])];
            weights += weight;
        }
    return weights > 0.0 ? Frame(sum / weights) : Frame();
}

std::size_t Skin::check(std::span<const Influences> sets) const {
    if (sets.empty())
        throw std::runtime_error("expected JOINTS_0 and WEIGHTS_0 of a mesh with a skin, got none");
    constexpr float LargestRounding = 0.02f;
    std::size_t num_odd = 0;
    for (std::size_t vertex = 0; vertex < sets.front().weights.size(); ++vertex) {
        float sum = 0.0f;
        for (const Influences& set : sets)
            for (int i = 0; i < 4; ++i) {
                const float weight = set.weights[vertex][i], joint = set.joints[vertex][i];
                if (!(weight >= 0.0f) || !std::isfinite(weight))
                    throw std::runtime_error(
                        fmt::format("expected weights of joints of 0 or more, got {}", weight));
                if (weight > 0.0f &&
                    !(joint >= 0.0f && joint < static_cast<float>(matrices_.size())))
                    throw std::runtime_error(
                        fmt::format("expected joints of vertices below {}, as many as the skin "
                                    "has, got {}",
                                    matrices_.size(), joint));
                sum += weight;
            }
        num_odd += std::abs(sum - 1.0f) > LargestRounding ? 1 : 0;
    }
    return num_odd;
}

template<class Vector>
void add_targets(Document& document, const Json& primitive, const char* attribute,
                 std::span<const double> weights, std::vector<Vector>& values) {
    const Json::Array& targets = items(primitive, "targets");
    for (std::size_t target = 0; target < targets.size() && target < weights.size(); ++target) {
        if (weights[target] == 0.0 || targets[target].find(attribute) == nullptr)
            continue;
        document.take_memory(values.size() * sizeof(glm::vec3));
        const Floats moves = read_floats(document, whole(targets[target], attribute), 3);
        if (moves.count != values.size())
            throw std::runtime_error(
                fmt::format("expected {} elements of {} of a morph target, as many as the mesh "
                            "has, got {}",
                            values.size(), attribute, moves.count));
        for (std::size_t i = 0; i < values.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                values[i][axis] += static_cast<float>(weights[target]) *
                                   moves.values[3 * i + static_cast<std::size_t>(axis)];
    }
}
template void add_targets(Document&, const Json&, const char*, std::span<const double>,
                          std::vector<glm::vec3>&);
template void add_targets(Document&, const Json&, const char*, std::span<const double>,
                          std::vector<glm::vec4>&);

} // namespace relumine::mesh::gltf
