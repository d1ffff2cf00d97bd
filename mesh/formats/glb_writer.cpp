#include "mesh/formats/glb_writer.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/json.h"
#include "mesh/formats/glb_materials.h"

namespace relumine::mesh {

namespace {

static_assert(std::endian::native == std::endian::little, "glTF buffers are little-endian");
static_assert(sizeof(glm::vec3) == 12 && sizeof(Triangle) == 12, "arrays are written as they are");

// Numbers of the format.
constexpr int Float = 5126, UnsignedInt = 5125;
constexpr int ArrayBuffer = 34962, ElementArrayBuffer = 34963;
constexpr int Triangles = 4;
constexpr std::uint32_t Magic = 0x46546c67, Version = 2;
constexpr std::uint32_t JsonChunk = 0x4e4f534a, BinaryChunk = 0x004e4942;

/// How an accessor describes its array.
struct ArrayKind {
    int component_type;
    const char* type;
    int target;
};

/// The arrays of a file, one after the other, with a view and an accessor for each.
struct Arrays {
    files::Json::Array views;
    files::Json::Array accessors;
    std::string bytes;

    /// Appends an array. Returns the index of its accessor.
    template<class Value>
    std::size_t append(std::span<const Value> values, const ArrayKind& kind, std::size_t count) {
        files::Json view = {
            {"buffer", 0}, {"byteLength", values.size_bytes()}, {"target", kind.target}};
        if (!bytes.empty())
            view.set("byteOffset", bytes.size());
        accessors.push_back({{"bufferView", views.size()},
                             {"componentType", kind.component_type},
                             {"count", count},
                             {"type", kind.type}});
        views.push_back(std::move(view));
        bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
        return accessors.size() - 1;
    }

    std::size_t append(std::span<const glm::vec3> values) {
        return append(values, {Float, "VEC3", ArrayBuffer}, values.size());
    }
    /// Appends the file of an image, with a view of its own.
    void append_image(std::span<const std::byte> file) {
        views.push_back({{"buffer", 0}, {"byteLength", file.size()}, {"byteOffset", bytes.size()}});
        bytes.append(reinterpret_cast<const char*>(file.data()), file.size());
        bytes.resize((bytes.size() + 3) / 4 * 4, '\0');
    }
};

/// Sets the exact bounds of positions, which the format demands.
void set_bounds(files::Json& accessor, std::span<const glm::vec3> positions) {
    glm::vec3 min = positions[0], max = positions[0];
    for (const glm::vec3& position : positions) {
        min = glm::min(min, position);
        max = glm::max(max, position);
    }
    // Doubles give the floats' exact values in JSON.
    accessor.set("min", {double{min.x}, double{min.y}, double{min.z}});
    accessor.set("max", {double{max.x}, double{max.y}, double{max.z}});
}

void append_number(std::string& file, std::uint32_t number) {
    file.append(reinterpret_cast<const char*>(&number), sizeof number);
}

void append_chunk(std::string& file, std::uint32_t type, const std::string& content) {
    append_number(file, static_cast<std::uint32_t>(content.size()));
    append_number(file, type);
    file += content;
}

/// Returns the whole file: a header, a chunk of JSON and a chunk of bytes. Chunks are filled up to
/// multiples of four bytes, JSON with spaces. The bytes are such a multiple already.
std::string container(std::string json, const std::string& bytes) {
    constexpr std::size_t HeaderSize = 12, ChunkHeaderSize = 8;
    json.resize((json.size() + 3) / 4 * 4, ' ');
    const std::size_t size = HeaderSize + 2 * ChunkHeaderSize + json.size() + bytes.size();
    std::string file;
    file.reserve(size);
    append_number(file, Magic);
    append_number(file, Version);
    append_number(file, static_cast<std::uint32_t>(size));
    append_chunk(file, JsonChunk, json);
    append_chunk(file, BinaryChunk, bytes);
    return file;
}

void check_size(const TriangleMesh& mesh, std::uint64_t bytes_per_vertex,
                std::uint64_t num_more = 0) {
    const std::uint64_t num_bytes = std::uint64_t{mesh.num_vertices()} * bytes_per_vertex +
                                    std::uint64_t{mesh.num_triangles()} * 12 + num_more;
    // Leaves room for the JSON part.
    constexpr std::uint64_t MaxBytes = std::numeric_limits<std::uint32_t>::max() - 65536;
    if (num_bytes > MaxBytes)
        throw std::runtime_error(
            fmt::format("expected at most {} bytes in a .glb file, got {}", MaxBytes, num_bytes));
}

/// Appends positions and normals. Returns the attributes of primitives.
files::Json append_shape(Arrays& arrays, std::span<const glm::vec3> positions,
                         std::vector<glm::vec3> normals) {
    normals.resize(positions.size(), glm::vec3(0.0f));
    for (glm::vec3& normal : normals)
        if (normal == glm::vec3(0.0f))
            normal.y = 1.0f;
    files::Json attributes;
    attributes.set("POSITION", arrays.append(positions));
    set_bounds(arrays.accessors.back(), positions);
    attributes.set("NORMAL", arrays.append(std::span<const glm::vec3>(normals)));
    return attributes;
}

files::Json primitive(const files::Json& attributes, std::size_t indices, std::size_t material) {
    return {{"attributes", attributes},
            {"indices", indices},
            {"material", material},
            {"mode", Triangles}};
}

std::size_t append_indices(Arrays& arrays, std::span<const Triangle> triangles) {
    return arrays.append(triangles, {UnsignedInt, "SCALAR", ElementArrayBuffer},
                         3 * triangles.size());
}

/// Returns the document without its materials. Nodes have a mesh each, and are moved by `offset`.
files::Json document_of(const Arrays& arrays, files::Json::Array nodes, files::Json meshes,
                        const glm::dvec3& offset) {
    using files::Json;
    Json::Array roots;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        nodes[i].set("mesh", i);
        if (offset != glm::dvec3(0.0))
            nodes[i].set("translation", Json::Array{offset.x, offset.y, offset.z});
        roots.push_back(i);
    }
    return {{"asset", {{"generator", "Relumine"}, {"version", "2.0"}}},
            {"buffers", Json::Array{{{"byteLength", arrays.bytes.size()}}}},
            {"bufferViews", arrays.views},
            {"accessors", arrays.accessors},
            {"meshes", std::move(meshes)},
            {"nodes", std::move(nodes)},
            {"scenes", Json::Array{{{"nodes", std::move(roots)}}}},
            {"scene", 0}};
}

/// A group of a mesh by itself: the mesh's vertices that it has, in their order, and its triangles.
/// A vertex that has several uvs comes again behind the others.
struct Part {
    std::vector<std::uint32_t> vertices = {};
    std::vector<glm::vec2> uvs = {};
    /// By material
    std::vector<std::vector<Triangle>> triangles = {};

