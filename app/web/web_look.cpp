#include "app/web/web_look.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "files/gzip.h"
#include "relumine/receiver_colors.h"

namespace relumine::app {

namespace {

constexpr std::uint32_t NoMaterial = ~0u;

/// Triangles that are drawn together: a material with a texture or emission, all others, the floor.
using GroupKey = std::pair<bool, std::uint32_t>;

/// Whether the page needs a material for more than the colours of its vertices.
bool is_drawn_by_itself(const mesh::TriangleMesh& mesh, std::uint32_t material) {
    const mesh::Material& of = mesh.materials[material];
    return of.base_color_texture && !mesh.textures[of.base_color_texture->texture].file.empty();
}

/// What a surface sends back, whichever way.
glm::vec3 whole_albedo(const mesh::Material& material) {
    if (material.model == mesh::MaterialModel::MetallicRoughness)
        return material.base_color;
    return glm::min(material.base_color + material.specular, glm::vec3(1.0f));
}

class LookMaker {
public:
    explicit LookMaker(const Scene& scene)
        : scene_(scene), mesh_(scene.mesh), first_floor_(first_floor_vertex(scene)),
          albedo_(web_albedo(scene)) {}

    [[nodiscard]] WebLook make() {
        add_triangles();
        std::vector<files::Json> of_groups;
        for (const auto& [key, range] : groups_)
            of_groups.push_back(material(key));
        std::vector<files::Json> ranges;
        for (const auto& [key, range] : groups_)
            ranges.push_back(
                {{"start", range.first}, {"count", range.second}, {"material", ranges.size()}});
        files::Json arrays;
        if (is_split_) {
            add_array(arrays, "receivers", std::as_bytes(std::span(receivers_)));
            add_array(arrays, "uvs", std::as_bytes(std::span(uvs_)));
        }
        if (is_split_ || is_reordered_)
            add_array(arrays, "triangles", std::as_bytes(std::span(triangles_)));
        add_array(arrays, "albedo", std::as_bytes(std::span(drawn_albedo_)));
        look_.files.push_back({"look.bin.gz", files::gzipped(bytes_)});
        look_.look = {{"file", "look.bin.gz"}};
        look_.look.set("arrays", arrays);
        look_.look.set("materials", files::Json::Array(of_groups.begin(), of_groups.end()));
        look_.look.set("groups", files::Json::Array(ranges.begin(), ranges.end()));
        look_.floor = floor();
        return std::move(look_);
    }

private:
    void add_array(files::Json& arrays, const char* name, std::span<const std::byte> bytes) {
        arrays.set(name, files::Json({{"offset", bytes_.size()}, {"bytes", bytes.size()}}));
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    }

    [[nodiscard]] GroupKey key_of(std::size_t triangle) const {
        if (first_floor_ && mesh_.triangles[triangle][0] >= *first_floor_)
            return {true, NoMaterial};
        if (mesh_.triangle_materials.empty())
            return {false, NoMaterial};
        const std::uint32_t material = mesh_.triangle_materials[triangle];
        return {false, is_drawn_by_itself(mesh_, material) ? material : NoMaterial};
    }

    /// Puts triangles of a group together, and splits vertices at the seams of textures.
    void add_triangles() {
        std::vector<std::uint32_t> order(mesh_.num_triangles());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
            return key_of(a) < key_of(b);
        });
        is_reordered_ = !std::is_sorted(order.begin(), order.end());
        is_split_ = std::any_of(order.begin(), order.end(), [this](std::uint32_t triangle) {
            return key_of(triangle).second != NoMaterial;
        });
        if (!is_split_)
            drawn_albedo_.assign(albedo_.begin(), albedo_.begin() + static_cast<std::ptrdiff_t>(
                                                                        mesh_.num_vertices()));
        for (const std::uint32_t triangle : order) {
            const GroupKey key = key_of(triangle);
            auto& range = groups_.try_emplace(key, triangles_.size(), 0).first->second;
            range.second += 3;
            for (std::size_t corner = 0; corner < 3; ++corner)
                triangles_.push_back(is_split_ ? drawn_vertex(key, triangle, corner)
                                               : mesh_.triangles[triangle][corner]);
        }
    }

    [[nodiscard]] glm::vec2 uv_of(std::uint32_t triangle, std::size_t corner,
                                  std::uint32_t set) const {
        const std::uint32_t vertex = mesh_.triangles[triangle][corner];
        if (set == 1)
            return mesh_.second_uvs.empty() ? glm::vec2(0.0f) : mesh_.second_uvs[vertex];
        if (!mesh_.corner_uvs.empty())
            return mesh_.corner_uvs[triangle][corner];
        return mesh_.uvs.empty() ? glm::vec2(0.0f) : mesh_.uvs[vertex];
    }

