#include "prt/scene/fingerprint.h"

#include <cstdint>

#include <fmt/format.h>

#include "files/hash.h"
#include "mesh/opacity.h"
#include "prt/arithmetic.h"
#include "prt/receivers/surface.h"
#include "prt/scene/brdf_tables.h"

namespace relumine::prt {

namespace {

/// Version of the algorithm and of a checkpoint's content. Raise it when a change of either makes
/// old checkpoints worthless.
constexpr int FingerprintVersion = 4;

class Hash {
public:
    template<typename Number>
    Hash& add(const std::vector<Number>& numbers) {
        hash_ = files::hash_of(std::as_bytes(std::span(numbers)), hash_ + numbers.size());
        return *this;
    }
    [[nodiscard]] std::string text() const { return fmt::format("{:016x}", hash_); }

private:
    std::uint64_t hash_ = 0;
};

/// Takes the fields that count; a Surface in memory has padding with random bytes.
std::vector<float> numbers_of(const std::vector<Surface>& surfaces) {
    std::vector<float> numbers;
    numbers.reserve(surfaces.size() * 6);
    for (const Surface& surface : surfaces)
        for (const float number :
             {static_cast<float>(surface.highlight), surface.roughness_or_exponent,
              surface.metallic, surface.emission.r, surface.emission.g, surface.emission.b})
            numbers.push_back(number);
    return numbers;
}

/// Hashes what decides where light passes triangles.
std::string text_of_alpha(const mesh::TriangleMesh& mesh) {
    std::vector<float> numbers;
    Hash hash;
    for (const mesh::Material& material : mesh.materials) {
        numbers.insert(numbers.end(),
                       {static_cast<float>(material.alpha_mode), material.alpha,
                        material.alpha_cutoff, material.transmission, material.thickness,
                        material.attenuation_distance, material.attenuation_color.r,
                        material.attenuation_color.g, material.attenuation_color.b,
                        material.base_color.r, material.base_color.g, material.base_color.b});
        if (const auto& slot = material.alpha_texture) {
            const glm::mat2& m = slot->uv_from_mesh_uv;
            numbers.insert(numbers.end(), {m[0][0], m[0][1], m[1][0], m[1][1], slot->uv_offset.x,
                                           slot->uv_offset.y, static_cast<float>(slot->wrap[0]),
                                           static_cast<float>(slot->wrap[1])});
            hash.add(mesh.textures[slot->texture].texels);
        }
    }
    return hash.add(numbers)
        .add(mesh.triangle_materials)
        .add(mesh.uvs)
        .add(mesh.second_uvs)
        .add(mesh.corner_uvs)
        .text();
}

} // namespace

Fingerprint fingerprint(const Scene& scene, std::optional<float> bounce_tolerance) {
    const SceneSettings& settings = scene.settings;
    const mesh::TriangleMesh& blockers = scene.blocking_mesh();
    const Receivers& receivers = scene.receivers;
    const auto text = [](auto number) {
        return fmt::format("{}", number);
    };
    Fingerprint result = {
        {"version", text(FingerprintVersion)},
        {"mesh", Hash().add(blockers.positions).add(blockers.triangles).text()},
        {"receivers", Hash().add(receivers.positions).add(receivers.normals).text()},
        {"number of receivers", text(receivers.size())},
        {settings.epsilon ? "epsilon" : "tolerance",
         text(settings.epsilon.value_or(settings.tolerance))},
        {"min depth", text(settings.min_level)},
        {"face resolution", text(settings.face_resolution)},
        {"bias", text(settings.bias)},
        {"processor", arithmetic()}};
    if (settings.most_clusters)
        result.emplace_back("most clusters", text(*settings.most_clusters));
    if (mesh::lets_light_pass(blockers))
        result.emplace_back("alpha", text_of_alpha(blockers));
    if (bounce_tolerance) {
        result.emplace_back("bounces", text(*bounce_tolerance));
        result.emplace_back("two-sided", settings.two_sided_bounces ? "yes" : "no");
    }
    for (const auto& table : brdf_tables(scene))
        result.emplace_back("BRDF", Hash().add(table->values()).text());
    if (settings.glossy_tolerance) {
        result.emplace_back("glossy tolerance", text(*settings.glossy_tolerance));
        result.emplace_back(
            "surfaces or eye",
            Hash().add(numbers_of(receivers.surfaces)).add(receivers.to_eye).text());
    }
    return result;
}

} // namespace relumine::prt
