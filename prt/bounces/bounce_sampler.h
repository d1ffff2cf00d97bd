// Traces the rays that find what surfaces a receiver sees. For bounce_precompute.cpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/bounces/bounce_precompute.h"
#include "prt/bounces/bounce_samples.h"
#include "prt/receivers/receivers.h"
#include "prt/transfer/transfer.h"
#include "prt/visibility/ray_scene.h"
#include "prt/visibility/twin_triangles.h"

namespace relumine::prt {

/// What a receiver's rays met.
struct RayHits {
    /// Place of each emitter, or NoEmitter, of every second direction: two halves, whose difference
    /// tells the error.
    std::array<std::vector<std::uint32_t>, 2> halves;
    std::uint32_t num_directions = 0;
    /// Over the hits.
    double sum_inverse_distances = 0.0;

    [[nodiscard]] std::size_t num_hits() const { return halves[0].size() + halves[1].size(); }
    /// Harmonic mean of the distances of surfaces; sky is infinitely far away.
    [[nodiscard]] float distance() const {
        return static_cast<float>(num_directions / sum_inverse_distances);
    }
};

/// What a ray met that met a surface.
struct RayFate {
    /// Its place, or NoEmitter
    std::uint32_t emitter = 0;
    double inverse_distance = 0.0;
};

/// All directions within an angle of an axis of length 1.
struct DirectionCone {
    glm::vec3 axis{0.0f};
    /// The cosine of the cone's angle
    float cosine = -1.0f;
};

/// A receiver of the part that is worked on: its place among all, and its index in the part.
struct PartReceiver {
    std::size_t place = 0;
    std::size_t index = 0;
};

/// Traces the rays of receivers.
///
/// Threads: any number at a time.
class BounceSampler {
public:
    /// All arguments must outlive this object. `transfer` has the counts of the part's receivers.
    BounceSampler(const mesh::TriangleMesh& mesh, const Receivers& receivers,
                  const Transfer& transfer, const BounceProbes& probes, const RayScene& rays,
                  const BounceOptions& options);

    /// Returns the part of the hemisphere that surfaces close.
    [[nodiscard]] double closure_of(const PartReceiver& receiver) const {
        return closed_part(transfer_.normals[receiver.place], probes_.open_parts[receiver.index]);
    }

    /// Looks into as many directions as `num_directions`, after those that are there. Returns the
    /// number of rays.
    std::uint64_t look(const PartReceiver& receiver, std::uint32_t num_directions,
                       RayHits& hits) const;

    /// Looks into some of the directions, given by their numbers, and calls `visit(number, fate)`
    /// for those that meet a surface. Returns the number of rays.
    std::uint64_t look(const PartReceiver& receiver, std::span<const std::uint32_t> directions,
                       const std::function<void(std::uint32_t, const RayFate&)>& visit) const;

    /// Looks into those of the first so many directions that lie in one of the cones and
    /// `is_wanted(number, direction, cluster)`, and visits as look() does. Some just outside of the
    /// cones are asked for as well.
    void
    look_near(const PartReceiver& receiver, std::uint32_t num_directions,
              std::span<const DirectionCone> cones,
              const std::function<bool(std::uint32_t, const glm::dvec3&, std::uint32_t)>& is_wanted,
              const std::function<void(std::uint32_t, const RayFate&)>& visit) const;

    /// Finds what a point in space sees in each direction: the place of an emitter, or NoEmitter.
    /// Returns the number of rays.
    ///
    /// Shape:   `emitters` as `directions`.
    std::uint64_t look_around(const PartReceiver& point, std::span<const glm::dvec3> directions,
                              std::span<std::uint32_t> emitters) const;

    /// Returns the squared standard error of one bounce under the worst of the probe lights, from
    /// the difference of the halves.
    [[nodiscard]] double squared_error(const PartReceiver& receiver, const RayHits& hits) const;

private:
    class Look;
    template<typename NumberOf, typename Visit>
    std::uint64_t look_at(const PartReceiver& receiver, std::size_t count,
                          const NumberOf& number_of, const Visit& visit) const;
    [[nodiscard]] std::uint32_t emitter_of(const Hit& hit, const glm::vec3& direction,
                                           double choice) const;

    const mesh::TriangleMesh& mesh_;
    const Receivers& receivers_;
    const Transfer& transfer_;
    const BounceProbes& probes_;
    const RayScene& rays_;
    const BounceOptions& options_;
    /// [num_vertices] place of each vertex.
    std::vector<std::uint32_t> place_of_;
    TwinTriangles twins_;
};

} // namespace relumine::prt