    std::uint32_t drawn_vertex(const GroupKey& key, std::uint32_t triangle, std::size_t corner) {
        const std::uint32_t vertex = mesh_.triangles[triangle][corner];
        glm::vec2 uv(0.0f);
        glm::vec3 albedo = albedo_[vertex];
        if (key.second != NoMaterial) {
            const mesh::Material& material = mesh_.materials[key.second];
            uv = uv_of(triangle, corner, material.base_color_texture->uv_set);
            albedo = whole_albedo(material);
            if (material.times_vertex_color && !mesh_.colors.empty())
                albedo *= mesh_.colors[vertex];
        }
        const auto [entry, is_new] =
            drawn_.try_emplace(std::tuple(key, vertex, std::bit_cast<std::uint32_t>(uv.x),
                                          std::bit_cast<std::uint32_t>(uv.y)),
                               static_cast<std::uint32_t>(receivers_.size()));
        if (is_new) {
            receivers_.push_back(vertex);
            uvs_.push_back(uv);
            drawn_albedo_.push_back(albedo);
        }
        return entry->second;
    }

    [[nodiscard]] files::Json material(const GroupKey& key) {
        files::Json result = {{"isFloor", key.first}};
        if (key.second == NoMaterial)
            return result;
        const mesh::TextureSlot& slot = *mesh_.materials[key.second].base_color_texture;
        const mesh::Texture& texture = mesh_.textures[slot.texture];
        const std::string name = fmt::format("textures/{}", slot.texture);
        if (std::none_of(look_.files.begin(), look_.files.end(),
                         [&](const WebFile& file) { return file.name == name; }))
            look_.files.push_back({name, texture.file});
        const glm::mat2& m = slot.uv_from_mesh_uv;
        files::Json map = {{"image", name},
                           {"fromTop", texture.origin == mesh::VOrigin::Top},
                           {"srgb", slot.is_srgb}};
        map.set("wrap",
                files::Json::Array{static_cast<int>(slot.wrap[0]), static_cast<int>(slot.wrap[1])});
        map.set("uv", files::Json::Array{m[0][0], m[0][1], 0.0, m[1][0], m[1][1], 0.0,
                                         slot.uv_offset.x, slot.uv_offset.y, 1.0});
        result.set("map", map);
        return result;
    }

    [[nodiscard]] files::Json floor() const {
        if (!first_floor_)
            return {};
        const std::span<const glm::vec3> points = std::span(mesh_.positions).subspan(*first_floor_);
        const mesh::Bounds bounds = mesh::bounds(points);
        return {{"center", bounds.center()},
                {"radius", 0.5f * std::min(bounds.size().x, bounds.size().z)}};
    }

    const Scene& scene_;
    const mesh::TriangleMesh& mesh_;
    std::optional<std::size_t> first_floor_;
    std::vector<glm::vec3> albedo_;
    bool is_split_ = false, is_reordered_ = false;
    /// First index and number of indices
    std::map<GroupKey, std::pair<std::size_t, std::size_t>> groups_;
    std::map<std::tuple<GroupKey, std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t>
        drawn_;
    std::vector<std::uint32_t> receivers_, triangles_;
    std::vector<glm::vec2> uvs_;
    std::vector<glm::vec3> drawn_albedo_;
    std::vector<std::byte> bytes_;
    WebLook look_;
};

} // namespace

std::vector<glm::vec3> web_albedo(const Scene& scene) {
    constexpr float Least = 0.01f;
    std::vector<glm::vec3> albedo = picture_albedo(scene);
    for (std::size_t i = 0; i < albedo.size(); ++i) {
        if (i < scene.receivers.surfaces.size()) {
            const prt::Surface& surface = scene.receivers.surfaces[i];
            // Without a view, what they mirror is in the albedo already.
            const bool is_apart = surface.highlight != prt::Highlight::None;
            albedo[i] =
                albedo[i] * surface.albedo + (is_apart ? surface.specular : glm::vec3(0.0f));
        }
        albedo[i] = glm::clamp(albedo[i], Least, 1.0f);
    }
    return albedo;
}

WebLook web_look(const Scene& scene) {
    return LookMaker(scene).make();
}

} // namespace relumine::app
