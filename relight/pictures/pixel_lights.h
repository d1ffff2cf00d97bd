// Which sharp lights reach the pixels of a picture's tile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/triangle_mesh.h"
#include "prt/receivers/mesh_point.h"
#include "prt/visibility/blockers.h"
#include "prt/visibility/ray_scene.h"
#include "relight/pictures/eye_samples.h"
#include "relight/sharp/light_packets.h"
#include "relight/sharp/sharp_lights.h"

namespace relumine::relight {

/// The sharp lights of a picture, as beams.
class LightBeams {
public:
    explicit LightBeams(std::span<const SharpLight> lights);

    /// Neighbours in the sky, up to 64, that follow each other in the list.
    struct Beam {
        prt::DirectionPatch directions;
        std::size_t first_light = 0;
    };
    [[nodiscard]] std::span<const Beam> beams() const { return beams_; }
    [[nodiscard]] std::size_t num_lights() const { return num_lights_; }
    [[nodiscard]] std::size_t num_packets() const {
        return (num_lights_ + prt::PacketSize - 1) / prt::PacketSize;
    }

private:
    std::vector<Beam> beams_;
    std::size_t num_lights_ = 0;
};

/// Traces the lights at the middle of every pixel of a tile and of a ring of one pixel around it.
/// Where a pixel and those around it do not see the same lights, the lights that they disagree
/// about are traced at all of its samples. For one thread.
///
/// Lights are bits, as LightPackets has them: bit i of word p is light 16 p + i.
class PixelLights {
public:
    /// All must outlive this object. `blockers` answer for the lights as `rays` would.
    PixelLights(const mesh::TriangleMesh& mesh, const prt::RayScene& rays,
                const prt::Blockers& blockers, float bias, const LightBeams& lights)
        : mesh_(mesh), rays_(rays), blockers_(blockers), bias_(bias), lights_(lights) {}

    /// Traces a tile: `seen` are its samples and those of the ring, `inner` its pixels.
    void trace(const SampleRectangle& seen, const PixelRectangle& inner);

    /// Whether a pixel of the tile and those around it see the same lights.
    [[nodiscard]] bool is_even(std::uint32_t x, std::uint32_t y) const {
        return uneven_[index(x, y)] == Even;
    }
    /// Returns the lights that a sample of a pixel sees.
    [[nodiscard]] std::span<const std::uint16_t> of(std::uint32_t x, std::uint32_t y,
                                                    std::size_t sample) const;

private:
    static constexpr std::uint32_t Even = ~std::uint32_t{0};

    /// Rays that are traced together.
    class Group;

    [[nodiscard]] std::size_t index(std::uint32_t x, std::uint32_t y) const {
        return (y - pixels_.top) * pixels_.width() + (x - pixels_.left);
    }
    [[nodiscard]] std::span<std::uint16_t> middle(std::uint32_t x, std::uint32_t y) {
        return std::span(middles_).subspan(index(x, y) * lights_.num_packets(),
                                           lights_.num_packets());
    }
    void trace_middles(const SampleRectangle& seen);
    bool find_doubt(std::uint32_t x, std::uint32_t y, std::span<std::uint16_t> doubt);
    void trace_uneven(const SampleRectangle& seen, const PixelRectangle& inner);

    const mesh::TriangleMesh& mesh_;
    const prt::RayScene& rays_;
    const prt::Blockers& blockers_;
    float bias_;
    const LightBeams& lights_;
    PixelRectangle pixels_;
    std::size_t per_pixel_ = 1;
    /// [pixels][packets]
    std::vector<std::uint16_t> middles_;
    /// [pixels] place among the uneven ones, or Even.
    std::vector<std::uint32_t> uneven_;
    /// [uneven pixels][samples][packets]
    std::vector<std::uint16_t> samples_;
};

} // namespace relumine::relight
