#include "prt/scene/scene_check.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

/// For sums and products of floats that were in range, and for a mesh file's printed digits.
constexpr float RangeSlack = 1e-3f;
/// Colours of a mesh file may be above 1, but what is multiplied with them must stay finite.
constexpr float MaxColor = 1e6f;
/// As the exponent of an MTL file.
constexpr float MaxExponent = 1e6f;
/// Larger than the transfer of the narrowest highlight at the most grazing angle, 1/sr.
constexpr float MaxTransfer = 1e9f;

std::string text_of(float value) {
    return fmt::format("{}", value);
}
std::string text_of(const glm::vec2& v) {
    return fmt::format("({}, {})", v.x, v.y);
}
std::string text_of(const glm::vec3& v) {
    return fmt::format("({}, {}, {})", v.x, v.y, v.z);
}

class Check {
public:
    explicit Check(const std::filesystem::path& path) : path_(path) {}

    template<typename Element, typename IsGood>
    void all(const std::string& expected, const std::vector<Element>& elements,
             const IsGood& is_good) const {
        all(expected, elements, is_good, [](const Element& element) { return element; });
    }
    /// `field` takes what is looked at out of an element.
    template<typename Element, typename IsGood, typename Field>
    void all(const std::string& expected, const std::vector<Element>& elements,
             const IsGood& is_good, const Field& field) const {
        const auto bad = std::find_if_not(elements.begin(), elements.end(), is_good);
        if (bad != elements.end())
            fail(expected,
                 fmt::format("element {}: {}", bad - elements.begin(), text_of(field(*bad))));
    }
    void that(bool condition, const std::string& expected, const std::string& got) const {
        if (!condition)
            fail(expected, got);
    }

    [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path_.string(), expected, got));
    }

private:
    const std::filesystem::path& path_;
};

// NaN fails every comparison below.

bool is_unit(const glm::vec3& v) {
    return std::abs(glm::length(v) - 1.0f) <= RangeSlack;
}

bool is_unit_or_zero(const glm::vec3& v) {
    return v == glm::vec3(0.0f) || is_unit(v);
}

bool is_within(const glm::vec3& v, float low, float high) {
    return v.x >= low && v.x <= high && v.y >= low && v.y <= high && v.z >= low && v.z <= high;
}

void check_settings(const Check& check, const SceneSettings& settings,
                    const mesh::TriangleMesh& mesh) {
    const auto is_number = [&](const std::string& what, float value) {
        check.that(value >= 0.0f && std::isfinite(value), what, text_of(value));
    };
    is_number("a tolerance >= 0", settings.tolerance);
    is_number("an epsilon >= 0", settings.epsilon.value_or(0.0f));
    is_number("a bias >= 0", settings.bias);
    check.that(settings.face_resolution >= 1 && settings.face_resolution <= 1u << MaxLevel,
               fmt::format("a face resolution from 1 to {}", 1u << MaxLevel),
               fmt::format("{}", settings.face_resolution));
    check.that(settings.min_level <= MaxLevel,
               fmt::format("a minimum depth from 0 to {}", MaxLevel),
               fmt::format("{}", settings.min_level));
    const std::size_t floor =
        std::size_t{settings.floor_vertices} * settings.floor_vertices + settings.floor_added;
    check.that(floor <= mesh.num_vertices(),
               fmt::format("a floor among {} vertices", mesh.num_vertices()),
               fmt::format("one of {}", floor));
}

void check_tree(const Check& check, const Scene& scene) {
    const std::uint32_t deepest = texel_level(scene.settings.face_resolution);
    const std::uint32_t first = std::min(scene.settings.min_level, deepest);
    for (const Cell& cell : scene.transfer.quadtree.leaves())
        if (cell.level < first || cell.level > deepest)
            check.fail(fmt::format("clusters of levels {} to {}", first, deepest),
                       fmt::format("one of level {}", cell.level));
}

