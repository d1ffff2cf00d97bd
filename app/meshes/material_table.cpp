#include "app/meshes/material_table.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

namespace relumine::app {

namespace {

using Model = mesh::MaterialModel;

const char* name_of(const mesh::Material& material) {
    switch (material.model) {
    case Model::Phong:
        return material.specular == glm::vec3(0.0f) ? "Lambert" : "Blinn-Phong";
    case Model::MetallicRoughness:
        return "metallic-roughness";
    case Model::SpecularGlossiness:
        return "specular-glossiness";
    case Model::Measured:
        return "measured";
    case Model::Unlit:
        break;
    }
    return "unlit";
}

/// The cells of a material, one for each heading.
class Row {
public:
    Row(const mesh::TriangleMesh& mesh, const mesh::Material& material)
        : mesh_(mesh), material_(material) {}

    static constexpr std::array<const char*, 12> Headings = {
        "material", "model",    "colour", "metallic", "roughness", "specular",
        "exponent", "emission", "normal", "ior",      "coat",      "sheen"};
    /// The first three are always shown.
    static constexpr std::size_t NumAlways = 3;

    [[nodiscard]] std::array<std::string, Headings.size()> cells() const {
        const mesh::Material& m = material_;
        const bool is_phong = m.model == Model::Phong, is_unlit = m.model == Model::Unlit;
        const bool is_metal = m.model == Model::MetallicRoughness;
        const mesh::Material usual;
        return {m.name,
                name_of(m),
                of(m.base_color, m.base_color_texture),
                is_metal ? of(m.metallic, m.metallic_texture ? m.metallic_texture
                                                             : m.metallic_roughness_texture)
                         : "",
                is_phong || is_unlit
                    ? ""
                    : of(m.roughness,
                         m.roughness_texture ? m.roughness_texture : m.metallic_roughness_texture),
                specular(),
                is_phong && m.specular != usual.specular ? fmt::format("{}", m.exponent) : "",
                m.emission != usual.emission ? of(m.emission, m.emission_texture) : "",
                m.normal_texture ? of(m.normal_scale, m.normal_texture) : "",
                m.ior != usual.ior ? fmt::format("{}", m.ior) : "",
                m.coat != 0.0f
                    ? fmt::format("{}, roughness {}{}", of(m.coat, m.coat_texture),
                                  of(m.coat_roughness, m.coat_roughness_texture),
                                  m.coat_normal_texture
                                      ? ", normal " + of(m.coat_normal_scale, m.coat_normal_texture)
                                      : "")
                    : "",
                m.sheen != usual.sheen
                    ? fmt::format("{}, roughness {}", of(m.sheen, m.sheen_texture),
                                  of(m.sheen_roughness, m.sheen_roughness_texture))
                    : ""};
    }

private:
    using Slot = std::optional<mesh::TextureSlot>;

    [[nodiscard]] std::string texture(const Slot& slot) const {
        if (!slot)
            return "";
        const mesh::Texture& image = mesh_.textures[slot->texture];
        return fmt::format(" x {} ({} x {})", image.name, image.width, image.height);
    }
    [[nodiscard]] std::string of(float value, const Slot& slot) const {
        return fmt::format("{}{}", value, texture(slot));
    }
    [[nodiscard]] std::string of(const glm::vec3& color, const Slot& slot) const {
        return fmt::format("{} {} {}{}", color.r, color.g, color.b, texture(slot));
    }
    [[nodiscard]] std::string specular() const {
        const mesh::Material& m = material_;
        if (m.model == Model::SpecularGlossiness ||
            (m.model == Model::Phong && m.specular != glm::vec3(0.0f)))
            return of(m.specular, m.specular_texture);
        const bool is_usual = m.specular_strength == 1.0f && !m.specular_strength_texture &&
                              m.specular_tint == glm::vec3(1.0f) && !m.specular_tint_texture;
        if (m.model != Model::MetallicRoughness || is_usual)
            return "";
        return fmt::format("{}, tint {}", of(m.specular_strength, m.specular_strength_texture),
                           of(m.specular_tint, m.specular_tint_texture));
    }

    const mesh::TriangleMesh& mesh_;
    const mesh::Material& material_;
};

} // namespace

std::vector<std::string> material_table(const mesh::TriangleMesh& mesh) {
    using Cells = std::array<std::string, Row::Headings.size()>;
    if (mesh.materials.empty())
        return {};
    std::vector<Cells> rows(1);
    std::copy(Row::Headings.begin(), Row::Headings.end(), rows[0].begin());
    for (const mesh::Material& material : mesh.materials)
        rows.push_back(Row(mesh, material).cells());
    std::vector<std::string> lines(rows.size());
    for (std::size_t column = 0; column < Row::Headings.size(); ++column) {
        std::size_t width = 0;
        for (std::size_t row = 1; row < rows.size(); ++row)
            width = std::max(width, rows[row][column].size());
        if (width == 0 && column >= Row::NumAlways)
            continue;
        width = std::max(width, rows[0][column].size());
        for (std::size_t row = 0; row < rows.size(); ++row)
            lines[row] += fmt::format("{:<{}}  ", rows[row][column], width);
    }
    for (std::string& line : lines)
        line.erase(line.find_last_not_of(' ') + 1);
    return lines;
}

} // namespace relumine::app