    template<class Value>
    [[nodiscard]] std::vector<Value> of(const std::vector<Value>& all) const {
        std::vector<Value> result;
        for (std::size_t i = 0; i < vertices.size() && !all.empty(); ++i)
            result.push_back(all[vertices[i]]);
        return result;
    }
};

/// Returns the parts of a mesh: its groups, or all of it with vertices that no triangle has.
std::vector<Part> parts_of(const TriangleMesh& mesh, std::size_t num_materials) {
    constexpr std::uint32_t None = ~std::uint32_t{0};
    const bool has_groups = !mesh.triangle_groups.empty();
    std::vector<Part> parts(has_groups ? mesh.groups.size() : 1);
    std::vector<std::vector<std::uint32_t>> triangles(parts.size());
    for (std::uint32_t i = 0; i < mesh.num_triangles(); ++i)
        triangles[has_groups ? mesh.triangle_groups[i] : 0].push_back(i);
    std::vector<std::uint32_t> index(mesh.num_vertices(), None);
    for (std::size_t p = 0; p < parts.size(); ++p) {
        Part& part = parts[p];
        if (has_groups) {
            for (const std::uint32_t i : triangles[p])
                part.vertices.insert(part.vertices.end(), mesh.triangles[i].begin(),
                                     mesh.triangles[i].end());
            std::sort(part.vertices.begin(), part.vertices.end());
            part.vertices.erase(std::unique(part.vertices.begin(), part.vertices.end()),
                                part.vertices.end());
        } else {
            part.vertices.resize(mesh.num_vertices());
            std::iota(part.vertices.begin(), part.vertices.end(), 0u);
        }
        for (std::uint32_t i = 0; i < part.vertices.size(); ++i)
            index[part.vertices[i]] = i;
        part.uvs = part.of(mesh.uvs);
        part.triangles.resize(num_materials);
        std::vector<bool> has_uv(part.vertices.size());
        std::map<std::tuple<std::uint32_t, float, float>, std::uint32_t> copies;
        if (!mesh.corner_uvs.empty())
            part.uvs.resize(part.vertices.size(), glm::vec2(0.0f));
        for (const std::uint32_t i : triangles[p]) {
            Triangle own = mesh.triangles[i];
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t vertex = own[k];
                own[k] = index[vertex];
                if (mesh.corner_uvs.empty())
                    continue;
                const glm::vec2& uv = mesh.corner_uvs[i][k];
                if (!has_uv[own[k]]) {
                    has_uv[own[k]] = true;
                    part.uvs[own[k]] = uv;
                } else if (part.uvs[own[k]] != uv) {
                    const auto [copy, is_new] = copies.try_emplace(
                        {vertex, uv.x, uv.y}, static_cast<std::uint32_t>(part.uvs.size()));
                    own[k] = copy->second;
                    if (is_new) {
                        part.vertices.push_back(vertex);
                        part.uvs.push_back(uv);
                    }
                }
            }
            part.triangles[mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[i]]
                .push_back(own);
        }
    }
    return parts;
}