/// Rays start at the positions, lifted by the bias, and at eyes.
void check_places(const Check& check, const Scene& scene) {
    const float limit = LargestCoordinate - 2.0f * scene.settings.bias;
    const std::string expected = fmt::format("coordinates within {}", std::max(limit, 0.0f));
    const auto is_inside = [limit](const glm::vec3& position) {
        return is_within(position, -limit, limit);
    };
    const auto is_finite = [](const glm::vec3& position) {
        constexpr float Largest = std::numeric_limits<float>::max();
        return is_within(position, -Largest, Largest);
    };
    check.all("finite coordinates", scene.receivers.positions, is_finite);
    const auto check_mesh = [&](const mesh::TriangleMesh& mesh) {
        check.all("finite coordinates", mesh.positions, is_finite);
        for (const mesh::Triangle& triangle : mesh.triangles)
            for (const std::uint32_t vertex : triangle)
                if (!is_inside(mesh.positions[vertex]))
                    check.fail(expected, text_of(mesh.positions[vertex]));
    };
    check_mesh(scene.mesh);
    if (scene.blockers)
        check_mesh(*scene.blockers);
    for (std::size_t i = 0; i < scene.receivers.size(); ++i)
        if (scene.receivers.normals[i] != glm::vec3(0.0f) &&
            !is_inside(scene.receivers.positions[i]))
            check.fail(expected, text_of(scene.receivers.positions[i]));
    const auto camera = [&](const Camera& view) {
        check.that(is_inside(view.eye) && is_inside(view.target), expected,
                   fmt::format("a camera at {} that looks at {}", text_of(view.eye),
                               text_of(view.target)));
    };
    if (scene.settings.view)
        camera(*scene.settings.view);
    if (const auto* pixels = std::get_if<PixelLayout>(&scene.layout))
        camera(pixels->camera);
}

void check_surfaces(const Check& check, const std::vector<Surface>& surfaces) {
    const auto is_color = [](const glm::vec3& color) {
        return is_within(color, 0.0f, 1.0f + RangeSlack);
    };
    const auto albedo = [](const Surface& s) {
        return s.albedo;
    };
    const auto specular = [](const Surface& s) {
        return s.specular;
    };
    const auto shape = [](const Surface& s) {
        return s.roughness_or_exponent;
    };
    check.all(
        "surfaces of albedo 0 to 1", surfaces, [&](const Surface& s) { return is_color(s.albedo); },
        albedo);
    check.all(
        "surfaces of specular colour 0 to 1", surfaces,
        [&](const Surface& s) { return is_color(s.specular); }, specular);
    check.all(
        fmt::format("roughness of 0 to 1 and exponents of 0 to {}", MaxExponent), surfaces,
        [&](const Surface& s) {
            const float largest = s.highlight == Highlight::Ggx ? 1.0f + RangeSlack : MaxExponent;
            return s.roughness_or_exponent >= 0.0f && s.roughness_or_exponent <= largest;
        },
        shape);
}

void check_glossy(const Check& check, const GlossyTransfer& glossy) {
    for (const LobeCuts& lobe : glossy.lobes)
        check.all(
            fmt::format("highlights of a transfer within {}", MaxTransfer), lobe.scales,
            [](float scale) { return scale >= 0.0f && scale * 255.0f * 255.0f <= MaxTransfer; });
}

void check_bounces(const Scene& scene, const std::filesystem::path& path) {
    const Check check(path);
    const bool is_plan = scene.transfer.counts.num_receivers == 0;
    check.that(scene.bounces || scene.receivers.num_added == 0 || is_plan,
               "bounces that come from the added vertices", "none");
    if (!scene.bounces)
        return;
    try {
        require_bounces(*scene.bounces, scene.transfer.num_receivers());
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
    if (!std::holds_alternative<VertexLayout>(scene.layout))
        for (const std::uint32_t place : scene.bounces->emitters.places)
            if (scene.transfer.order[place] < scene.receivers.num_own())
                check.fail("light that comes from vertices",
                           fmt::format("some from {} {}", receiver_name(scene.layout),
                                       scene.transfer.order[place]));
}

} // namespace

void check_scene(const Scene& scene, const std::filesystem::path& path) {
    const Check check(path);
    check.that(!scene.mesh.triangles.empty(), "triangles", "none");
    check_settings(check, scene.settings, scene.mesh);
    check_places(check, scene);
    check.all("normals of length 1 or 0", scene.mesh.normals, is_unit_or_zero);
    check.all(fmt::format("colours of 0 to {}", MaxColor), scene.mesh.colors,
              [](const glm::vec3& color) { return is_within(color, 0.0f, MaxColor); });
    check.all("finite uvs", scene.mesh.uvs,
              [](const glm::vec2& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); });
    check.all("receivers' normals of length 1 or 0", scene.receivers.normals, is_unit_or_zero);
    check.all("directions to the eye of length 1", scene.receivers.to_eye, is_unit);
    check_surfaces(check, scene.receivers.surfaces);
    check_tree(check, scene);
    const bool is_glossy = scene.transfer.glossy.has_value();
    // A plan knows how its highlights will be.
    const bool is_plan = scene.transfer.counts.num_receivers == 0;
    check.that(is_glossy == scene.settings.glossy_tolerance.has_value() || (is_plan && !is_glossy),
               is_glossy ? "a tolerance of the highlights" : "highlights", "none");
    if (is_glossy)
        check_glossy(check, *scene.transfer.glossy);
    check_bounces(scene, path);
}

void check_highlights(const GlossyTransfer& glossy, const std::filesystem::path& path) {
    check_glossy(Check(path), glossy);
}

} // namespace relumine::prt
