// The mesh formats: a row each.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string_view>

#include "mesh/formats/polygon_soup.h"
#include "mesh/up_axis.h"

namespace relumine::mesh {

/// A file to read. Other files that it names are looked up from its folder.
struct MeshFile {
    std::span<const std::byte> bytes;
    std::filesystem::path folder = {};
    /// For formats that have animations
    GltfOptions gltf = {};
};

struct MeshFormat {
    /// ".ply"
    std::string_view extension;
    /// A reader of polygon_soup.h
    PolygonSoup (*read)(const MeshFile& file);
    /// It has animations, and materials in variants.
    bool has_animations = false;
    /// The axis that files have up by custom
    UpAxis up = UpAxis::Y;
    /// The angle in degrees beyond which edges are sharp by custom, of formats without normals of
    /// vertices
    std::optional<float> crease = {};
};

/// Returns all formats that load() reads, by their extensions.
[[nodiscard]] std::span<const MeshFormat> mesh_formats();

/// Returns the format of a file's extension, in capitals or not; null for another.
[[nodiscard]] const MeshFormat* format_of(const std::filesystem::path& path);

} // namespace relumine::mesh
