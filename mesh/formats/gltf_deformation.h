// What moves the vertices of a glTF mesh: morph targets and skins.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/formats/gltf_document.h"

namespace relumine::mesh::gltf {

/// Places positions and normals.
struct Frame {
    Frame() = default;
    explicit Frame(const glm::dmat4& of);

    /// Returns a unit normal, or zeros. It stays outside where the frame mirrors.
    [[nodiscard]] glm::dvec3 normal(const glm::vec3& own) const;

    /// Returns a tangent of the same length or another. The sign of its bitangent, in w, is never
    /// 0.
    [[nodiscard]] glm::vec4 tangent(const glm::vec4& own) const;

    glm::dmat4 matrix{1.0};
    /// The transposed inverse times the determinant. Singular matrices have cofactors, too.
    glm::dmat3 cofactors{1.0};
    bool is_mirrored = false;
};

/// Four joints of each vertex, and their weights: JOINTS_n and WEIGHTS_n.
struct Influences {
    /// [num_vertices]
    std::vector<glm::vec4> joints, weights;
};

/// The joints of a skin in the pose of its nodes.
class Skin {
public:
    /// `world` returns the place of a node in the scene.
    /// Throws:  std::runtime_error "expected X, got Y" for joints that are no nodes, and for too
    ///          few inverse bind matrices.
    Skin(Document& document, std::uint64_t index,
         const std::function<glm::dmat4(std::uint64_t)>& world);

    /// Returns the frame of a vertex: the mean of its joints' by their weights. A vertex without
    /// weights stays where it is.
    [[nodiscard]] Frame frame(std::span<const Influences> sets, std::size_t vertex) const;

    /// Checks all vertices of a primitive before any frame is asked for. Returns how many of them
    /// have weights that do not sum to 1 within 0.02; frame() scales them.
    /// Throws:  std::runtime_error "expected X, got Y" for weights below 0 or not finite, and for
    ///          joints that the skin does not have.
    [[nodiscard]] std::size_t check(std::span<const Influences> sets) const;

private:
    std::vector<glm::dmat4> matrices_;
};

/// Adds morph targets to one attribute, "POSITION", "NORMAL" or "TANGENT", each times its weight.
/// Vector is glm::vec3, or glm::vec4 whose w stays.
/// Throws:  std::runtime_error "expected X, got Y" for targets of another number of vertices.
template<class Vector>
void add_targets(Document& document, const Json& primitive, const char* attribute,
                 std::span<const double> weights, std::vector<Vector>& values);

} // namespace relumine::mesh::gltf
