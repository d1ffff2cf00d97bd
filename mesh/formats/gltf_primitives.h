// Primitives of a glTF file: what a mesh is made of.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>

#include "mesh/formats/gltf_deformation.h"
#include "mesh/formats/gltf_document.h"
#include "mesh/formats/gltf_materials.h"
#include "mesh/triangle_mesh.h"

namespace relumine::mesh {
struct DracoMesh;
}

namespace relumine::mesh::gltf {

/// A primitive's arrays as the file has them, before any node places them.
struct Primitive {
    /// Without normals its faces are flat.
    std::vector<glm::vec3> positions, normals, colors;
    /// The sets that the material's textures use.
    std::vector<glm::vec2> uvs, second_uvs;
    /// Directions of growing u, if the material has a normal map, and signs of the bitangents in w.
    std::vector<glm::vec4> tangents;
    std::vector<Triangle> triangles;
    std::uint32_t material = 0;
    /// Materials of the triangles from some on, ascending: of primitives that came to this one.
    struct LaterMaterial {
        std::size_t first_triangle;
        std::uint32_t material;
    };
    std::vector<LaterMaterial> later_materials;
    std::vector<Influences> influences;
    const Json* description = nullptr;
};

/// Reads primitives. Document and materials must outlive it; a primitive without a material adds
/// the format's default one. `lightmap_uvs`: LoadOptions. `variant`: its number in the file, of
/// KHR_materials_variants; the primitives that do not know it keep their own materials.
class PrimitiveReader {
public:
    PrimitiveReader(Document& document, Materials& materials,
                    std::optional<std::uint32_t> lightmap_uvs, std::optional<std::uint64_t> variant)
        : document_(document), materials_(materials), lightmap_uvs_(lightmap_uvs),
          variant_(variant) {}

    /// Returns nothing for points and lines. `description` must outlive the result.
    /// Throws:  std::runtime_error "expected X, got Y".
    [[nodiscard]] std::optional<Primitive> read(const Json& description);

private:
    [[nodiscard]] std::vector<Triangle> triangles(const Json& description, std::uint64_t mode,
                                                  std::size_t num_vertices);
    [[nodiscard]] std::uint32_t material(const Json& description);
    [[nodiscard]] std::uint32_t default_material();
    void scale_colors(const Json& description, std::vector<glm::vec3>& colors);
    void check_counts(const Json& description, const DracoMesh& mesh);

    Document& document_;
    Materials& materials_;
    std::optional<std::uint32_t> lightmap_uvs_;
    std::optional<std::uint64_t> variant_;
    std::optional<std::uint32_t> default_material_;
};

/// Adds the triangles of a primitive to the one before it where both have the same vertices: the
/// same accessors, looked at in the same way. Exporters share the arrays of a mesh among the
/// primitives of its materials. Returns whether it did.
[[nodiscard]] bool joined(Primitive& before, const Primitive& next);

/// Returns the primitive with its morph targets, each times its weight; nothing where they are at
/// rest.
/// Throws:  std::runtime_error "expected X, got Y" for another number of weights.
[[nodiscard]] std::optional<Primitive> morphed(Document& document, const Primitive& primitive,
                                               std::span<const double> weights);

/// Counts the memory of a primitive that is shown so often. Nodes repeat meshes, and primitives
/// repeat accessors: 64 KB of glTF could make thousands of millions of vertices.
void take_memory(Document& document, const Primitive& primitive, std::size_t num_times);

} // namespace relumine::mesh::gltf