/// Appends the vertices of a part. Returns the attributes of its primitives.
files::Json append_vertices(Arrays& arrays, const TriangleMesh& mesh, const Part& part,
                            bool turns_v) {
    files::Json attributes = append_shape(arrays, part.of(mesh.positions), part.of(mesh.normals));
    if (!mesh.colors.empty())
        attributes.set("COLOR_0", arrays.append(std::span<const glm::vec3>(part.of(mesh.colors))));
    const auto set_uvs = [&](const char* name, std::vector<glm::vec2> uvs, bool turns) {
        if (uvs.empty())
            return;
        for (glm::vec2& uv : uvs)
            uv.y = turns ? 1.0f - uv.y : uv.y;
        attributes.set(name, arrays.append(std::span<const glm::vec2>(uvs),
                                           {Float, "VEC2", ArrayBuffer}, uvs.size()));
    };
    set_uvs("TEXCOORD_0", part.uvs, turns_v);
    set_uvs("TEXCOORD_1", part.of(mesh.second_uvs), false); // glTF alone has them
    return attributes;
}

} // namespace

std::string lit_glb(const TriangleMesh& mesh, std::span<const glm::vec3> radiance) {
    check_size(mesh, 48);
    Arrays arrays;
    files::Json attributes = append_shape(arrays, mesh.positions, mesh.normals);
    std::vector<glm::vec3> shown(radiance.begin(), radiance.end());
    for (glm::vec3& color : shown)
        color = glm::clamp(color, 0.0f, 1.0f);
    attributes.set("COLOR_0", arrays.append(std::span<const glm::vec3>(shown)));
    attributes.set("_RADIANCE", arrays.append(radiance));
    using files::Json;
    const std::size_t indices = append_indices(arrays, mesh.triangles);
    Json document = document_of(
        arrays, {Json::Object{}},
        Json::Array{{{"primitives", Json::Array{primitive(attributes, indices, 0)}}}}, mesh.offset);
    document.set("materials",
                 Json::Array{{{"name", "lit"},
                              {"doubleSided", true},
                              {"extensions", {{"KHR_materials_unlit", Json::Object{}}}}}});
    document.set("extensionsUsed", Json::Array{"KHR_materials_unlit"});
    return container(document.text(), arrays.bytes);
}

std::string glb(const TriangleMesh& mesh, std::vector<std::string>& left_out) {
    using files::Json;
    const GlbMaterials materials(mesh);
    std::uint64_t num_image_bytes = 0;
    for (const std::span<const std::byte> image : materials.images())
        num_image_bytes += image.size();
    check_size(mesh, 68, num_image_bytes);
    Arrays arrays;
    Json::Array nodes, meshes;
    const std::vector<Part> parts =
        parts_of(mesh, mesh.triangle_materials.empty() ? 1 : mesh.materials.size());
    for (std::size_t p = 0; p < parts.size(); ++p) {
        if (parts[p].vertices.empty())
            continue;
        const Json attributes = append_vertices(arrays, mesh, parts[p], materials.turns_v());
        Json::Array primitives;
        for (std::size_t i = 0; i < parts[p].triangles.size(); ++i)
            if (!parts[p].triangles[i].empty())
                primitives.push_back(
                    primitive(attributes, append_indices(arrays, parts[p].triangles[i]), i));
        meshes.push_back({{"primitives", std::move(primitives)}});
        nodes.push_back(mesh.triangle_groups.empty() ? Json(Json::Object{})
                                                     : Json{{"name", mesh.groups[p]}});
    }
    const std::size_t first_view = arrays.views.size();
    for (const std::span<const std::byte> image : materials.images())
        arrays.append_image(image);
    Json document = document_of(arrays, std::move(nodes), std::move(meshes), mesh.offset);
    materials.describe(document, first_view);
    left_out.insert(left_out.end(), materials.left_out().begin(), materials.left_out().end());
    return container(document.text(), arrays.bytes);
}

} // namespace relumine::mesh
