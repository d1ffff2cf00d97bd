#include "prt/visibility/see_through.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>

#include <glm/common.hpp>

#include "cubemap/face.h"
#include "cubemap/r2_sequence.h"
#include "cubemap/split_mix64.h"
#include "files/parallel.h"
#include "mesh/tangents.h"
#include "prt/visibility/half_line.h"

namespace relumine::prt {

namespace {

/// Returns a number in [0, 1) for a ray and a triangle.
///
/// Over the directions from one place it is an additive recurrence: M. Roberts' R2 sequence on the
/// lattice of a cube face of 2048 cells. Steps of any number of cells spread evenly, so a few
/// neighbouring rays pass by nearly the right part. Places start anywhere, and triangles have
/// lattices of their own, so that light behind two surfaces has the product of both parts.
double chance(const SeeThrough::Meeting& meeting) {
    constexpr double Cells = 2048.0;
    std::uint64_t seed = meeting.triangle;
    const std::uint64_t of_triangle = cubemap::SplitMix64(seed).next();
    for (int axis = 0; axis < 3; ++axis)
        seed =
            cubemap::SplitMix64(seed ^ std::bit_cast<std::uint32_t>(meeting.origin[axis])).next();
    const cubemap::FacePoint at = cubemap::face_point(glm::dvec3(meeting.direction));
    const double x = Cells * at.s * static_cast<double>(1 + of_triangle % 16);
    const double y = Cells * at.t * static_cast<double>(1 + of_triangle / 16 % 16);
    const double place = cubemap::unit_interval(seed) + cubemap::R2StepS * x + cubemap::R2StepT * y;
    return place - std::floor(place);
}

/// The least and the largest value of the texels of a texture that a triangle may touch.
struct TexelRange {
    glm::vec3 least{std::numeric_limits<float>::infinity()}, most{-least};
    [[nodiscard]] bool is_even() const { return least == most; }
};

/// Returns nothing where the triangle covers too many texels for the search to be worth it, and
/// what was found so far once is_enough(range) says so.
template<typename IsEnough>
std::optional<TexelRange> texels_under(const mesh::TriangleMesh& mesh, std::uint32_t triangle,
                                       const mesh::TextureSlot& slot, const IsEnough& is_enough) {
    constexpr float MostTexels = 4096.0f;
    const mesh::Texture& texture = mesh.textures[slot.texture];
    const glm::vec2 size(texture.width, texture.height);
    glm::vec2 first(std::numeric_limits<float>::infinity()), last = -first;
    for (const glm::vec2& corner :
         {glm::vec2(0.0f, 0.0f), glm::vec2(1.0f, 0.0f), glm::vec2(0.0f, 1.0f)}) {
        const glm::vec2 uv =
            slot.uv_from_mesh_uv * mesh::uv_at(mesh, triangle, corner, slot.uv_set) +
            slot.uv_offset;
        first = glm::min(first, uv * size);
        last = glm::max(last, uv * size);
    }
    // The texels of bilinear values, and one more for roundings
    first = glm::floor(first) - 1.0f;
    last = glm::floor(last) + 2.0f;
    const glm::vec2 count = last - first;
    if (!(count.x * count.y <= MostTexels))
        return std::nullopt;
    TexelRange range;
    for (int row_index = 0; row_index < static_cast<int>(count.y); ++row_index) {
        for (int column_index = 0; column_index < static_cast<int>(count.x); ++column_index) {
            const float x = first.x + static_cast<float>(column_index);
            const float y = first.y + static_cast<float>(row_index);
            const auto column =
                mesh::texels_beside((x + 0.5f) / size.x, texture.width, slot.wrap[0]);
            const auto row = mesh::texels_beside((y + 0.5f) / size.y, texture.height, slot.wrap[1]);
            const auto add = [&](std::uint32_t i, std::uint32_t j) {
                const glm::vec3 value = mesh::texel(texture, i, j, slot.is_srgb);
                range.least = glm::min(range.least, value);
                range.most = glm::max(range.most, value);
            };
            add(column.first, row.first);
            add(column.second, row.second);
        }
        if (is_enough(range))
            break;
    }
    return range;
}

/// Returns the part of light that passes a triangle where it is the same all over it.
std::optional<float> even_part(const mesh::TriangleMesh& mesh, std::uint32_t triangle) {
    const mesh::Material& material = mesh.materials[mesh.triangle_materials[triangle]];
    const bool is_mask = material.alpha_mode == mesh::AlphaMode::Mask;
    if (is_mask && material.alpha_texture) {
        constexpr float Rounding = 1e-5f; // of the bilinear mean
        const auto all_cut = [&](const TexelRange& alpha) {
            return material.alpha * alpha.most.r < material.alpha_cutoff - Rounding;
        };
        const auto some_cut = [&](const TexelRange& alpha) {
            return material.alpha * alpha.least.r < material.alpha_cutoff + Rounding;
        };
        const auto alpha =
            texels_under(mesh, triangle, *material.alpha_texture, [&](const TexelRange& range) {
                return some_cut(range) && !all_cut(range);
            });
        if (!alpha)
            return std::nullopt;
        if (all_cut(*alpha))
            return 1.0f;
        if (some_cut(*alpha))
            return std::nullopt;
        if (material.transmission == 0.0f)
            return 0.0f;
    }
    const auto is_even = [&](const std::optional<mesh::TextureSlot>& slot) {
        if (!slot)
            return true;
        const auto range = texels_under(mesh, triangle, *slot,
                                        [](const TexelRange& found) { return !found.is_even(); });
        return range && range->is_even();
    };
    if (!is_mask && material.alpha_mode != mesh::AlphaMode::Opaque &&
        !is_even(material.alpha_texture))
        return std::nullopt;
    if (material.transmission > 0.0f &&
        !(is_even(material.transmission_texture) && is_even(material.metallic_roughness_texture) &&
          is_even(material.base_color_texture)))
        return std::nullopt;
    return part_of(mesh::veil(mesh, triangle, glm::vec2(1.0f / 3.0f)));
}

/// Returns the mean of a value over a triangle, from the middles of its 64 even parts.
template<typename Value>
float mean_over_triangle(const Value& value) {
    constexpr int Steps = 8;
    float sum = 0.0f;
    for (int i = 0; i < Steps; ++i)
        for (int j = 0; j < 2 * (Steps - i) - 1; ++j) {
            // Parts of a row stand upright and upside down in turn.
            const float third = j % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
            const int column = j / 2;
            sum +=
                value(glm::vec2(static_cast<float>(column) + third, static_cast<float>(i) + third) /
                      static_cast<float>(Steps));
        }
    return sum / (Steps * Steps);
}

} // namespace

SeeThrough::SeeThrough(const mesh::TriangleMesh& mesh) {
    if (mesh.triangle_materials.empty() ||
        std::none_of(mesh.materials.begin(), mesh.materials.end(), mesh::lets_eye_pass))
        return;
    for (const std::uint32_t i : mesh.triangle_materials) {
        const mesh::Material& material = mesh.materials[i];
        has_thin_ = has_thin_ || mesh::is_thin(material);
        kinds_.push_back(static_cast<std::uint8_t>((material.is_double_sided ? 0 : OneSided) |
                                                   (lets_light_pass(material) ? PassesLight : 0) |
                                                   (mesh::is_thin(material) ? Thin : 0)));
    }
    if (!mesh::lets_light_pass(mesh))
        return;
    mesh_ = mesh::blockers_of(mesh);
    mesh_.positions = {};
    even_.assign(mesh.num_triangles(), -1.0f);
    const auto num_triangles = static_cast<std::uint32_t>(mesh.num_triangles());
    files::parallel_for(std::uint32_t{0}, num_triangles, [&](std::uint32_t triangle) {
        if ((kinds_[triangle] & PassesLight) == 0)
            return;
        even_[triangle] = even_part(mesh_, triangle).value_or(-1.0f);
        if (even_[triangle] == 0.0f)
            kinds_[triangle] &= static_cast<std::uint8_t>(~(PassesLight | Thin));
    });
    find_masks();
    find_veils();
}

void SeeThrough::find_masks() {
    std::vector<std::uint32_t> mask_of_material;
    for (const mesh::Material& material : mesh_.materials) {
        std::uint32_t& mask = mask_of_material.emplace_back(NotMapped);
        if (material.alpha_mode != mesh::AlphaMode::Mask || !material.alpha_texture ||
            material.transmission > 0.0f)
            continue;
        const auto known = std::find_if(masks_.begin(), masks_.end(), [&](const MaskCells& cells) {
            return cells.are_of(material);
        });
        mask = static_cast<std::uint32_t>(known - masks_.begin());
        if (known == masks_.end())
            masks_.emplace_back(material, mesh_.textures[material.alpha_texture->texture]);
    }
    if (!masks_.empty())
        find_mapped_triangles(mask_of_material, false);
}

void SeeThrough::find_veils() {
    std::vector<std::uint32_t> of_material(mesh_.materials.size(), NotMapped);
    for (std::size_t i = 0; i < of_material.size(); ++i)
        if (VeilCells::are_for(mesh_.materials[i])) {
            of_material[i] = static_cast<std::uint32_t>(veils_.size());
            veils_.emplace_back(mesh_.materials[i], mesh_.textures);
        }
    if (!veils_.empty())
        find_mapped_triangles(of_material, true);
}

void SeeThrough::find_mapped_triangles(const std::vector<std::uint32_t>& of_material,
                                       bool are_veils) {
    mapped_of_.resize(kinds_.size(), NotMapped);
    for (std::uint32_t triangle = 0; triangle < mapped_of_.size(); ++triangle) {
        const std::uint32_t material = mesh_.triangle_materials[triangle];
        const std::uint32_t cells = of_material[material];
        if (cells == NotMapped || even_[triangle] >= 0.0f)
            continue;
        mapped_of_[triangle] = static_cast<std::uint32_t>(mapped_.size());
        Mapped& mapped =
            mapped_.emplace_back(Mapped{.cells = cells, .is_veil = are_veils, .mean = {}});
        const mesh::TextureSlot& slot =
            are_veils ? veils_[cells].slot() : *mesh_.materials[material].alpha_texture;
        for (std::size_t k = 0; k < 3; ++k)
            mapped.uvs[k] =
                slot.uv_from_mesh_uv * mesh::corner_uv(mesh_, triangle, k, slot.uv_set) +
                slot.uv_offset;
        if (are_veils && mesh_.materials[material].alpha_mode == mesh::AlphaMode::Opaque)
            mapped.mean = mean_over_triangle(
                [&](const glm::vec2& at) { return veils_[cells].at(mapped.place(at)); });
    }
}

MaskCells::Cell SeeThrough::cell_at(std::uint32_t triangle, const glm::vec2& barycentric) const {
    if (mapped_of_.empty() || mapped_of_[triangle] == NotMapped)
        return MaskCells::Cell::Mixed;
    // Up to a rounding, as veil() finds it: at the border of two cells, either is right.
    const Mapped& mapped = mapped_[mapped_of_[triangle]];
    return mapped.is_veil ? MaskCells::Cell::Mixed
                          : masks_[mapped.cells].at(mapped.place(barycentric));
}

const SeeThrough::Mapped* SeeThrough::veil_of(std::uint32_t triangle) const {
    if (veils_.empty() || mapped_of_[triangle] == NotMapped)
        return nullptr;
    const Mapped& mapped = mapped_[mapped_of_[triangle]];
    return mapped.is_veil ? &mapped : nullptr;
}

float SeeThrough::part_at(std::uint32_t triangle, const glm::vec2& barycentric, RayOf of) const {
    if (const Mapped* mapped = veil_of(triangle))
        return of == RayOf::SettledLight && mapped->mean
                   ? *mapped->mean
                   : veils_[mapped->cells].at(mapped->place(barycentric));
    return part_of(veil(triangle, barycentric));
}

mesh::Veil SeeThrough::veil(std::uint32_t triangle, const glm::vec2& barycentric) const {
    return may_pass(triangle, RayOf::Light) ? mesh::veil(mesh_, triangle, barycentric)
                                            : mesh::Veil();
}

SeeThrough::All SeeThrough::all_at(std::uint32_t triangle, RayOf of) const {
    if (!may_pass(triangle, of))
        return All::Stop;
    const Mapped* mapped = of == RayOf::SettledLight ? veil_of(triangle) : nullptr;
    const float even = mapped != nullptr ? mapped->mean.value_or(-1.0f) : even_[triangle];
    if (even < 0.0f || (of == RayOf::Light && even < 1.0f))
        return All::Differ;
    return even >= 0.5f ? All::Pass : All::Stop;
}

bool SeeThrough::passes(const Meeting& meeting, RayOf of) const {
    const std::uint8_t kind = kinds_[meeting.triangle];
    if (is_eye(of) && meeting.is_back && (kind & OneSided) != 0 &&
        (of == RayOf::Eye || (kind & Thin) == 0))
        return true;
    const float even = even_.empty() ? -1.0f : even_[meeting.triangle];
    if (even < 0.0f)
        if (const MaskCells::Cell cell = cell_at(meeting.triangle, meeting.barycentric);
            cell != MaskCells::Cell::Mixed)
            return cell == MaskCells::Cell::CutOut;
    if (is_eye(of))
        return veil(meeting.triangle, meeting.barycentric) ==
               mesh::Veil{.weight = 0.0f, .through = glm::vec3(1.0f)};
    const float part = even >= 0.0f ? even : part_at(meeting.triangle, meeting.barycentric, of);
    if (of == RayOf::SettledLight)
        return part >= 0.5f;
    return part > 0.0f && (part >= 1.0f || chance(meeting) < static_cast<double>(part));
}

bool SeeThrough::light_passes(std::uint32_t triangle, const std::array<glm::dvec3, 3>& corners,
                              const glm::vec3& origin, const glm::vec3& direction, RayOf of) const {
    if (!may_pass(triangle, of))
        return false;
    if (const All all = all_at(triangle, of); all != All::Differ)
        return all == All::Pass;
    Meeting meeting{.triangle = triangle, .origin = origin, .direction = direction};
    if (even_[triangle] < 0.0f)
        meeting.barycentric = glm::vec2(meeting_of(corners, glm::dvec3(direction)).barycentric);
    return passes(meeting, of);
}

} // namespace relumine::prt
