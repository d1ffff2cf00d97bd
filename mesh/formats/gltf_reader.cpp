// Reads glTF 2.0: all triangle primitives of the nodes of the default scene, in world space, with
// their materials.
//
// A vertex is repeated for each node and each instance (EXT_mesh_gpu_instancing) that shows it.
// Points and lines are skipped. Skins and morph targets stay at rest, as the file stores them; as
// the format demands, a skinned mesh ignores its node's place.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <glm/mat4x4.hpp>
#include <glm/matrix.hpp>

#include "mesh/formats/draco_decoder.h"
#include "mesh/formats/gltf_accessors.h"
#include "mesh/formats/gltf_document.h"
#include "mesh/formats/gltf_materials.h"
#include "mesh/formats/polygon_soup.h"
#include "mesh/normals.h"

namespace relumine::mesh {

namespace {

using gltf::Json;

/// The primitive's arrays as the file has them, before any node places them.
struct Primitive {
    std::vector<glm::vec3> positions, normals, colors;
    std::vector<glm::vec2> uvs;
    std::vector<Triangle> triangles;
    std::uint32_t material = 0;
};

/// A place in the form of nodes and instances: the scale comes first, the translation last.
struct Placement {
    std::vector<double> translation = {0.0, 0.0, 0.0};
    /// A quaternion: x, y, z, w.
    std::vector<double> rotation = {0.0, 0.0, 0.0, 1.0};
    std::vector<double> scale = {1.0, 1.0, 1.0};
};

glm::dmat4 matrix_of(const Placement& placement) {
    const auto& [t, r, s] = placement;
    const double length = std::sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
    if (!(length > 0.0))
        throw std::runtime_error("expected a unit quaternion as \"rotation\", got zeros");
    const glm::dmat3 rotation =
        glm::mat3_cast(glm::dquat(r[3] / length, r[0] / length, r[1] / length, r[2] / length));
    return {glm::dvec4(rotation[0] * s[0], 0.0), glm::dvec4(rotation[1] * s[1], 0.0),
            glm::dvec4(rotation[2] * s[2], 0.0), glm::dvec4(t[0], t[1], t[2], 1.0)};
}

glm::dmat4 local_transform(const Json& node) {
    if (node.find("matrix")) {
        const std::vector<double> m = gltf::numbers(node, "matrix", std::vector<double>(16, 0.0));
        glm::dmat4 matrix(1.0);
        for (int i = 0; i < 16; ++i)
            matrix[i / 4][i % 4] = m[static_cast<std::size_t>(i)];
        return matrix;
    }
    const Placement none;
    return matrix_of({.translation = gltf::numbers(node, "translation", none.translation),
                      .rotation = gltf::numbers(node, "rotation", none.rotation),
                      .scale = gltf::numbers(node, "scale", none.scale)});
}

/// Returns a perspective camera at a node, with a target one unit ahead; nothing for others, and
/// for values that no picture can have.
std::optional<Camera> camera_at(const Json& camera, const glm::dmat4& transform) {
    const Json* perspective = camera.find("perspective");
    if (perspective == nullptr)
        return std::nullopt;
    const double fov = gltf::number(*perspective, "yfov", 0.0);
    const glm::dvec3 eye(transform[3]), ahead = -glm::dvec3(transform[2]);
    const double length = glm::length(ahead);
    constexpr double Farthest = 1e18;
    if (!(fov > 0.0 && fov < std::numbers::pi) || !(length > 0.0 && length < Farthest) ||
        !(glm::length(eye) < Farthest))
        return std::nullopt;
    return Camera{.eye = glm::vec3(eye),
                  .target = glm::vec3(eye + ahead / length),
                  .fov_degrees = static_cast<float>(fov * 180.0 / std::numbers::pi)};
}

/// Puts a camera's target as far ahead as the middle of the mesh is.
Camera looking_at(const std::vector<glm::vec3>& positions, Camera camera) {
    if (positions.empty())
        return camera;
    const auto& [low, high] = bounds(positions);
    const glm::dvec3 eye(camera.eye), ahead = glm::dvec3(camera.target) - eye;
    double distance = glm::dot(0.5 * (glm::dvec3(low) + glm::dvec3(high)) - eye, ahead);
    if (!(distance > 0.0) || !std::isfinite(distance))
        distance = 0.5 * glm::distance(glm::dvec3(low), glm::dvec3(high));
    if (distance > 0.0 && std::isfinite(distance))
        camera.target = glm::vec3(eye + distance * ahead);
    return camera;
}

class GltfReader {
public:
    GltfReader(std::span<const std::byte> bytes, const std::filesystem::path& folder,
               std::uint64_t max_bytes)
        : document_(bytes, folder, max_bytes) {}
    PolygonSoup read();

private:
    [[nodiscard]] std::vector<std::uint64_t> root_nodes() const;
    [[nodiscard]] const std::vector<Primitive>& mesh(std::uint64_t index);
    [[nodiscard]] std::optional<Primitive> primitive(const Json& description);
    [[nodiscard]] std::vector<Triangle> triangles(const Json& description, std::uint64_t mode,
                                                  std::size_t num_vertices);
    void check_counts(const Json& description, const DracoMesh& mesh);
    [[nodiscard]] std::vector<glm::dmat4> instances(const Json& node);
    void take_memory(const Primitive& primitive, std::size_t num_times);
    void append(const Primitive& primitive, const glm::dmat4& transform, std::uint32_t group);
    [[nodiscard]] std::uint32_t group(const Json& node, std::uint64_t mesh);
    [[nodiscard]] std::uint32_t default_material();

