// How other programs place an environment picture in the world.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// A program's or format's way to read environment pictures. docs/environments.md has the table
/// with sources.
///
/// World axes: ours, right-handed with +Y up. Programs with Z up (Blender, pbrt) have their (x, y,
/// z) at our (x, z, -y), as glTF exporters turn it; Direct3D, left-handed, has its (x, y, z) at our
/// (x, y, -z).
struct Convention {
    std::string_view name;
    /// One line
    std::string_view mathematics;
    /// What the program reads
    Layout usual_layout;
    /// All that it reads
    std::span<const Layout> layouts;
    /// Our world direction of what Layout's own description (OpenEXR's axes) calls a direction.
    glm::dmat3 world_from_lat_long = glm::dmat3(1.0);
    glm::dmat3 world_from_faces = glm::dmat3(1.0);
    /// The picture of a strip or of six files that is named +Z is the one that OpenEXR's cube has
    /// at -Z, and the other way round.
    bool swaps_z_faces = false;
    /// Samples of .exr files lie on the borders and the `envmap` attribute says so.
    bool has_attribute = false;

    [[nodiscard]] bool reads(Layout layout) const;
    [[nodiscard]] const glm::dmat3& world_from(Layout layout) const;
};

[[nodiscard]] std::span<const Convention> conventions();
/// Null for a name that none has.
[[nodiscard]] const Convention* find_convention(std::string_view name);

/// Exchanges the pictures of +Z and -Z of a Cube or HorizontalStrip; other layouts stay.
void swap_z_faces(EnvironmentImage& image);

} // namespace relumine::cubemap
