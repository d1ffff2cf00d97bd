// A scene shows the same from its file as from memory, whatever textures its materials have.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "data_gen/environments.h"
#include "mesh/materials/material_members.h"
#include "mesh/tangents.h"
#include "relumine/in/precompute.h"
#include "relumine/light/lit_scene.h"
#include "relumine/out/output.h"
#include "tests/prt/textured_square.h"
#include "tests/relumine/small_scenes.h"

namespace relumine {
namespace {

/// A material that shows each texture of its model.
mesh::Material layered() {
    return {.model = mesh::MaterialModel::MetallicRoughness,
            .base_color = glm::vec3(0.7f),
            .metallic = 0.5f,
            .roughness = 0.5f,
            .specular = glm::vec3(0.3f),
            .emission = glm::vec3(0.4f),
            .alpha_mode = mesh::AlphaMode::Blend,
            .alpha = 0.8f,
            .transmission = 0.3f,
            .diffuse_transmission = 0.4f,
            .coat = 0.75f,
            .coat_roughness = 0.4f,
            .sheen = glm::vec3(0.6f),
            .sheen_roughness = 0.5f,
            .film = 0.6f,
            .anisotropy = 0.5f};
}

/// A mapped square of that material, and a texture without a file, of colours or of grey.
mesh::TriangleMesh square(bool is_grey) {
    mesh::TriangleMesh mesh = scenes::mapped_square({200, 90, 240});
    mesh.textures = {
        {.name = "made",
         .width = 2,
         .height = 1,
         .texels = is_grey
                       ? std::vector<std::array<std::uint8_t, 3>>{{150, 150, 150}, {30, 30, 30}}
                       : std::vector<std::array<std::uint8_t, 3>>{{200, 90, 240}, {20, 160, 60}}}};
    mesh.materials = {layered()};
    mesh::set_tangents(mesh, {});
    return mesh;
}

std::vector<glm::vec3> drawn(Scene scene) {
    LitScene lit(std::move(scene));
    lit.light(data_gen::sun_and_sky(16)); // nowhere even
    return Painter(lit, {.width = 12, .height = 12, .samples_per_axis = 1})
        .draw(lit.lighting())
        .pixels;
}

Scene made(const mesh::TriangleMesh& mesh) {
    PrecomputeOptions options{.tolerance = 0.1f};
    options.no_refine = true;
    return precompute(mesh, options);
}

class Textures : public scenes::InFolder {
protected:
    /// A picture from the file is that from memory.
    void is_kept(bool is_grey, mesh::MaterialModel model,
                 std::optional<mesh::TextureSlot> mesh::Material::* slot) const {
        mesh::TriangleMesh mesh = square(is_grey);
        mesh::Material& material = mesh.materials[0];
        material.model = model;
        const std::vector<glm::vec3> without = drawn(made(mesh));
        material.*slot = mesh::TextureSlot{.texture = 0};
        const Scene scene = made(mesh);
        const std::vector<glm::vec3> from_memory = drawn(scene);
        EXPECT_NE(from_memory, without) << "the texture shows";
        save_scene(file("scene.prt"), scene);
        EXPECT_EQ(drawn(load_scene(file("scene.prt"))), from_memory);
    }
};

TEST_F(Textures, OfEachKindAreInTheFile) {
    using enum mesh::MaterialModel;
    for (const bool is_grey : {false, true})
        for (const mesh::MaterialMember& member : mesh::MaterialMembers)
            if (const auto slot = member.texture()) {
                SCOPED_TRACE(member.name);
                is_kept(is_grey,
                        slot == &mesh::Material::specular_texture ? SpecularGlossiness
                                                                  : MetallicRoughness,
                        slot);
            }
}

TEST_F(Textures, OfGlossinessAreInTheFile) {
    is_kept(true, mesh::MaterialModel::SpecularGlossiness,
            &mesh::Material::metallic_roughness_texture);
}

} // namespace
} // namespace relumine
