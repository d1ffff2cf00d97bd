// Reads glTF 2.0: all triangle primitives of the nodes of the default scene, in world space, with
// their materials.
//
// A vertex is repeated for each node and each instance (EXT_mesh_gpu_instancing) that shows it.
// Points and lines are skipped. Skins and morph targets are in the pose that the nodes describe, or
// in a moment of an animation; as the format demands, a skinned mesh ignores its node's place.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/mat4x4.hpp>

#include "files/counted.h"
#include "mesh/formats/gltf_accessors.h"
#include "mesh/formats/gltf_deformation.h"
#include "mesh/formats/gltf_document.h"
#include "mesh/formats/gltf_left_out.h"
#include "mesh/formats/gltf_lights.h"
#include "mesh/formats/gltf_materials.h"
#include "mesh/formats/gltf_nodes.h"
#include "mesh/formats/gltf_primitives.h"
#include "mesh/formats/gltf_variants.h"
#include "mesh/formats/polygon_soup.h"

namespace relumine::mesh {

namespace {

using gltf::Json;
using gltf::Primitive;

/// An orthographic camera is drawn from so many diagonals of the mesh away: what is one diagonal
/// nearer looks 2 % larger.
constexpr double FarInDiagonals = 50.0;

/// Puts a camera's target as far ahead as the middle of the mesh is. An orthographic camera goes
/// far back.
Camera looking_at(const std::vector<glm::vec3>& positions, const gltf::FileCamera& of_file) {
    Camera camera = of_file.camera;
    if (positions.empty())
        return camera;
    const auto& [low, high] = bounds(positions);
    glm::dvec3 eye(camera.eye);
    const glm::dvec3 ahead = glm::dvec3(camera.target) - eye;
    double distance = glm::dot(0.5 * (glm::dvec3(low) + glm::dvec3(high)) - eye, ahead);
    if (!(distance > 0.0) || !std::isfinite(distance))
        distance = 0.5 * glm::distance(glm::dvec3(low), glm::dvec3(high));
    if (!(distance > 0.0 && std::isfinite(distance)))
        return camera;
    camera.target = glm::vec3(eye + distance * ahead);
    if (of_file.half_height > 0.0) {
        const double far =
            FarInDiagonals *
            std::max(glm::distance(glm::dvec3(low), glm::dvec3(high)), 2.0 * of_file.half_height);
        camera.eye = glm::vec3(eye + (distance - far) * ahead);
        camera.fov_degrees = static_cast<float>(2.0 * std::atan(of_file.half_height / far) * 180.0 /
                                                std::numbers::pi);
    }
    return camera;
}

class GltfReader {
public:
    GltfReader(std::span<const std::byte> bytes, const std::filesystem::path& folder,
               const GltfOptions& options)
        : document_(bytes, folder, options.max_bytes), options_(options),
          primitives_(document_, materials_, options.lightmap_uvs,
                      options.variant ? std::optional(gltf::variant(document_, *options.variant))
                                      : std::nullopt) {}
    PolygonSoup read();

private:
    [[nodiscard]] std::vector<std::uint64_t> root_nodes(bool all = false) const;
    [[nodiscard]] const std::vector<Primitive>& mesh(std::uint64_t index);
    [[nodiscard]] std::vector<glm::dmat4> instances(const Json& node);
    /// Places a vertex by `frame_of(vertex)`.
    template<typename FrameOf>
    void append(const Primitive& primitive, const FrameOf& frame_of, std::uint32_t group);
    void append_skinned(const Primitive& primitive, const gltf::Skin& skin, std::uint32_t group);
    void append_node(std::uint64_t index);
    void add_camera(const Json& camera, const glm::dmat4& world);
    void add_light(const Json& node, const glm::dmat4& world);
    [[nodiscard]] std::vector<std::uint64_t> place(const std::vector<std::uint64_t>& roots);
    [[nodiscard]] std::vector<double> weights(std::uint64_t node) const;
    void finish();
    [[nodiscard]] std::uint32_t group(const Json& node, std::uint64_t mesh);

