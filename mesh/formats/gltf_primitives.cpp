#include "mesh/formats/gltf_primitives.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <fmt/format.h>

#include "mesh/formats/draco_decoder.h"
#include "mesh/formats/gltf_accessors.h"

namespace relumine::mesh::gltf {

namespace {

template<class Vector>
std::vector<Vector> vectors(const Floats& floats) {
    std::vector<Vector> result(floats.count);
    for (std::size_t i = 0; i < result.size(); ++i)
        for (int j = 0; j < Vector::length(); ++j)
            result[i][j] = floats.values[i * static_cast<std::size_t>(Vector::length()) +
                                         static_cast<std::size_t>(j)];
    return result;
}

/// The arrays of a primitive by name. KHR_draco_mesh_compression holds some or all of them.
class Attributes {
public:
    Attributes(Document& document, const Json& description);

    [[nodiscard]] bool contains(const std::string& name) const {
        return accessors_.find(name) != nullptr;
    }
    [[nodiscard]] Floats read(const std::string& name, std::uint32_t num_components);
    /// Empty: the primitive is not compressed.
    [[nodiscard]] std::optional<DracoMesh>& draco() { return draco_; }

private:
    Document& document_;
    const Json& accessors_;
    std::optional<DracoMesh> draco_;
    /// Places in DracoMesh::values.
    std::map<std::string, std::size_t> places_;
};

Attributes::Attributes(Document& document, const Json& description)
    : document_(document), accessors_(child(description, "attributes")) {
    const Json& extension = child(child(description, "extensions"), "KHR_draco_mesh_compression");
    if (extension.size() == 0)
        return;
    const Json& ids = child(extension, "attributes");
    std::vector<DracoAttribute> wanted;
    const auto add = [&](const std::string& name, std::uint32_t num_components) {
        if (!ids.find(name) || !contains(name))
            return;
        const Json& accessor = document.element("accessors", whole(accessors_, name.c_str()));
        places_.emplace(name, wanted.size());
        wanted.push_back({.id = static_cast<std::uint32_t>(whole(ids, name.c_str())),
                          .num_components = num_components,
                          .is_normalized = flag(accessor, "normalized")});
    };
    add("POSITION", 3), add("NORMAL", 3), add("TANGENT", 4), add("COLOR_0", 3);
    for (const auto& [name, id] : ids.members())
        if (name.starts_with("TEXCOORD_"))
            add(name, 2);
        else if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_"))
            add(name, 4);
    draco_ = decode_draco(document.view(whole(extension, "bufferView")), wanted);
}

Floats Attributes::read(const std::string& name, std::uint32_t num_components) {
    if (const auto place = places_.find(name); place != places_.end())
        return {.count = draco_->num_vertices, .values = std::move(draco_->values[place->second])};
    return read_floats(document_, whole(accessors_, name.c_str()), num_components);
}

} // namespace

std::vector<Triangle> PrimitiveReader::triangles(const Json& description, std::uint64_t mode,
                                                 std::size_t num_vertices) {
    std::vector<std::uint32_t> indices;
    if (description.find("indices")) {
        indices = read_indices(document_, whole(description, "indices"));
        for (const std::uint32_t index : indices)
            if (index >= num_vertices)
                throw std::runtime_error(
                    fmt::format("expected vertex indices below {}, got {}", num_vertices, index));
    } else {
        indices.resize(num_vertices);
        for (std::size_t i = 0; i < num_vertices; ++i)
            indices[i] = static_cast<std::uint32_t>(i);
    }
    const std::size_t n = indices.size();
    if (n < 3 || (mode == 4 && n % 3 != 0))
        throw std::runtime_error(fmt::format("expected {} indices of triangles, got {}",
                                             mode == 4 ? "a multiple of 3" : "3 or more", n));
    std::vector<Triangle> result;
    if (mode == 4) // triangles
        for (std::size_t i = 0; i < n; i += 3)
            result.push_back({indices[i], indices[i + 1], indices[i + 2]});
    else if (mode == 5) // strip: every second triangle is turned
        for (std::size_t i = 0; i + 2 < n; ++i)
            result.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
    else // fan
        for (std::size_t i = 1; i + 1 < n; ++i)
            result.push_back({indices[i], indices[i + 1], indices[0]});
    return result;
}

std::uint32_t PrimitiveReader::default_material() {
    if (!default_material_) {
        default_material_ = static_cast<std::uint32_t>(materials_.materials.size());
        materials_.materials.push_back({.name = "default",
                                        .model = MaterialModel::MetallicRoughness,
                                        .metallic = 1.0f,
                                        .times_vertex_color = true,
                                        .is_double_sided = false});
        materials_.uv_sets.emplace_back();
    }
    return *default_material_;
}

/// Returns the material of the variant, or else the primitive's own one.
std::uint32_t PrimitiveReader::material(const Json& description) {
    const auto checked = [this](std::uint64_t index) {
        static_cast<void>(document_.element("materials", index)); // checks the range
        return static_cast<std::uint32_t>(index);
    };
    if (variant_)
        for (const Json& mapping :
             items(child(child(description, "extensions"), "KHR_materials_variants"), "mappings"))
            for (const Json& variant : items(mapping, "variants"))
                if (whole_value(variant, "variants") == *variant_)
                    return checked(whole(mapping, "material"));
    return description.find("material") ? checked(whole(description, "material"))
                                        : default_material();
}

/// The accessors of compressed arrays say how many elements there are. Some encoders leave the
/// counts of the mesh before compression; the data govern then, as in other readers.
void PrimitiveReader::check_counts(const Json& description, const DracoMesh& mesh) {
    const auto declared = [&](const Json& parent, const char* key, std::uint64_t fallback) {
        return parent.find(key) ? whole(document_.element("accessors", whole(parent, key)), "count")
                                : fallback;
    };
    const std::uint64_t num_corners = 3 * mesh.triangles.size();
    const std::uint64_t vertices =
        declared(child(description, "attributes"), "POSITION", mesh.num_vertices);
    // A strip's accessor counts the strip.
    const std::uint64_t corners = whole(description, "mode", 4) == 4
                                      ? declared(description, "indices", num_corners)
                                      : num_corners;
    if (vertices != mesh.num_vertices || corners != num_corners)
        materials_.warnings.push_back(
            fmt::format("Draco data of {} vertices and {} indices; the accessors say {} and {}",
                        mesh.num_vertices, num_corners, vertices, corners));
}

/// Colours of whole numbers have to be normalized [glTF 2.0, 3.7.2.1]. Those of some exporters are
/// without the mark.
void PrimitiveReader::scale_colors(const Json& description, std::vector<glm::vec3>& colors) {
    const Json& accessor =
        document_.element("accessors", whole(child(description, "attributes"), "COLOR_0"));
    const std::uint64_t type = whole(accessor, "componentType");
    constexpr std::uint64_t Byte = 5121, Short = 5123;
    if (flag(accessor, "normalized") || (type != Byte && type != Short))
        return;
    for (glm::vec3& color : colors)
        color /= type == Byte ? 255.0f : 65535.0f;
    const std::string warning =
        fmt::format("COLOR_0 has whole numbers that are not marked as normalized: {} counts as 1",
                    type == Byte ? 255 : 65535);
    auto& warnings = materials_.warnings;
    if (std::find(warnings.begin(), warnings.end(), warning) == warnings.end())
        warnings.push_back(warning);
}

std::optional<Primitive> PrimitiveReader::read(const Json& description) {
    const std::uint64_t mode = whole(description, "mode", 4);
    if (mode > 6)
        throw std::runtime_error(
            fmt::format("expected a primitive's mode of 0 to 6, got {}", mode));
    if (mode < 4 || !child(description, "attributes").find("POSITION"))
        return std::nullopt;
    Attributes attributes(document_, description);
    Primitive result;
    const auto read = [&](const std::string& name, auto& values) {
        using Vector = typename std::remove_reference_t<decltype(values)>::value_type;
        if (!attributes.contains(name))
            return;
        values = vectors<Vector>(attributes.read(name, Vector::length()));
        if (values.size() != result.positions.size())
            throw std::runtime_error(
                fmt::format("expected {} elements of {}, as many as of POSITION, got {}",
                            result.positions.size(), name, values.size()));
    };
    read("POSITION", result.positions);
    read("NORMAL", result.normals);
    // Our lit meshes have the light beside the colours that viewers show.
    const bool is_lit = text(child(document_.root(), "asset"), "generator") == "Relumine" &&
                        attributes.contains("_RADIANCE");
    read(is_lit ? "_RADIANCE" : "COLOR_0", result.colors);
    if (!result.colors.empty())
        scale_colors(description, result.colors);
    result.material = material(description);
    const auto& sets = materials_.uv_sets[result.material];
    read(fmt::format("TEXCOORD_{}", sets[0].value_or(0)), result.uvs);
    const std::uint32_t first = sets[0].value_or(0);
    if (const auto second = sets[1] ? sets[1] : lightmap_uvs_; second == first)
        result.second_uvs = result.uvs;
    else if (second)
        read(fmt::format("TEXCOORD_{}", *second), result.second_uvs);
    if (materials_.materials[result.material].normal_texture)
        read("TANGENT", result.tangents);
    for (std::size_t set = 0; attributes.contains(fmt::format("JOINTS_{}", set)) &&
                              attributes.contains(fmt::format("WEIGHTS_{}", set));
         ++set) {
        Influences& influences = result.influences.emplace_back();
        read(fmt::format("JOINTS_{}", set), influences.joints);
        read(fmt::format("WEIGHTS_{}", set), influences.weights);
    }
    if (std::optional<DracoMesh>& draco = attributes.draco()) {
        if (draco->num_vertices != result.positions.size())
            throw std::runtime_error(fmt::format("expected Draco data of {} vertices, got {}",
                                                 result.positions.size(), draco->num_vertices));
        check_counts(description, *draco);
        result.triangles = std::move(draco->triangles);
    } else {
        result.triangles = triangles(description, mode, result.positions.size());
    }
    result.description = &description;
    // Faces without normals are flat, and their tangents do not count [glTF 2.0, 3.7.2.1].
    if (result.normals.empty())
        result.tangents.clear();
    return result;
}

bool joined(Primitive& before, const Primitive& next) {
    const auto text = [](const Primitive& primitive, const char* key) {
        const Json* member = primitive.description->find(key);
        return member == nullptr ? std::string() : member->text();
    };
    const auto is_compressed = [](const Primitive& primitive) {
        return child(child(*primitive.description, "extensions"), "KHR_draco_mesh_compression")
                   .size() != 0;
    };
    // What materials ask for may differ: which uvs, and tangents. Vertices without normals are
    // taken apart again.
    if (before.normals.empty() || next.normals.empty() || is_compressed(before) ||
        is_compressed(next) || text(before, "attributes") != text(next, "attributes") ||
        text(before, "targets") != text(next, "targets") || before.uvs != next.uvs ||
        before.second_uvs != next.second_uvs || before.tangents != next.tangents)
        return false;
    before.later_materials.push_back({before.triangles.size(), next.material});
    before.triangles.insert(before.triangles.end(), next.triangles.begin(), next.triangles.end());
    return true;
}

std::optional<Primitive> morphed(Document& document, const Primitive& primitive,
                                 std::span<const double> weights) {
    const std::size_t num_targets = items(*primitive.description, "targets").size();
    if (weights.empty() || num_targets == 0)
        return std::nullopt;
    if (weights.size() != num_targets)
        throw std::runtime_error(fmt::format(
            "expected {} weights, one for each morph target, got {}", num_targets, weights.size()));
    if (std::all_of(weights.begin(), weights.end(), [](double weight) { return weight == 0.0; }))
        return std::nullopt;
    take_memory(document, primitive, 1);
    Primitive result = primitive;
    add_targets(document, *primitive.description, "POSITION", weights, result.positions);
    if (!result.normals.empty())
        add_targets(document, *primitive.description, "NORMAL", weights, result.normals);
    if (!result.tangents.empty())
        add_targets(document, *primitive.description, "TANGENT", weights, result.tangents);
    return result;
}

void take_memory(Document& document, const Primitive& primitive, std::size_t num_times) {
    // A vertex and a triangle of a PolygonSoup take 44 and 28 bytes, of the TriangleMesh that it
    // becomes 20 more, and vectors that grow have twice that. Each corner of a flat triangle may
    // become a vertex.
    constexpr std::uint64_t Each = 128;
    const std::size_t per_triangle = primitive.normals.empty() ? 4 : 1;
    document.take_memory(Each * num_times *
                         (primitive.positions.size() + per_triangle * primitive.triangles.size()));
}

} // namespace relumine::mesh::gltf
