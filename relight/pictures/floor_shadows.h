// Shadows with wide edges on an added floor.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/blockers.h"
#include "relight/pictures/eye_samples.h"
#include "relight/pictures/picture_view.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

/// The lights of a floor, cells of the sky, as beams.
class FloorLights {
public:
    /// Each sample of a pixel has places of its own in the cells.
    FloorLights(std::span<const SharpLight> lights, std::size_t samples_per_pixel);

    /// Neighbours in the sky.
    struct Beam {
        /// Corners of cells, far out and far apart: a floor that sees all of them sees the beam,
        /// and one that sees none sees nothing of it.
        prt::DirectionPacket border;
        /// [samples per pixel]
        std::vector<prt::DirectionPatch> places;
        /// What each light gives to the floor, as radiance for albedo 1, and all of them.
        std::array<glm::vec3, prt::DirectionPatch::Size> radiance{};
        glm::vec3 whole{0.0f};
    };
    [[nodiscard]] std::span<const Beam> beams() const { return beams_; }

private:
    std::vector<Beam> beams_;
};

/// Traces a floor's lights. The border of a beam is traced at every other pixel of every other row.
/// Where all around see all of it, or nothing, pixels have all of its light, or nothing. Elsewhere
/// the beam is traced at all samples of a pixel, so that the edge of its shadow has as many shades
/// as samples times lights. For one thread.
class FloorShadows {
public:
    /// All must outlive this object.
    FloorShadows(const mesh::TriangleMesh& mesh, const FadingFloor& floor,
                 const prt::Blockers& blockers, float bias, const FloorLights& lights)
        : mesh_(mesh), floor_(floor), blockers_(blockers), bias_(bias), lights_(lights) {}

    /// So many pixels around a tile are looked at.
    static constexpr std::uint32_t Reach = 2;

    /// Traces a tile: `seen` are its samples and those of a ring around it, `inner` its pixels.
    void trace(const SampleRectangle& seen, const PixelRectangle& inner);

    /// Returns the mean of what the lights give to the samples of a pixel that see the floor, as
    /// radiance for albedo 1; 0 where none does.
    [[nodiscard]] const glm::vec3& of(std::uint32_t x, std::uint32_t y) const {
        return radiance_[index(x, y)];
    }
    /// Returns what the lights give to a point of the floor that is seen through something.
    [[nodiscard]] glm::vec3 at(const prt::MeshPoint& point, std::size_t sample) const;

private:
    /// Points that are traced together.
    struct Group;

    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const {
        return (y - pixels_.top) * pixels_.width() + (x - pixels_.left);
    }
    [[nodiscard]] bool is_floor(const EyeSample& sample) const {
        return sample.hits() && floor_.has(mesh_.triangles[sample.triangle]);
    }
    [[nodiscard]] glm::vec3 origin(const prt::MeshPoint& point) const;
    [[nodiscard]] std::size_t num_pairs_across() const {
        return (pixels_.right + 1) / 2 - pixels_.left / 2;
    }
    [[nodiscard]] std::size_t pair(std::uint32_t x, std::uint32_t y) const {
        return (y / 2 - pixels_.top / 2) * num_pairs_across() + (x / 2 - pixels_.left / 2);
    }
    enum class Seen : std::uint8_t { NoFloor, Nothing, Part, All };
    void find_borders(const SampleRectangle& seen);
    void choose(const PixelRectangle& inner);
    [[nodiscard]] Seen seen_around(std::size_t beam, std::uint32_t x, std::uint32_t y) const;

    const mesh::TriangleMesh& mesh_;
    const FadingFloor& floor_;
    const prt::Blockers& blockers_;
    float bias_;
    const FloorLights& lights_;
    PixelRectangle pixels_;
    /// [pixels] how many samples see the floor.
    std::vector<std::uint32_t> num_samples_;
    /// [pixels]
    std::vector<glm::vec3> radiance_;
    /// [beams][two by two pixels] what the first of them sees of a beam.
    std::vector<Seen> borders_;
    std::size_t num_pairs_ = 0;
    /// [beams] the pixels whose samples are traced.
    std::vector<std::vector<std::uint32_t>> chosen_;
};

} // namespace relumine::relight
