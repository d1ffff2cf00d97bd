#include "mesh/formats/glb_writer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/json.h"

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

void check_size(const TriangleMesh& mesh, std::uint64_t bytes_per_vertex) {
    const std::uint64_t num_bytes = std::uint64_t{mesh.num_vertices()} * bytes_per_vertex +
                                    std::uint64_t{mesh.num_triangles()} * 12;
    // Leaves room for the JSON part.
    constexpr std::uint64_t MaxBytes = std::numeric_limits<std::uint32_t>::max() - 65536;
    if (num_bytes > MaxBytes)
        throw std::runtime_error(
            fmt::format("expected at most {} bytes in a .glb file, got {}", MaxBytes, num_bytes));
}

/// Appends positions and normals. Returns the attributes of primitives.
files::Json append_shape(Arrays& arrays, const TriangleMesh& mesh) {
    std::vector<glm::vec3> normals = mesh.normals;
    normals.resize(mesh.num_vertices(), glm::vec3(0.0f));
    for (glm::vec3& normal : normals)
        if (normal == glm::vec3(0.0f))
            normal.y = 1.0f;
    files::Json attributes;
    attributes.set("POSITION", arrays.append(std::span<const glm::vec3>(mesh.positions)));
    set_bounds(arrays.accessors.back(), mesh.positions);
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

/// A file with one mesh, moved by its offset. `extensions` are the names of those that its
/// materials use.
std::string file_of(const Arrays& arrays, const TriangleMesh& mesh, files::Json materials,
                    files::Json primitives, const std::set<std::string>& extensions) {
    using files::Json;
    Json node = {{"mesh", 0}};
    if (const glm::dvec3& offset = mesh.offset; offset != glm::dvec3(0.0))
        node.set("translation", Json::Array{offset.x, offset.y, offset.z});
    Json document = {{"asset", {{"generator", "Relumine"}, {"version", "2.0"}}},
                     {"buffers", Json::Array{{{"byteLength", arrays.bytes.size()}}}},
                     {"bufferViews", arrays.views},
                     {"accessors", arrays.accessors},
                     {"materials", std::move(materials)},
                     {"meshes", Json::Array{{{"primitives", std::move(primitives)}}}},
                     {"nodes", Json::Array{std::move(node)}},
                     {"scenes", Json::Array{{{"nodes", Json::Array{0}}}}},
                     {"scene", 0}};
    if (!extensions.empty())
        document.set("extensionsUsed",
                     std::vector<std::string>(extensions.begin(), extensions.end()));
    return container(document.text(), arrays.bytes);
}

/// Phong's exponent becomes a roughness of about the same highlight. Adds the extensions that the
/// material needs.
files::Json material_of(const Material& material, std::set<std::string>& used) {
    using files::Json;
    const bool is_phong = material.model == MaterialModel::Phong;
    const double roughness = !is_phong ? double{material.roughness}
                             : material.specular == glm::vec3(0.0f)
                                 ? 1.0
                                 : std::pow(2.0 / (double{material.exponent} + 2.0), 0.25);
    Json result = {{"name", material.name},
                   {"pbrMetallicRoughness",
                    {{"baseColorFactor",
                      Json::Array{double{material.base_color.r}, double{material.base_color.g},
                                  double{material.base_color.b}, 1.0}},
                     {"metallicFactor", is_phong ? 0.0 : double{material.metallic}},
                     {"roughnessFactor", roughness}}}};
    if (material.is_double_sided)
        result.set("doubleSided", true);
    const glm::vec3& emission = material.emission;
    // Factors are at most 1; the extension has the rest.
    const float strength = std::max({emission.r, emission.g, emission.b});
    Json extensions = Json::Object{};
    if (strength > 0.0f)
        result.set("emissiveFactor", emission / std::max(strength, 1.0f));
    if (strength > 1.0f)
        extensions.set("KHR_materials_emissive_strength", {{"emissiveStrength", double{strength}}});
    if (material.transmission > 0.0f)
        extensions.set("KHR_materials_transmission",
                       {{"transmissionFactor", double{material.transmission}}});
    if (material.thickness > 0.0f) {
        Json volume = {{"thicknessFactor", double{material.thickness}},
                       {"attenuationColor", material.attenuation_color}};
        if (std::isfinite(material.attenuation_distance)) // its default is infinite
            volume.set("attenuationDistance", double{material.attenuation_distance});
        extensions.set("KHR_materials_volume", std::move(volume));
    }
    if (material.dispersion > 0.0f)
        extensions.set("KHR_materials_dispersion", {{"dispersion", double{material.dispersion}}});
    if (material.coat > 0.0f)
        extensions.set("KHR_materials_clearcoat",
                       {{"clearcoatFactor", double{material.coat}},
                        {"clearcoatRoughnessFactor", double{material.coat_roughness}}});
    if (material.sheen != glm::vec3(0.0f))
        extensions.set("KHR_materials_sheen",
                       {{"sheenColorFactor", material.sheen},
                        {"sheenRoughnessFactor", double{material.sheen_roughness}}});
    if (material.film > 0.0f)
        extensions.set("KHR_materials_iridescence",
                       {{"iridescenceFactor", double{material.film}},
                        {"iridescenceIor", double{material.film_ior}},
                        {"iridescenceThicknessMinimum", double{material.film_thickness_at_0}},
                        {"iridescenceThicknessMaximum", double{material.film_thickness_at_1}}});
    if (material.anisotropy > 0.0f)
        extensions.set("KHR_materials_anisotropy",
                       {{"anisotropyStrength", double{material.anisotropy}},
                        {"anisotropyRotation", double{material.anisotropy_rotation}}});
    if (material.ior != 1.5f)
        extensions.set("KHR_materials_ior", {{"ior", double{material.ior}}});
    if (material.specular_strength != 1.0f || material.specular_tint != glm::vec3(1.0f))
        extensions.set("KHR_materials_specular",
                       {{"specularFactor", double{material.specular_strength}},
                        {"specularColorFactor", material.specular_tint}});
    if (material.model == MaterialModel::Unlit)
        extensions.set("KHR_materials_unlit", Json::Object{});
    for (const auto& [name, value] : extensions.members())
        used.insert(name);
    if (extensions.size() != 0)
        result.set("extensions", extensions);
    return result;
}

} // namespace

