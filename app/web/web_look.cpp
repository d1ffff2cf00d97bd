#include "app/web/web_look.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "files/gzip.h"
#include "relumine/ask/questions.h"
#include "relumine/in/material.h"
#include "relumine/in/mesh_files.h"
#include "relumine/light/live_eye.h"
#include "relumine/out/receiver_colors.h"

namespace relumine::app {

namespace {

constexpr std::uint32_t NoMaterial = ~0u;

/// Triangles that are drawn together: a material with a texture or a highlight, all others, the
/// floor.
struct GroupKey {
    bool is_floor = false;
    std::uint32_t material = NoMaterial;
    /// The other side of each has a triangle of its own, so only fronts are drawn.
    bool is_one_side = false;

    // NOLINTNEXTLINE(modernize-use-nullptr): clang-tidy 14 sees one in the comparison with 0
    [[nodiscard]] auto operator<=>(const GroupKey&) const = default;
    /// Returns what a vertex looks like: no matter from which side.
    [[nodiscard]] std::pair<bool, std::uint32_t> look() const { return {is_floor, material}; }
};

/// The textures that the page draws a material with, its highlight's where it has one. They have
/// the UV map of the first.
struct PageTextures {
    using Slot = std::optional<mesh::TextureSlot> mesh::Material::*;
    static constexpr std::array OfColor = {&mesh::Material::base_color_texture};
    static constexpr std::array OfHighlight = {
        &mesh::Material::base_color_texture, &mesh::Material::metallic_roughness_texture,
        &mesh::Material::roughness_texture,  &mesh::Material::metallic_texture,
        &mesh::Material::specular_texture,   &mesh::Material::normal_texture,
        &mesh::Material::emission_texture};

    PageTextures(const mesh::TriangleMesh& of, std::uint32_t index, bool with_highlight)
        : mesh(of), material(of.materials[index]),
          slots(with_highlight ? std::span<const Slot>(OfHighlight)
                               : std::span<const Slot>(OfColor)) {}

    [[nodiscard]] bool is_readable(Slot slot) const {
        const auto& texture = material.*slot;
        return texture && !mesh.textures[texture->texture].file.empty();
    }
    [[nodiscard]] std::optional<std::uint32_t> uv_set() const {
        for (const Slot slot : slots)
            if (is_readable(slot))
                return (material.*slot)->uv_set;
        return {};
    }
    /// Returns what the page draws with; null: nothing.
    [[nodiscard]] const mesh::TextureSlot* drawn(Slot slot) const {
        return is_readable(slot) && (material.*slot)->uv_set == uv_set() ? &*(material.*slot)
                                                                         : nullptr;
    }

    const mesh::TriangleMesh& mesh;
    const mesh::Material& material;
    std::span<const Slot> slots;
};

/// Whether the page shows a material's highlight.
bool shines(const mesh::Material& material) {
    return material.model == mesh::MaterialModel::MetallicRoughness ||
           material.model == mesh::MaterialModel::SpecularGlossiness;
}

/// What a surface sends back, whichever way.
glm::vec3 whole_albedo(const mesh::Material& material) {
    if (material.model == mesh::MaterialModel::MetallicRoughness)
        return material.base_color;
    return glm::min(material.base_color + material.specular, glm::vec3(1.0f));
}

/// Returns F0 of the part of a material that is not metal.
glm::vec3 dielectric_f0(const mesh::Material& material) {
    if (material.model == mesh::MaterialModel::SpecularGlossiness)
        return material.specular;
    return prt::dielectric_f0(material.ior, material.specular_strength, material.specular_tint);
}

std::vector<bool> twins_of(const mesh::TriangleMesh& mesh) {
    const prt::TwinTriangles twins(mesh);
    std::vector<bool> result(mesh.num_triangles());
    for (std::uint32_t i = 0; i < result.size(); ++i) {
        const glm::vec3 normal = prt::face_normal(mesh, i);
        result[i] =
            normal != glm::vec3(0.0f) && twins.facing({.triangle = i}, normal).triangle != i;
    }
    return result;
}

class LookMaker {
public:
    explicit LookMaker(const Scene& scene)
        : mesh_(scene.mesh), first_floor_(first_floor_vertex(scene)),
          has_highlights_(has_live_highlights(scene)), has_twin_(twins_of(scene.mesh)),
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
            return {.is_floor = true};
        GroupKey key{.is_one_side = has_twin_[triangle]};
        if (mesh_.triangle_materials.empty())
            return key;
        const std::uint32_t material = mesh_.triangle_materials[triangle];
        if (is_drawn_by_itself(material))
            key.material = material;
        return key;
    }

