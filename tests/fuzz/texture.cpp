#include <cmath>

#include "mesh/materials/texture.h"
#include "tests/fuzz/fuzz.h"

RELUMINE_FUZZ_TARGET(texture) {
    using namespace relumine;
    const auto decoded = [&](const auto& decode) {
        mesh::ImageBudget budget;
        return fuzz::accepted(
            [&] { return decode(fuzz::bytes(data, size), mesh::VOrigin::Bottom, budget); });
    };
    const auto texture = decoded(mesh::decode_texture);
    const auto alpha = decoded(mesh::decode_alpha_texture);
    if (!texture)
        return 0;
    fuzz::require(alpha && (alpha->width == texture->width || alpha->width == 1),
                  "an image has an alpha");
    fuzz::require(texture->texels.size() == std::size_t{texture->width} * texture->height,
                  "a texture has all its texels");
    for (const float u : {0.0f, 1.0f, -0.3f, 1e30f, NAN})
        for (const mesh::Wrap wrap : {mesh::Wrap::Repeat, mesh::Wrap::Clamp, mesh::Wrap::Mirror}) {
            const glm::vec3 color =
                mesh::sample(*texture, {.is_srgb = true, .wrap = {wrap, wrap}}, {u, 0.7f});
            fuzz::require(color.r >= 0.0f && color.r <= 1.0f, "a texture's colours are 0 to 1");
        }
    return 0;
}
