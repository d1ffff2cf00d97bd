#include "prt/scene/scene_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

namespace relumine::prt {

namespace {

class Check {
public:
    explicit Check(const std::filesystem::path& path) : path_(path) {}

    template<typename Element, typename IsGood>
    void all(const char* what, const std::vector<Element>& elements, const IsGood& is_good) const {
        const auto bad = std::find_if_not(elements.begin(), elements.end(), is_good);
        if (bad != elements.end())
            fail(what, fmt::format("element {} is not", bad - elements.begin()));
    }
    void that(bool condition, const std::string& expected, const std::string& got) const {
        if (!condition)
            fail(expected, got);
    }

private:
    [[noreturn]] void fail(const std::string& expected, const std::string& got) const {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path_.string(), expected, got));
    }
    const std::filesystem::path& path_;
};

bool is_unit_or_zero(const glm::vec3& v) {
    constexpr float Slack = 1e-3f; // for a mesh file's printed digits
    return v == glm::vec3(0.0f) || std::abs(glm::length(v) - 1.0f) <= Slack;
}

void check_settings(const Check& check, const SceneSettings& settings,
                    const mesh::TriangleMesh& mesh) {
    const auto number = [](float value) {
        return fmt::format("{}", value);
    };
    check.that(settings.tolerance >= 0.0f, "a tolerance >= 0", number(settings.tolerance));
    check.that(settings.epsilon.value_or(0.0f) >= 0.0f, "an epsilon >= 0",
               number(settings.epsilon.value_or(0.0f)));
    check.that(settings.bias >= 0.0f, "a bias >= 0", number(settings.bias));
    check.that(settings.face_resolution >= 1 && settings.face_resolution <= 1u << MaxLevel,
               fmt::format("a face resolution from 1 to {}", 1u << MaxLevel),
               fmt::format("{}", settings.face_resolution));
    check.that(settings.min_level <= MaxLevel,
               fmt::format("a minimum depth from 0 to {}", MaxLevel),
               fmt::format("{}", settings.min_level));
    const std::size_t floor = std::size_t{settings.floor_vertices} * settings.floor_vertices;
    check.that(floor <= mesh.num_vertices(),
               fmt::format("a floor among {} vertices", mesh.num_vertices()),
               fmt::format("one of {}", floor));
}

void check_tree(const Check& check, const Scene& scene) {
    const auto deepest =
        static_cast<std::uint32_t>(std::bit_width(scene.settings.face_resolution - 1));
    const std::uint32_t first = std::min(scene.settings.min_level, deepest);
    for (const Cell& cell : scene.transfer.quadtree.leaves())
        check.that(cell.level >= first && cell.level <= deepest,
                   fmt::format("clusters of levels {} to {}", first, deepest),
                   fmt::format("one of level {}", cell.level));
}

} // namespace

void check_scene(const Scene& scene, const std::filesystem::path& path) {
    const Check check(path);
    check.all("normals of length 1 or 0", scene.mesh.normals, is_unit_or_zero);
    check.all("colours >= 0", scene.mesh.colors,
              [](const glm::vec3& c) { return c.r >= 0.0f && c.g >= 0.0f && c.b >= 0.0f; });
    check.all("finite uvs", scene.mesh.uvs,
              [](const glm::vec2& uv) { return std::isfinite(uv.x) && std::isfinite(uv.y); });
    check.all("receivers' normals of length 1 or 0", scene.receivers.normals, is_unit_or_zero);
    check.all("directions to the eye of length 1 or 0", scene.receivers.to_eye, is_unit_or_zero);
    check_settings(check, scene.settings, scene.mesh);
    check_tree(check, scene);
    const bool is_glossy = scene.transfer.glossy.has_value();
    check.that(is_glossy == scene.settings.glossy_tolerance.has_value(),
               is_glossy ? "a tolerance of the highlights" : "highlights", "none");
}

} // namespace relumine::prt