    gltf::Document document_;
    gltf::Materials materials_;
    std::vector<std::optional<std::vector<Primitive>>> meshes_;
    std::optional<std::uint32_t> default_material_;
    std::map<std::string, std::uint32_t> group_indices_;
    PolygonSoup soup_;
    bool has_colors_ = false, has_uvs_ = false, has_skins_ = false, has_targets_ = false;
};

/// Returns the roots of the default scene, or of the first one. In a file without scenes, nodes
/// without parents are the roots.
std::vector<std::uint64_t> GltfReader::root_nodes() const {
    const auto indices = [](const Json& owner, const char* key) {
        std::vector<std::uint64_t> result;
        for (const Json& item : gltf::items(owner, key))
            result.push_back(gltf::whole_value(item, "nodes"));
        return result;
    };
    if (document_.count("scenes") > 0)
        return indices(document_.element("scenes", gltf::whole(document_.root(), "scene", 0)),
                       "nodes");
    std::vector<bool> is_child(document_.count("nodes"), false);
    for (std::size_t i = 0; i < is_child.size(); ++i)
        for (const std::uint64_t node : indices(document_.element("nodes", i), "children"))
            if (node < is_child.size())
                is_child[node] = true;
    std::vector<std::uint64_t> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i)
        if (!is_child[i])
            roots.push_back(i);
    return roots;
}

std::vector<Triangle> GltfReader::triangles(const Json& description, std::uint64_t mode,
                                            std::size_t num_vertices) {
    std::vector<std::uint32_t> indices;
    if (description.find("indices")) {
        indices = gltf::read_indices(document_, gltf::whole(description, "indices"));
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

std::uint32_t GltfReader::default_material() {
    if (!default_material_) {
        default_material_ = static_cast<std::uint32_t>(materials_.materials.size());
        materials_.materials.push_back({.name = "default",
                                        .model = MaterialModel::MetallicRoughness,
                                        .metallic = 1.0f,
                                        .times_vertex_color = true});
        materials_.uv_sets.emplace_back();
    }
    return *default_material_;
}

template<class Vector>
std::vector<Vector> vectors(const gltf::Floats& floats) {
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
    Attributes(gltf::Document& document, const Json& description);

    [[nodiscard]] bool contains(const std::string& name) const {
        return accessors_.find(name) != nullptr;
    }
    [[nodiscard]] gltf::Floats read(const std::string& name, std::uint32_t num_components);
    /// Empty: the primitive is not compressed.
    [[nodiscard]] std::optional<DracoMesh>& draco() { return draco_; }

private:
    gltf::Document& document_;
    const Json& accessors_;
    std::optional<DracoMesh> draco_;
    /// Places in DracoMesh::values.
    std::map<std::string, std::size_t> places_;
};

Attributes::Attributes(gltf::Document& document, const Json& description)
    : document_(document), accessors_(gltf::child(description, "attributes")) {
    const Json& extension =
        gltf::child(gltf::child(description, "extensions"), "KHR_draco_mesh_compression");
    if (extension.size() == 0)
        return;
    const Json& ids = gltf::child(extension, "attributes");
    std::vector<DracoAttribute> wanted;
    const auto add = [&](const std::string& name, std::uint32_t num_components) {
        if (!ids.find(name) || !contains(name))
            return;
        const Json& accessor = document.element("accessors", gltf::whole(accessors_, name.c_str()));
        places_.emplace(name, wanted.size());
        wanted.push_back({.id = static_cast<std::uint32_t>(gltf::whole(ids, name.c_str())),
                          .num_components = num_components,
                          .is_normalized = gltf::flag(accessor, "normalized")});
    };
    add("POSITION", 3), add("NORMAL", 3), add("COLOR_0", 3);
    for (const auto& [name, id] : ids.members())
        if (name.starts_with("TEXCOORD_"))
            add(name, 2);
    draco_ = decode_draco(document.view(gltf::whole(extension, "bufferView")), wanted);
}

gltf::Floats Attributes::read(const std::string& name, std::uint32_t num_components) {
    if (const auto place = places_.find(name); place != places_.end())
        return {.count = draco_->num_vertices, .values = std::move(draco_->values[place->second])};
    return gltf::read_floats(document_, gltf::whole(accessors_, name.c_str()), num_components);
}

/// The accessors of compressed arrays say how many elements there are. Some encoders leave the
/// counts of the mesh before compression; the data govern then, as in other readers.
void GltfReader::check_counts(const Json& description, const DracoMesh& mesh) {
    const auto declared = [&](const Json& parent, const char* key, std::uint64_t fallback) {
        return parent.find(key)
                   ? gltf::whole(document_.element("accessors", gltf::whole(parent, key)), "count")
                   : fallback;
    };
    const std::uint64_t num_corners = 3 * mesh.triangles.size();
    const std::uint64_t vertices =
        declared(gltf::child(description, "attributes"), "POSITION", mesh.num_vertices);
    // A strip's accessor counts the strip.
    const std::uint64_t corners = gltf::whole(description, "mode", 4) == 4
                                      ? declared(description, "indices", num_corners)
                                      : num_corners;
    if (vertices != mesh.num_vertices || corners != num_corners)
        soup_.warnings.push_back(
            fmt::format("Draco data of {} vertices and {} indices; the accessors say {} and {}",
                        mesh.num_vertices, num_corners, vertices, corners));
}

std::optional<Primitive> GltfReader::primitive(const Json& description) {
    const std::uint64_t mode = gltf::whole(description, "mode", 4);
    if (mode > 6)
        throw std::runtime_error(
            fmt::format("expected a primitive's mode of 0 to 6, got {}", mode));
    if (mode < 4 || !gltf::child(description, "attributes").find("POSITION"))
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
    read("COLOR_0", result.colors);
    if (description.find("material")) {
        const std::uint64_t material = gltf::whole(description, "material");
        static_cast<void>(document_.element("materials", material)); // checks the range
        result.material = static_cast<std::uint32_t>(material);
    } else {
        result.material = default_material();
    }
    read(fmt::format("TEXCOORD_{}", materials_.uv_sets[result.material].value_or(0)), result.uvs);
    if (std::optional<DracoMesh>& draco = attributes.draco()) {
        if (draco->num_vertices != result.positions.size())
            throw std::runtime_error(fmt::format("expected Draco data of {} vertices, got {}",
                                                 result.positions.size(), draco->num_vertices));
        check_counts(description, *draco);
        result.triangles = std::move(draco->triangles);
    } else {
        result.triangles = triangles(description, mode, result.positions.size());
    }
    if (result.normals.empty()) {
        TriangleMesh plain;
        plain.positions = result.positions;
        plain.triangles = result.triangles;
        result.normals = smooth_normals(plain);
    }
    return result;
}

const std::vector<Primitive>& GltfReader::mesh(std::uint64_t index) {
    const Json& description = document_.element("meshes", index);
    std::optional<std::vector<Primitive>>& mesh = meshes_[index];
    if (!mesh) {
        mesh.emplace();
        for (const Json& item : gltf::items(description, "primitives")) {
            has_targets_ |= gltf::child(item, "targets").size() != 0;
            if (std::optional<Primitive> read = primitive(item)) {
                take_memory(*read, 1);
                mesh->push_back(std::move(*read));
            }
        }
    }
    return *mesh;
}

/// Returns the places of a node's instances in the node. EXT_mesh_gpu_instancing has them as arrays
/// of translations, rotations and scales.
std::vector<glm::dmat4> GltfReader::instances(const Json& node) {
    const Json& extension = gltf::child(gltf::child(node, "extensions"), "EXT_mesh_gpu_instancing");
    if (extension.size() == 0)
        return {glm::dmat4(1.0)};
    const Json& attributes = gltf::child(extension, "attributes");
    std::optional<std::size_t> count;
    const auto read = [&](const char* name, std::uint32_t num_components) {
        if (!attributes.find(name))
            return std::vector<float>();
        gltf::Floats floats =
            gltf::read_floats(document_, gltf::whole(attributes, name), num_components);
        if (count && *count != floats.count)
            throw std::runtime_error(
                fmt::format("expected {} elements of {}, as many as of the instances' other "
                            "attributes, got {}",
                            *count, name, floats.count));
        count = floats.count;
        return std::move(floats.values);
    };
    const std::vector<float> translations = read("TRANSLATION", 3);
    const std::vector<float> rotations = read("ROTATION", 4), scales = read("SCALE", 3);
    if (!count)
        throw std::runtime_error(
            "expected TRANSLATION, ROTATION or SCALE of a node's instances, got none");
    std::vector<glm::dmat4> result;
    for (std::size_t i = 0; i < *count; ++i) {
        const auto value = [i](const std::vector<float>& values, std::size_t size, std::size_t j,
                               double fallback) {
            return values.empty() ? fallback : double{values[i * size + j]};
        };
        Placement placement;
        for (std::size_t j = 0; j < 4; ++j)
            placement.rotation[j] = value(rotations, 4, j, placement.rotation[j]);
        for (std::size_t j = 0; j < 3; ++j) {
            placement.translation[j] = value(translations, 3, j, 0.0);
            placement.scale[j] = value(scales, 3, j, 1.0);
        }
        result.push_back(matrix_of(placement));
    }
    return result;
}

/// Nodes are the file's objects. A node without a name takes its mesh's name.
std::uint32_t GltfReader::group(const Json& node, std::uint64_t mesh) {
    std::string name = gltf::text(node, "name");
    if (name.empty())
        name = gltf::text(document_.element("meshes", mesh), "name");
    if (name.empty())
        name = fmt::format("mesh {}", mesh);
    const auto [place, is_new] =
        group_indices_.try_emplace(name, static_cast<std::uint32_t>(soup_.groups.size()));
    if (is_new)
        soup_.groups.push_back(name);
    return place->second;
}

/// Nodes repeat meshes, and primitives repeat accessors: 64 KB of glTF could make thousands of
/// millions of vertices.
void GltfReader::take_memory(const Primitive& primitive, std::size_t num_times) {
    // A vertex and a triangle of a PolygonSoup take 44 and 28 bytes, of the TriangleMesh that it
    // becomes 20 more, and vectors that grow have twice that.
    constexpr std::uint64_t Each = 128;
    document_.take_memory(Each * num_times *
                          (primitive.positions.size() + primitive.triangles.size()));
}

void GltfReader::append(const Primitive& primitive, const glm::dmat4& transform,
                        std::uint32_t group) {
    const std::size_t first = soup_.positions.size();
    if (first + primitive.positions.size() > std::numeric_limits<std::uint32_t>::max())
        throw std::runtime_error("expected at most 4294967295 vertices, got more");
    // Normals are transformed by the cofactors: the transposed inverse times the determinant.
    // Singular matrices have cofactors too.
    const glm::dmat3 linear(transform);
    const glm::dmat3 cofactors(glm::cross(linear[1], linear[2]), glm::cross(linear[2], linear[0]),
                               glm::cross(linear[0], linear[1]));
    const bool is_mirrored = glm::dot(linear[0], cofactors[0]) < 0.0;
    for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
        soup_.positions.emplace_back(transform * glm::dvec4(primitive.positions[i], 1.0));
        const glm::dvec3 normal = cofactors * glm::dvec3(primitive.normals[i]);
        const double length = glm::length(normal);
        soup_.normals.emplace_back(length > 0.0 ? normal / (is_mirrored ? -length : length)
                                                : normal);
    }
    has_colors_ |= !primitive.colors.empty();
    has_uvs_ |= !primitive.uvs.empty();
    soup_.colors.insert(soup_.colors.end(), primitive.colors.begin(), primitive.colors.end());
    soup_.colors.resize(soup_.positions.size(), glm::vec3(1.0f));
    soup_.uvs.insert(soup_.uvs.end(), primitive.uvs.begin(), primitive.uvs.end());
    soup_.uvs.resize(soup_.positions.size(), glm::vec2(0.0f));
    for (const auto& [a, b, c] : primitive.triangles) {
        for (const std::uint32_t corner : {a, is_mirrored ? c : b, is_mirrored ? b : c})
            soup_.corners.push_back(static_cast<std::uint32_t>(first) + corner);
        soup_.end_face();
        soup_.face_materials.push_back(primitive.material);
        soup_.face_groups.push_back(group);
    }
}

PolygonSoup GltfReader::read() {
    materials_ = gltf::read_materials(document_);
    meshes_.resize(document_.count("meshes"));
    // Nodes are trees. A node that is met twice has two parents or is its own ancestor.
    struct Visit {
        std::uint64_t node;
        glm::dmat4 parent;
    };
    std::vector<Visit> to_visit;
    std::vector<bool> visited(document_.count("nodes"), false);
    std::optional<Camera> camera;
    const std::vector<std::uint64_t> roots = root_nodes();
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        to_visit.push_back({*root, glm::dmat4(1.0)});
    while (!to_visit.empty()) {
        const Visit visit = to_visit.back();
        to_visit.pop_back();
        const Json& node = document_.element("nodes", visit.node);
        if (visited[visit.node])
            throw std::runtime_error(
                fmt::format("expected nodes with one parent, got node {} twice", visit.node));
        visited[visit.node] = true;
        const glm::dmat4 transform = visit.parent * local_transform(node);
        if (node.find("mesh")) {
            const std::uint64_t index = gltf::whole(node, "mesh");
            has_skins_ |= node.find("skin") != nullptr;
            const std::vector<glm::dmat4> places = instances(node);
            for (const Primitive& primitive : mesh(index))
                take_memory(primitive, places.size());
            for (const glm::dmat4& place : places)
                for (const Primitive& primitive : mesh(index))
                    append(primitive, node.find("skin") ? glm::dmat4(1.0) : transform * place,
                           group(node, index));
        }
        if (!camera && node.find("camera"))
            camera =
                camera_at(document_.element("cameras", gltf::whole(node, "camera")), transform);
        const Json::Array& children = gltf::items(node, "children");
        for (std::size_t i = children.size(); i-- > 0;)
            to_visit.push_back({gltf::whole_value(children[i], "children"), transform});
    }
    if (camera)
        soup_.camera = looking_at(soup_.positions, *camera);
    if (!has_colors_)
        soup_.colors.clear();
    if (!has_uvs_)
        soup_.uvs.clear();
    soup_.materials = std::move(materials_.materials);
    soup_.textures = std::move(materials_.textures);
    soup_.missing = std::move(materials_.missing);
    std::vector<std::string> warnings = document_.warnings();
    warnings.insert(warnings.end(), materials_.warnings.begin(), materials_.warnings.end());
    if (has_skins_)
        warnings.emplace_back("skins are at rest: their joints move nothing");
    if (has_targets_)
        warnings.emplace_back("morph targets are at rest: their weights are 0");
    soup_.warnings.insert(soup_.warnings.begin(), warnings.begin(), warnings.end());
    return std::move(soup_);
}

} // namespace

PolygonSoup read_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                      std::uint64_t max_bytes) {
    try {
        return GltfReader(bytes, folder, max_bytes).read();
    } catch (const files::JsonError&) {
        throw std::runtime_error("expected glTF's JSON, got a value of another type");
    }
}

} // namespace relumine::mesh