std::string lit_glb(const TriangleMesh& mesh, std::span<const glm::vec3> radiance) {
    check_size(mesh, 48);
    Arrays arrays;
    files::Json attributes = append_shape(arrays, mesh);
    std::vector<glm::vec3> shown(radiance.begin(), radiance.end());
    for (glm::vec3& color : shown)
        color = glm::clamp(color, 0.0f, 1.0f);
    attributes.set("COLOR_0", arrays.append(std::span<const glm::vec3>(shown)));
    attributes.set("_RADIANCE", arrays.append(radiance));
    using files::Json;
    const std::size_t indices = append_indices(arrays, mesh.triangles);
    return file_of(arrays, mesh,
                   Json::Array{{{"name", "lit"},
                                {"doubleSided", true},
                                {"extensions", {{"KHR_materials_unlit", Json::Object{}}}}}},
                   Json::Array{primitive(attributes, indices, 0)}, {"KHR_materials_unlit"});
}

std::string glb(const TriangleMesh& mesh) {
    check_size(mesh, 36);
    Arrays arrays;
    files::Json attributes = append_shape(arrays, mesh);
    if (!mesh.colors.empty())
        attributes.set("COLOR_0", arrays.append(std::span<const glm::vec3>(mesh.colors)));
    std::vector<Material> materials = mesh.materials;
    if (mesh.triangle_materials.empty())
        materials = {Material{.name = "surface"}};
    std::vector<std::vector<Triangle>> by_material(materials.size());
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i)
        by_material[mesh.triangle_materials.empty() ? 0 : mesh.triangle_materials[i]].push_back(
            mesh.triangles[i]);
    files::Json::Array descriptions, primitives;
    std::set<std::string> extensions;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        descriptions.push_back(material_of(materials[i], extensions));
        if (!by_material[i].empty())
            primitives.push_back(primitive(attributes, append_indices(arrays, by_material[i]), i));
    }
    return file_of(arrays, mesh, std::move(descriptions), std::move(primitives), extensions);
}

} // namespace relumine::mesh
