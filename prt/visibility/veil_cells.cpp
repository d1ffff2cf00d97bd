#include "prt/visibility/veil_cells.h"

#include <algorithm>
#include <optional>

#include "files/parallel.h"

namespace relumine::prt {

namespace {

/// The textures that a veil is looked up in.
std::vector<mesh::TextureSlot> slots_of(const mesh::Material& material) {
    std::vector<mesh::TextureSlot> slots;
    const auto add = [&](const std::optional<mesh::TextureSlot>& slot) {
        if (slot)
            slots.push_back(*slot);
    };
    if (material.alpha_mode != mesh::AlphaMode::Opaque)
        add(material.alpha_texture);
    if (material.transmission > 0.0f) {
        add(material.transmission_texture);
        add(material.base_color_texture);
        add(material.metallic_roughness_texture);
    }
    return slots;
}

} // namespace

bool VeilCells::are_for(const mesh::Material& material) {
    if (!mesh::is_thin(material))
        return false;
    const std::vector<mesh::TextureSlot> slots = slots_of(material);
    return !slots.empty() && std::all_of(slots.begin(), slots.end(), [&](const auto& slot) {
        return slot.uv_set == slots[0].uv_set && slot.wrap == slots[0].wrap &&
               slot.uv_from_mesh_uv == slots[0].uv_from_mesh_uv &&
               slot.uv_offset == slots[0].uv_offset;
    });
}

VeilCells::VeilCells(const mesh::Material& material, std::span<const mesh::Texture> textures)
    : slot_(slots_of(material).front()) {
    constexpr std::uint32_t MostCells = 512;
    for (const mesh::TextureSlot& slot : slots_of(material)) {
        size_[0] = std::max(size_[0], textures[slot.texture].width);
        size_[1] = std::max(size_[1], textures[slot.texture].height);
    }
    for (std::uint32_t& size : size_)
        size = std::min(size, MostCells);
    parts_.resize(std::size_t{size_[0]} * size_[1]);
    files::parallel_for(std::uint32_t{0}, size_[1], [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < size_[0]; ++x) {
            const glm::vec2 place = (glm::vec2(x, y) + 0.5f) / glm::vec2(size_[0], size_[1]);
            parts_[std::size_t{y} * size_[0] + x] = part_of(mesh::veil(material, textures, place));
        }
    });
}

} // namespace relumine::prt
