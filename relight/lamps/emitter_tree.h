// Surfaces that glow, as one receiver sees them: near ones by themselves, far ones together.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/lamps/lamps.h"

namespace relumine::relight {

/// Returns what a triangle that glows with radiance 1 gives to a surface of albedo 1 in the origin,
/// if nothing is between them: Lambert's formula for polygons, of what is above the horizon. The
/// triangle's side does not matter.
[[nodiscard]] double triangle_light(const std::array<glm::dvec3, 3>& corners,
                                    const glm::dvec3& normal);

/// A tree over emitters. A node whose emitters lie close together, as seen from a receiver, counts
/// as one [Walter et al. 2005, "Lightcuts"].
class EmitterTree {
public:
    /// A side of an emitter.
    struct Glow {
        std::array<glm::dvec3, 3> corners{};
        glm::dvec3 front{0.0};
        glm::dvec3 radiance{0.0};
        double area = 0.0;

        [[nodiscard]] double power() const { return area * (radiance.r + radiance.g + radiance.b); }
        [[nodiscard]] glm::dvec3 at(const glm::dvec2& barycentric) const {
            return corners[0] + barycentric.x * (corners[1] - corners[0]) +
                   barycentric.y * (corners[2] - corners[0]);
        }
    };
    /// Emitters [begin, end) and the light they give to a surface of albedo 1 if nothing is
    /// between.
    struct Seen {
        std::size_t begin = 0;
        std::size_t end = 0;
        glm::dvec3 light{0.0};

        [[nodiscard]] double weight() const { return light.r + light.g + light.b; }
    };

    /// Backs glow as well if `two_sided`.
    EmitterTree(const mesh::TriangleMesh& mesh, std::span<const prt::Emitter> emitters,
                bool two_sided);

    /// Replaces `seen` by what a receiver sees, near to each other in turn.
    void look(const glm::dvec3& position, const glm::dvec3& normal, std::vector<Seen>& seen) const;

    /// Chooses an emitter of [begin, end) by its power; `choice` is in [0, 1).
    [[nodiscard]] const Glow& choose(const Seen& seen, double choice) const;

private:
    struct Node {
        std::size_t begin = 0, end = 0;
        /// Index of the first of the two halves; 0: a leaf.
        std::size_t first_child = 0;
        glm::dvec3 center{0.0};
        double radius = 0.0;
        /// Middle and half the size of a box around the emitters
        glm::dvec3 middle{0.0}, half{0.0};
        /// All lie in one plane and look to one side of it.
        bool is_flat = false;
        /// Axis and half angle of the cone of fronts.
        glm::dvec3 axis{0.0};
        double half_angle = 0.0;
        /// Columns are colours: sums of radiance times area times front.
        glm::dmat3 fluxes{0.0};
    };
    void summarise(Node& node) const;
    /// Whether a receiver sees all fronts of a node, none, or perhaps some.
    enum class Fronts { All, None, Some };
    [[nodiscard]] static Fronts fronts_seen(const Node& node, const glm::dvec3& way,
                                            double distance);
    void split(std::size_t node);
    void see_leaf(const Node& node, const glm::dvec3& position, const glm::dvec3& normal,
                  std::vector<Seen>& seen) const;

    std::vector<Glow> glows_;
    /// [glows + 1] power of those before.
    std::vector<double> powers_;
    std::vector<Node> nodes_;
};

} // namespace relumine::relight