    gltf::Document document_;
    const GltfOptions& options_;
    gltf::NodePoses moved_;
    /// [nodes] in the scene; empty: not met yet.
    std::vector<std::optional<glm::dmat4>> worlds_;
    /// [nodes] They, or nodes above them, are hidden.
    std::vector<bool> are_hidden_;
    std::optional<gltf::FileCamera> camera_;
    gltf::Materials materials_;
    gltf::PrimitiveReader primitives_;
    std::vector<std::optional<std::vector<Primitive>>> meshes_;
    std::map<std::string, std::uint32_t> group_indices_;
    PolygonSoup soup_;
    gltf::ProfiledLights profiled_lights_{document_, soup_.warnings, soup_.notes};
    bool has_colors_ = false, has_uvs_ = false;
    std::size_t num_odd_weights_ = 0, num_without_joints_ = 0;
};

/// Returns the roots of the default scene, or of the first one. In a file without scenes, nodes
/// without parents are the roots; so they are of `all` scenes.
std::vector<std::uint64_t> GltfReader::root_nodes(bool all) const {
    const auto indices = [](const Json& owner, const char* key) {
        std::vector<std::uint64_t> result;
        for (const Json& item : gltf::items(owner, key))
            result.push_back(gltf::whole_value(item, "nodes"));
        return result;
    };
    if (document_.count("scenes") > 0 && !all)
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

/// Returns the weights of the morph targets of a node's mesh: of the animation, the node, or the
/// mesh. Empty: at rest.
std::vector<double> GltfReader::weights(std::uint64_t index) const {
    const Json& node = document_.element("nodes", index);
    if (const auto moved = moved_.find(index); moved != moved_.end() && moved->second.weights)
        return *moved->second.weights;
    for (const Json* owner : {&node, &document_.element("meshes", gltf::whole(node, "mesh"))})
        if (const std::size_t count = gltf::items(*owner, "weights").size(); count > 0)
            return gltf::numbers(*owner, "weights", std::vector<double>(count, 0.0));
    return {};
}

const std::vector<Primitive>& GltfReader::mesh(std::uint64_t index) {
    const Json& description = document_.element("meshes", index);
    std::optional<std::vector<Primitive>>& mesh = meshes_[index];
    if (!mesh) {
        mesh.emplace();
        for (const Json& item : gltf::items(description, "primitives")) {
            if (std::optional<Primitive> read = primitives_.read(item)) {
                gltf::take_memory(document_, *read, 1);
                if (mesh->empty() || !gltf::joined(mesh->back(), *read))
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
        gltf::Placement placement;
        for (std::size_t j = 0; j < 4; ++j)
            placement.rotation[j] = value(rotations, 4, j, placement.rotation[j]);
        for (std::size_t j = 0; j < 3; ++j) {
            placement.translation[j] = value(translations, 3, j, 0.0);
            placement.scale[j] = value(scales, 3, j, 1.0);
        }
        result.push_back(gltf::matrix_of(placement));
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

template<typename FrameOf>
void GltfReader::append(const Primitive& primitive, const FrameOf& frame_of, std::uint32_t group) {
    const std::size_t first = soup_.positions.size(), count = primitive.positions.size();
    if (first + count > std::numeric_limits<std::uint32_t>::max())
        throw std::runtime_error("expected at most 4294967295 vertices, got more");
    std::size_t num_mirrored = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const gltf::Frame& frame = frame_of(i);
        soup_.add_position(glm::dvec3(frame.matrix * glm::dvec4(primitive.positions[i], 1.0)));
        soup_.normals.emplace_back(primitive.normals.empty()
                                       ? glm::vec3(0.0f)
                                       : glm::vec3(frame.normal(primitive.normals[i])));
        num_mirrored += frame.is_mirrored ? 1 : 0;
    }
    const bool is_mirrored = 2 * num_mirrored > count;
    has_colors_ |= !primitive.colors.empty();
    has_uvs_ |= !primitive.uvs.empty();
    soup_.colors.insert(soup_.colors.end(), primitive.colors.begin(), primitive.colors.end());
    soup_.colors.resize(soup_.positions.size(), glm::vec3(1.0f));
    soup_.uvs.insert(soup_.uvs.end(), primitive.uvs.begin(), primitive.uvs.end());
    soup_.uvs.resize(soup_.positions.size(), glm::vec2(0.0f));
    const auto add = [&](const auto& own, auto& all) {
        if (all.empty() && own.empty())
            return;
        all.resize(first);
        all.insert(all.end(), own.begin(), own.end());
        all.resize(soup_.positions.size());
    };
    add(primitive.second_uvs, soup_.second_uvs);
    std::vector<glm::vec4> tangents;
    for (std::size_t i = 0; i < primitive.tangents.size(); ++i)
        tangents.push_back(frame_of(i).tangent(primitive.tangents[i]));
    add(tangents, soup_.tangents);
    std::uint32_t material = primitive.material;
    auto later = primitive.later_materials.begin();
    for (std::size_t i = 0; i < primitive.triangles.size(); ++i) {
        if (later != primitive.later_materials.end() && later->first_triangle == i)
            material = (later++)->material;
        const auto& [a, b, c] = primitive.triangles[i];
        for (const std::uint32_t corner : {a, is_mirrored ? c : b, is_mirrored ? b : c})
            soup_.corners.push_back(static_cast<std::uint32_t>(first) + corner);
        soup_.end_face();
        soup_.face_smoothing.push_back(primitive.normals.empty() ? 0 : 1);
        soup_.face_materials.push_back(material);
        soup_.face_groups.push_back(group);
    }
}

void GltfReader::append_skinned(const Primitive& primitive, const gltf::Skin& skin,
                                std::uint32_t group) {
    if (primitive.influences.empty()) {
        ++num_without_joints_;
        append(primitive, [](std::size_t) { return gltf::Frame(); }, group);
        return;
    }
    num_odd_weights_ += skin.check(primitive.influences);
    append(
        primitive, [&](std::size_t vertex) { return skin.frame(primitive.influences, vertex); },
        group);
}

/// Appends the mesh of a node, once for each of its instances.
void GltfReader::append_node(std::uint64_t index) {
    const Json& node = document_.element("nodes", index);
    const std::uint64_t of_mesh = gltf::whole(node, "mesh");
    const std::vector<glm::dmat4> places = instances(node);
    const std::vector<double> own_weights = weights(index);
    const auto world = [this](std::uint64_t joint) {
        if (!worlds_[joint]) // outside of the scene
            static_cast<void>(place(root_nodes(true)));
        return worlds_[joint].value_or(glm::dmat4(1.0));
    };
    std::optional<gltf::Skin> skin;
    if (node.find("skin"))
        skin.emplace(document_, gltf::whole(node, "skin"), world);
    for (const Primitive& primitive : mesh(of_mesh))
        gltf::take_memory(document_, primitive, places.size());
    for (const glm::dmat4& at : places)
        for (const Primitive& primitive : mesh(of_mesh)) {
            const std::optional<Primitive> changed =
                gltf::morphed(document_, primitive, own_weights);
            const Primitive& shown = changed ? *changed : primitive;
            if (skin) {
                append_skinned(shown, *skin, group(node, of_mesh));
                continue;
            }
            const gltf::Frame frame(*worlds_[index] * at);
            append(
                shown, [&](std::size_t) -> const gltf::Frame& { return frame; },
                group(node, of_mesh));
        }
}

/// Gives places to the nodes below some roots, and returns them, parents first. Nodes are trees: in
/// a scene, a node that is met twice has two parents or is its own ancestor.
std::vector<std::uint64_t> GltfReader::place(const std::vector<std::uint64_t>& roots) {
    struct Visit {
        std::uint64_t node;
        glm::dmat4 parent;
        bool is_hidden = false;
    };
    const bool is_scene = std::none_of(worlds_.begin(), worlds_.end(),
                                       [](const auto& world) { return world.has_value(); });
    std::vector<std::uint64_t> order;
    std::vector<Visit> to_visit;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
        to_visit.push_back({*root, glm::dmat4(1.0)});
    while (!to_visit.empty()) {
        const Visit visit = to_visit.back();
        to_visit.pop_back();
        const Json& node = document_.element("nodes", visit.node);
        if (worlds_[visit.node] && is_scene)
            throw std::runtime_error(
                fmt::format("expected nodes with one parent, got node {} twice", visit.node));
        if (worlds_[visit.node])
            continue;
        worlds_[visit.node] = visit.parent * gltf::local_transform(node, moved_[visit.node]);
        are_hidden_[visit.node] = is_scene && (visit.is_hidden || gltf::is_hidden(node));
        order.push_back(visit.node);
        const Json::Array& children = gltf::items(node, "children");
        for (std::size_t i = children.size(); i-- > 0;)
            to_visit.push_back({gltf::whole_value(children[i], "children"), *worlds_[visit.node],
                                are_hidden_[visit.node]});
    }
    return order;
}

/// Puts together what was read, and says what was not.
void GltfReader::finish() {
    centre(soup_);
    if (camera_) {
        camera_->camera.eye = glm::vec3(camera_->eye - soup_.offset);
        camera_->camera.target = glm::vec3(camera_->eye - soup_.offset + camera_->ahead);
        soup_.camera = looking_at(soup_.positions, *camera_);
        if (camera_->half_height > 0.0)
            soup_.notes.emplace_back(
                "the camera of the file is orthographic: it looks from afar, so "
                "that sizes hardly depend on the distance");
    }
    if (!has_colors_)
        soup_.colors.clear();
    if (!has_uvs_)
        soup_.uvs.clear();
    soup_.materials = std::move(materials_.materials);
    soup_.textures = std::move(materials_.textures);
    soup_.missing = std::move(materials_.missing);
    soup_.variants = gltf::variants(document_);
    if (const auto hidden = std::count(are_hidden_.begin(), are_hidden_.end(), true); hidden > 0)
        soup_.notes.push_back(
            fmt::format("{} (KHR_node_visibility): neither drawn, nor shadow, nor light",
                        files::counted(static_cast<std::size_t>(hidden), "hidden node")));
    std::vector<std::string> warnings = document_.warnings();
    const auto add = [&](const std::vector<std::string>& more) {
        warnings.insert(warnings.end(), more.begin(), more.end());
    };
    add(materials_.warnings);
    add(gltf::left_out(document_, options_));
    if (const auto unit = gltf::unit_of_lights(document_); unit && !soup_.lights.empty())
        add({*unit});
    if (num_odd_weights_ > 0)
        add({fmt::format("the weights of joints do not sum to 1 at {} vertices: they are scaled",
                         num_odd_weights_)});
    if (num_without_joints_ > 0)
        add({fmt::format("{} of skins have no joints: they are at rest",
                         files::counted(num_without_joints_, "primitive"))});
    soup_.warnings.insert(soup_.warnings.begin(), warnings.begin(), warnings.end());
}

/// The first perspective camera counts. Without any it is the first one.
void GltfReader::add_camera(const Json& camera, const glm::dmat4& world) {
    if (camera_ && camera_->half_height == 0.0)
        return;
    const auto found = gltf::camera_at(camera, world);
    if (found && (!camera_ || found->half_height == 0.0))
        camera_ = found;
}

/// One light never stops an asset.
void GltfReader::add_light(const Json& node, const glm::dmat4& world) {
    const auto add = [&](const auto& read) {
        try {
            if (auto light = read()) {
                soup_.lights.push_back(std::move(*light));
                soup_.light_positions.emplace_back(world[3]);
            }
        } catch (const std::runtime_error& reason) {
            soup_.warnings.push_back(fmt::format("a light is left out: {}", reason.what()));
        }
    };
    add([&] { return gltf::light_at(document_, node, world, soup_.warnings); });
    add([&] { return profiled_lights_.at(node, world); });
}

PolygonSoup GltfReader::read() {
    if (options_.pose)
        moved_ = gltf::read_pose(document_, *options_.pose, soup_.warnings);
    materials_ = gltf::read_materials(document_);
    worlds_.resize(document_.count("nodes"));
    are_hidden_.resize(document_.count("nodes"));
    meshes_.resize(document_.count("meshes"));
    for (const std::uint64_t index : place(root_nodes())) {
        const Json& node = document_.element("nodes", index);
        if (node.find("mesh") && !are_hidden_[index])
            append_node(index);
        if (!are_hidden_[index])
            add_light(node, *worlds_[index]);
        if (node.find("camera"))
            add_camera(document_.element("cameras", gltf::whole(node, "camera")), *worlds_[index]);
    }
    finish();
    return std::move(soup_);
}

} // namespace

PolygonSoup read_gltf(std::span<const std::byte> bytes, const std::filesystem::path& folder,
                      const GltfOptions& options) {
    try {
        return GltfReader(bytes, folder, options).read();
    } catch (const files::JsonError&) {
        throw std::runtime_error("expected glTF's JSON, got a value of another type");
    }
}

} // namespace relumine::mesh