    [[nodiscard]] bool has_highlight(std::uint32_t material) const {
        return has_highlights_ && shines(mesh_.materials[material]);
    }
    [[nodiscard]] PageTextures textures_of(std::uint32_t material) const {
        return {mesh_, material, has_highlight(material)};
    }
    /// Whether the page needs a material for more than the colours of its vertices.
    [[nodiscard]] bool is_drawn_by_itself(std::uint32_t material) const {
        return has_highlight(material) || textures_of(material).uv_set();
    }

    /// Whether a vertex is drawn in several ways: with the places of textures, or by materials that
    /// meet there.
    [[nodiscard]] bool must_split() const {
        std::vector<std::optional<std::pair<bool, std::uint32_t>>> of_vertices(
            mesh_.num_vertices());
        for (std::size_t triangle = 0; triangle < mesh_.num_triangles(); ++triangle) {
            const GroupKey key = key_of(triangle);
            if (key.material != NoMaterial && textures_of(key.material).uv_set())
                return true;
            for (const std::uint32_t vertex : mesh_.triangles[triangle])
                if (of_vertices[vertex].value_or(key.look()) != key.look())
                    return true;
                else
                    of_vertices[vertex] = key.look();
        }
        return false;
    }

    /// Returns what a vertex's light is multiplied with, but for textures.
    [[nodiscard]] glm::vec3 tint(const GroupKey& key, std::uint32_t vertex) const {
        if (key.material == NoMaterial)
            return albedo_[vertex];
        const mesh::Material& material = mesh_.materials[key.material];
        const glm::vec3 own =
            has_highlight(key.material) ? material.base_color : whole_albedo(material);
        return material.times_vertex_color && !mesh_.colors.empty() ? own * mesh_.colors[vertex]
                                                                    : own;
    }

