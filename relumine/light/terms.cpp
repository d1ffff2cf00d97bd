#include "relumine/light/terms.h"

#include "relight/harmonics/harmonics.h"
#include "relight/receiver_light.h"

namespace relumine {

namespace {

/// Adds values, or none.
void add(std::span<const glm::vec3> values, std::span<glm::vec3> sum) {
    for (std::size_t i = 0; i < values.size(); ++i)
        sum[i] += values[i];
}

/// Returns where radiance of unknown directions is summed.
std::span<glm::vec3> sent_of(ArrivingLight& own) {
    own.sent.resize(own.harmonics.size() / relight::num_harmonics(own.order), glm::vec3(0.0f));
    return own.sent;
}

} // namespace

// Clusters

void ClusterTerm::add_radiance(std::span<glm::vec3> own) const {
    add(relighter_.radiance(), own);
}

void ClusterTerm::add_soft(std::span<glm::vec3> own) const {
    // As picture_lights() are empty, which need not be merged for that.
    if (relighter_.shadow_rays().blockers == nullptr || relighter_.sharp_lights().empty())
        add_radiance(own);
    else
        add(relighter_.receiver_light().soft_radiance(), own);
}

void ClusterTerm::add_harmonics(ArrivingLight& own) const {
    add(relighter_.harmonics(), own.harmonics);
}

std::vector<relight::SharpLight> ClusterTerm::lights() const {
    return relight::picture_lights(relighter_);
}

glm::dvec3 ClusterTerm::open_floor() const {
    return relighter_.open_radiance({0.0f, 1.0f, 0.0f});
}

// Bounces

void BounceTerm::add_radiance(std::span<glm::vec3> own) const {
    receivers_.add_of_all(bounces_.bounced(), own);
}

void BounceTerm::add_harmonics(ArrivingLight& own) const {
    add_radiance(sent_of(own));
    const prt::Transfer& transfer = receivers_.transfer();
    if (transfer.num_points == 0)
        return;
    const std::size_t width = relight::num_harmonics(own.order);
    const std::vector<glm::vec3> of_all = bounces_.point_harmonics(own.order);
    const std::vector<std::uint32_t> places = receivers_.places();
    for (std::size_t place = 0; place < transfer.num_points; ++place)
        for (std::size_t k = 0; k < width; ++k)
            own.harmonics[transfer.order[place] * width + k] += of_all[places[place] * width + k];
}

// Lamps

void LampTerm::add_radiance(std::span<glm::vec3> own) const {
    receivers_.add_of_all(lamps_.direct(), own);
    receivers_.add_of_all(lamps_.bounced(), own);
}

void LampTerm::add_harmonics(ArrivingLight& own) const {
    add_radiance(sent_of(own));
}

// Lists

void ListTerm::add_radiance(std::span<glm::vec3> own) const {
    add(listed_.radiance, own);
}

void ListTerm::add_soft(std::span<glm::vec3> own) const {
    add(listed_.without_traced(), own);
}

void ListTerm::add_harmonics(ArrivingLight& own) const {
    add(listed_.harmonics, own.harmonics);
}

std::vector<relight::SharpLight> ListTerm::lights() const {
    return listed_.lights;
}

glm::dvec3 ListTerm::open_floor() const {
    return listed_.open_floor;
}

// Mirrors

void MirrorTerm::add_radiance(std::span<glm::vec3> own) const {
    SceneMirrors::Surfaces surfaces{.emission = lamps_.gains()};
    std::vector<glm::vec3> whole;
    if (mirrors_.shows_surfaces()) {
        whole = receivers_.of_all(own);
        surfaces.radiance = whole;
        if (bounces_.is_set())
            surfaces.albedo = bounces_.surfaces().albedo;
    }
    mirrors_.add(relighter_, surfaces, receivers_.indices(own.size()), own);
}

} // namespace relumine
