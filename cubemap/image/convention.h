// The ways in which other programs place an environment picture in the world.
#pragma once

#include <span>
#include <string_view>

#include <glm/mat3x3.hpp>

#include "cubemap/image/environment.h"

namespace relumine::cubemap {

/// How one program or format reads environment pictures. The table with sources is in
/// docs/environments.md.
///
/// Axes:    directions are in our world, right-handed with +Y up. A program with Z up (Blender,
///          pbrt) has its (x, y, z) at our (x, z, -y), as glTF exporters turn it. Direct3D is
///          left-handed and has its (x, y, z) at our (x, y, -z).
struct Convention {
    std::string_view name;
    /// The mapping from direction to picture, in one line.
    std::string_view mathematics;
    /// The layout that the program reads by default.
    Layout usual_layout = Layout::LatLong;
    /// All layouts that the program reads.
    std::span<const Layout> layouts;
    /// These matrices turn a direction in OpenEXR's axes, in which Layout describes the pictures,
    /// into our world direction. Pictures that are neither lat-longs nor made of faces need none.
    glm::dmat3 world_from_lat_long = glm::dmat3(1.0);
    glm::dmat3 world_from_faces = glm::dmat3(1.0);
    /// True if the pictures of +Z and -Z in a strip or in six files are exchanged against OpenEXR's
    /// cube.
    bool swaps_z_faces = false;
    /// True if samples of .exr files lie on the borders and the `envmap` attribute says so.
    bool has_attribute = false;

    /// Returns true if the program reads this layout.
    [[nodiscard]] bool reads(Layout layout) const;
    /// Returns the matrix for a layout.
    [[nodiscard]] const glm::dmat3& world_from(Layout layout) const;
};

/// Returns all conventions.
[[nodiscard]] std::span<const Convention> conventions();
/// Returns the convention of a name. Null for an unknown name.
[[nodiscard]] const Convention* find_convention(std::string_view name);

/// Exchanges the pictures of +Z and -Z of a Cube or HorizontalStrip. Other layouts stay as they
/// are.
void swap_z_faces(EnvironmentImage& image);

/// Gives a Cube or HorizontalStrip as it was read the faces of a convention, whose matrix then
/// takes them to the world.
void take_faces(const Convention& convention, EnvironmentImage& image);

} // namespace relumine::cubemap