    /// Puts triangles of a group together, and splits vertices at the seams of textures.
    void add_triangles() {
        std::vector<std::uint32_t> order(mesh_.num_triangles());
        std::iota(order.begin(), order.end(), 0u);
        std::stable_sort(order.begin(), order.end(), [this](std::uint32_t a, std::uint32_t b) {
            return key_of(a) < key_of(b);
        });
        is_reordered_ = !std::is_sorted(order.begin(), order.end());
        is_split_ = must_split();
        if (!is_split_)
            drawn_albedo_.assign(albedo_.begin(), albedo_.begin() + static_cast<std::ptrdiff_t>(
                                                                        mesh_.num_vertices()));
        for (const std::uint32_t triangle : order) {
            const GroupKey key = key_of(triangle);
            auto& range = groups_.try_emplace(key, triangles_.size(), 0).first->second;
            range.second += 3;
            for (std::size_t corner = 0; corner < 3; ++corner)
                triangles_.push_back(is_split_
                                         ? drawn_vertex(key, triangle, corner)
                                         : whole_vertex(key, mesh_.triangles[triangle][corner]));
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
        if (key.material != NoMaterial)
            if (const auto set = textures_of(key.material).uv_set())
                uv = uv_of(triangle, corner, *set);
        const auto [entry, is_new] =
            drawn_.try_emplace(std::tuple(key.look(), vertex, std::bit_cast<std::uint32_t>(uv.x),
                                          std::bit_cast<std::uint32_t>(uv.y)),
                               static_cast<std::uint32_t>(receivers_.size()));
        if (is_new) {
            receivers_.push_back(vertex);
            uvs_.push_back(uv);
            drawn_albedo_.push_back(tint(key, vertex));
        }
        return entry->second;
    }

    std::uint32_t whole_vertex(const GroupKey& key, std::uint32_t vertex) {
        drawn_albedo_[vertex] = tint(key, vertex);
        return vertex;
    }

    [[nodiscard]] files::Json material(const GroupKey& key) {
        files::Json result = {{"isFloor", key.is_floor}};
        if (key.is_one_side)
            result.set("isOneSide", true);
        if (key.material == NoMaterial)
            return result;
        const PageTextures textures = textures_of(key.material);
        if (const auto* slot = textures.drawn(&mesh::Material::base_color_texture))
            result.set("map", map(*slot));
        if (has_highlight(key.material))
            result.set("highlight", highlight(textures));
        return result;
    }

    /// What the page draws a highlight with: factors, and maps that multiply them.
    [[nodiscard]] files::Json highlight(const PageTextures& textures) {
        const mesh::Material& material = textures.material;
        const bool is_metallic = material.model == mesh::MaterialModel::MetallicRoughness;
        files::Json result = {{"roughness", material.roughness},
                              {"metallic", is_metallic ? material.metallic : 0.0f},
                              {"f0", dielectric_f0(material)},
                              {"f90", is_metallic ? material.specular_strength : 1.0f}};
        const auto add = [&](const char* name, PageTextures::Slot of, int channel) {
            const mesh::TextureSlot* const slot = textures.drawn(of);
            if (slot == nullptr)
                return;
            files::Json own = map(*slot);
            own.set("channel", channel);
            result.set(name, own);
        };
        add("roughnessMap", &mesh::Material::roughness_texture, 0);
        add("roughnessMap", &mesh::Material::metallic_roughness_texture, 1);
        if (is_metallic) {
            add("metallicMap", &mesh::Material::metallic_texture, 0);
            add("metallicMap", &mesh::Material::metallic_roughness_texture, 2);
        } else {
            add("f0Map", &mesh::Material::specular_texture, 0);
        }
        add("glowMap", &mesh::Material::emission_texture, 0);
        if (textures.drawn(&mesh::Material::normal_texture) != nullptr) {
            add("normalMap", &mesh::Material::normal_texture, 0);
            result.set("normalScale", material.normal_scale);
        }
        return result;
    }

    /// A texture, whose image becomes a file of the page.
    [[nodiscard]] files::Json map(const mesh::TextureSlot& slot) {
        const mesh::Texture& texture = mesh_.textures[slot.texture];
        const std::string name = fmt::format("textures/{}", slot.texture);
        if (std::none_of(look_.files.begin(), look_.files.end(),
                         [&](const WebFile& file) { return file.name == name; }))
            look_.files.push_back({name, texture.file});
        const glm::mat2& m = slot.uv_from_mesh_uv;
        files::Json result = {{"image", name},
                              {"fromTop", texture.origin == mesh::VOrigin::Top},
                              {"srgb", slot.is_srgb}};
        result.set("wrap", files::Json::Array{static_cast<int>(slot.wrap[0]),
                                              static_cast<int>(slot.wrap[1])});
        result.set("uv", files::Json::Array{m[0][0], m[0][1], 0.0, m[1][0], m[1][1], 0.0,
                                            slot.uv_offset.x, slot.uv_offset.y, 1.0});
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

    const mesh::TriangleMesh& mesh_;
    std::optional<std::size_t> first_floor_;
    bool has_highlights_;
    /// [num_triangles] whether there is one for the other side, too
    std::vector<bool> has_twin_;
    std::vector<glm::vec3> albedo_;
    bool is_split_ = false, is_reordered_ = false;
    /// First index and number of indices
    std::map<GroupKey, std::pair<std::size_t, std::size_t>> groups_;
    std::map<
        std::tuple<std::pair<bool, std::uint32_t>, std::uint32_t, std::uint32_t, std::uint32_t>,
        std::uint32_t>
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

Scene with_page_glow(Scene scene) {
    for (std::uint32_t i = 0; i < scene.mesh.materials.size(); ++i) {
        mesh::Material& material = scene.mesh.materials[i];
        const PageTextures textures(scene.mesh, i, shines(material));
        if (shines(material) && textures.drawn(&mesh::Material::emission_texture) != nullptr)
            material.emission_texture.reset();
    }
    const std::vector<prt::Surface> surfaces = prt::vertex_surfaces(scene.mesh);
    for (std::size_t i = 0; i < std::min(surfaces.size(), scene.receivers.surfaces.size()); ++i)
        scene.receivers.surfaces[i].emission = surfaces[i].emission;
    return scene;
}

std::vector<std::string> left_out_of_highlights(const Scene& scene) {
    std::vector<std::string> left;
    if (!has_live_highlights(scene))
        return left;
    const std::vector<mesh::Material>& materials = scene.mesh.materials;
    const auto add_if = [&](const char* what, const auto& is) {
        if (std::any_of(materials.begin(), materials.end(), is))
            left.emplace_back(what);
    };
    add_if("highlights of Blinn-Phong and of tables: such surfaces are matte",
           [](const mesh::Material& material) {
               return prt::has_highlight(material) && !shines(material);
           });
    add_if("clear coats, sheen, thin films and anisotropy", [](const mesh::Material& material) {
        return material.coat > 0.0f || material.sheen != glm::vec3(0.0f) || material.film > 0.0f ||
               material.anisotropy > 0.0f;
    });
    add_if("textures of what glass mirrors", [](const mesh::Material& material) {
        return material.specular_strength_texture || material.specular_tint_texture;
    });
    if (!scene.lamps.empty())
        left.emplace_back("what surfaces mirror of the scene's lamps");
    bool has_other_uvs = false;
    for (std::uint32_t i = 0; i < materials.size(); ++i) {
        const PageTextures textures(scene.mesh, i, shines(materials[i]));
        for (const PageTextures::Slot slot : textures.slots)
            has_other_uvs |= textures.is_readable(slot) && textures.drawn(slot) == nullptr;
    }
    if (has_other_uvs)
        left.emplace_back("textures of a material's second UV map");
    return left;
}

} // namespace relumine::app
