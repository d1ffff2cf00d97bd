// Shiny receivers of every kind under one eye, precomputed, for the tests of glossy relighting.
#pragma once

#include "prt/glossy/glossy_precompute.h"
#include "tests/relight/relit_scene.h"

namespace relumine::scenes {

/// The scene of RelitScene; every third receiver is GGX, Blinn-Phong and Lambert.
struct GlossyScene {
    RelitScene diffuse;
    prt::Receivers receivers = diffuse.receivers;
    prt::GlossyOptions options;
    prt::Transfer transfer = diffuse.transfer;

    explicit GlossyScene(float tolerance = 0.05f, float roughness = 0.3f,
                         std::uint32_t face_resolution = 64)
        : diffuse(0.02f, face_resolution), options{.tolerance = tolerance,
                                                   .face_resolution = face_resolution,
                                                   .bias = diffuse.options.bias} {
        const glm::vec3 eye(1.5f, 2.5f, 3.0f);
        prt::look_from(receivers, eye);
        for (std::size_t i = 0; i < receivers.size(); ++i) {
            prt::Surface surface{.albedo = {0.6f, 0.4f, 0.2f}, .specular = {0.04f, 0.3f, 0.9f}};
            if (i % 3 != 2) {
                surface.highlight = i % 3 == 0 ? prt::Highlight::Ggx : prt::Highlight::BlinnPhong;
                surface.roughness_or_exponent =
                    i % 3 == 0 ? roughness : 2.0f / (roughness * roughness * roughness * roughness);
            }
            receivers.surfaces.push_back(surface);
        }
        transfer.glossy = prt::precompute_glossy(receivers, diffuse.rays, transfer, options);
        prt::set_surfaces(transfer, receivers);
    }

    [[nodiscard]] relight::ShadowRays shadow_rays() const { return diffuse.shadow_rays(); }
};

/// One for all tests that only read it.
[[nodiscard]] inline const GlossyScene& glossy_scene() {
    static const GlossyScene scene;
    return scene;
}

} // namespace relumine::scenes
