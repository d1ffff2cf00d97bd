// Generated environments that change over time, with known answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "cubemap/cube_map.h"
#include "cubemap/doctor/sky_angles.h"

namespace relumine::data_gen {

/// Options that all sequences share.
struct SequenceOptions {
    std::size_t num_frames = 100;
    /// 1 <= R <= 16384.
    std::uint32_t face_resolution = 128;
    /// The map that `turn` turns. Frames have its resolution.
    cubemap::CubeMap probe = {};
};

/// Returns the sun's place of `sun` in frame f of n. The azimuth goes from 100 through 0 (+Z) to
/// -100 at an even rate. The elevation is 8 + 54 sin(pi t), t = f / (n - 1): 8 at both ends and 62
/// half-way.
[[nodiscard]] cubemap::SkyAngles sun_angles(std::size_t frame, std::size_t num_frames);

/// The light of `switch`: a disc of this radius. It is on from frame `num_frames / 2` on, and off
/// before.
struct SwitchedLight {
    glm::dvec3 direction{-0.5, 0.7, 0.6};
    double radius_degrees = 12.0;
    glm::vec3 radiance{18.0f, 15.0f, 11.0f};
    /// Radiance from everywhere, in all frames.
    float background = 0.08f;
};

/// Returns how much of the sky the clouds of `clouds` hide, 0 to 1, in a direction above the
/// horizon. The clouds lie on a plane at height 1. CloudWind moves them along it per frame; their
/// shape does not change.
[[nodiscard]] double cloud_cover(const glm::dvec3& direction, double frame);
/// Movement of the clouds per frame.
inline constexpr glm::dvec3 CloudWind{0.035, 0.0, 0.012};
/// Returns the brightness of the sun's disc behind the clouds of `clouds`, relative to a clear sky:
/// (1 - cover)^2 at the disc's centre.
[[nodiscard]] double cloud_transmission(double frame);

/// A round lamp as seen from the car of `tunnel`.
struct TunnelLamp {
    /// Unit direction.
    glm::dvec3 direction{0.0};
    double radius_degrees = 0.0;
    glm::vec3 radiance{0.0f};
};
/// Returns all lamps of a frame: two rows of spheres under a tunnel's roof. The car drives towards
/// +X. After TunnelPeriod frames it reaches the next pair of lamps and the view repeats.
[[nodiscard]] std::vector<TunnelLamp> tunnel_lamps(std::size_t frame);
inline constexpr std::size_t TunnelPeriod = 24;
/// Radiance of the tunnel's walls, from everywhere.
inline constexpr float TunnelWalls = 0.05f;

/// Returns the map of a frame below num_frames.
using FrameMaker = std::function<cubemap::CubeMap(std::size_t frame)>;

/// One row of the list of sequences.
struct Sequence {
    std::string_view name;
    /// One line.
    std::string_view description;
    bool needs_probe = false;
    /// Throws:  std::invalid_argument for no frames, a resolution out of range or a missing probe.
    FrameMaker (*make)(const SequenceOptions& options);
};

/// Returns all sequences: `sun`, `turn`, `switch`, `clouds`, `tunnel`. Frames do not depend on each
/// other: every order and every number of threads gives the same bits.
[[nodiscard]] std::span<const Sequence> sequences();

} // namespace relumine::data_gen
