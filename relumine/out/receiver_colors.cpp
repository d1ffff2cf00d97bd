#include "relumine/out/receiver_colors.h"

#include <algorithm>
#include <stdexcept>
#include <variant>

#include <fmt/format.h>

#include "prt/receivers/mesh_point.h"
#include "relumine/in/emission.h"
#include "relumine/out/floor_picture.h"

namespace relumine {

namespace {

/// Whether the colours are looked at, computed with, or send light on.
enum class Purpose { Show, Compute, Bounce };

constexpr float PlasterAlbedo = 0.5f;

/// Returns what each receiver's radiance is multiplied with, [num_receivers].
std::vector<glm::vec3> factors(const Scene& scene, const Albedo& albedo) {
    if (const auto* factor = std::get_if<glm::vec3>(&albedo))
        return std::vector(scene.receivers.size(), *factor);
    return prt::colors_at(scene.mesh, scene.receivers);
}

/// Returns factors on each receiver's radiance, with what the options leave open.
std::vector<glm::vec3> factors(const Scene& scene, const OutputOptions& options, Purpose purpose) {
    const bool is_shown = purpose == Purpose::Bounce ||
                          (purpose == Purpose::Show && prt::kind_of(scene.layout).are_seen);
    const std::size_t num_points = scene.receivers.num_points();
    Albedo albedo = num_points == scene.receivers.size() ? Albedo(glm::vec3(1.0f)) : options.albedo;
    if (std::holds_alternative<AutomaticAlbedo>(albedo)) {
        if (!is_shown || !scene.receivers.surfaces.empty())
            albedo = glm::vec3(1.0f);
        else if (!scene.mesh.colors.empty())
            albedo = MeshColors{};
        else
            albedo = glm::vec3(PlasterAlbedo);
    }
    std::vector<glm::vec3> result = factors(scene, albedo);
    const std::vector<bool> is_floor = floor_receivers(scene);
    const glm::vec3 floor = options.floor_albedo.value_or(glm::vec3(is_shown ? FloorAlbedo : 1.0f));
    for (std::size_t i = 0; i < is_floor.size(); ++i)
        if (is_floor[i] &&
            (scene.receivers.surfaces.empty() || scene.receivers.surfaces[i] == prt::Surface()))
            result[i] = floor;
    // A point in space reflects nothing.
    std::fill_n(result.begin(), num_points, glm::vec3(1.0f));
    return result;
}

} // namespace

void require_fit(const Scene& scene, std::span<const glm::vec3> radiance) {
    if (radiance.size() != scene.receivers.size())
        throw std::invalid_argument(fmt::format("expected the radiance of {} receivers, got {}",
                                                scene.receivers.size(), radiance.size()));
}

std::vector<glm::vec3> product(std::span<const glm::vec3> a, std::span<const glm::vec3> b) {
    std::vector<glm::vec3> result(a.begin(), a.end());
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] *= b[i];
    return result;
}

void add_emission(std::span<const glm::vec3> emission, std::vector<glm::vec3>& colors) {
    for (std::size_t i = 0; i < std::min(emission.size(), colors.size()); ++i)
        colors[i] += emission[i];
}

std::vector<glm::vec3> picture_albedo(const Scene& scene, const OutputOptions& options) {
    return factors(scene, options, Purpose::Show);
}

std::vector<glm::vec3> bounce_albedo(const Scene& scene, const OutputOptions& options) {
    return factors(scene, options, Purpose::Bounce);
}

std::vector<glm::vec3> computed_albedo(const Scene& scene, const OutputOptions& options) {
    return factors(scene, options, Purpose::Compute);
}

std::vector<glm::vec3> colors_of(const Scene& scene, std::span<const glm::vec3> radiance,
                                 const Albedo& albedo) {
    require_fit(scene, radiance);
    std::vector<glm::vec3> colors =
        product(radiance, std::holds_alternative<AutomaticAlbedo>(albedo) ? computed_albedo(scene)
                                                                          : factors(scene, albedo));
    add_emission(emission_of(scene), colors);
    return colors;
}

} // namespace relumine
