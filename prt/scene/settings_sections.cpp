#include <fmt/format.h>

#include "prt/scene/json_members.h"
#include "prt/scene/section_group.h"
#include "prt/transfer/quadtree.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

const std::string Settings = "settings";

void camera_member(JsonMembers& member, const char* name, std::optional<Camera>& camera) {
    std::vector<float> values;
    if (camera)
        values = {camera->eye.x,    camera->eye.y,    camera->eye.z,      camera->target.x,
                  camera->target.y, camera->target.z, camera->fov_degrees};
    if (camera && camera->roll_degrees != 0.0f)
        values.push_back(camera->roll_degrees);
    member.unusual(name, values, {});
    if (values.empty())
        return;
    camera = Camera{.eye = {values.at(0), values.at(1), values.at(2)},
                    .target = {values.at(3), values.at(4), values.at(5)},
                    .fov_degrees = values.at(6),
                    .roll_degrees = values.size() > 7 ? values[7] : 0.0f};
    // Throws for a camera without a direction.
    static_cast<void>(axes_of(*camera, 1.0f));
}

void settings_members(JsonMembers& member, SceneSettings& settings) {
    member("tolerance", settings.tolerance);
    member("min_level", settings.min_level);
    member("face_resolution", settings.face_resolution);
    member("bias", settings.bias);
    member("floor_vertices", settings.floor_vertices);
    member("source", settings.source);
    std::string hash = fmt::format("{:016x}", settings.source_hash);
    member("source_hash", hash);
    if (hash.size() != 16 || hash.find_first_not_of("0123456789abcdef") != std::string::npos)
        throw std::out_of_range("expected 16 hexadecimal digits");
    settings.source_hash = std::stoull(hash, nullptr, 16);
    member.unusual("floor_added", settings.floor_added, 0u);
    member.unusual("epsilon", settings.epsilon, {});
    member.unusual("most_clusters", settings.most_clusters, {});
    member.unusual("glossy_tolerance", settings.glossy_tolerance, {});
    member.unusual("two_sided_bounces", settings.two_sided_bounces, false);
    member.unusual("left_out", settings.left_out, {});
    camera_member(member, "view", settings.view);
    camera_member(member, "camera", settings.camera);
}

void add_settings(NewSections& sections, const Scene& scene) {
    SceneSettings settings = scene.settings;
    JsonMembers members;
    settings_members(members, settings);
    if (const glm::dvec3& offset = scene.mesh.offset; offset != glm::dvec3(0.0))
        members.json.set("offset", files::Json::Array{offset.x, offset.y, offset.z});
    sections[Settings] = bytes_of(members.json.text(2));
}

void read_settings(const SectionReader& reader, Scene& scene) {
    const files::Json json = reader.json(Settings);
    try {
        JsonMembers members(json);
        settings_members(members, scene.settings);
        if (const files::Json* offset = json.find("offset"))
            for (int axis = 0; axis < 3; ++axis)
                scene.mesh.offset[axis] =
                    offset->values().at(static_cast<std::size_t>(axis)).number();
    } catch (const std::exception&) {
        reader.fail(Settings, "JSON with the settings");
    }
}

/// Checks that a precompute accepts the settings.
void check_settings(const SceneCheck& check, const Scene& scene) {
    const SceneSettings& settings = scene.settings;
    const auto is_number = [&](const std::string& what, float value) {
        check.that(value >= 0.0f && std::isfinite(value), what, SceneCheck::text_of(value));
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
    check.that(floor <= scene.mesh.num_vertices(),
               fmt::format("a floor among {} vertices", scene.mesh.num_vertices()),
               fmt::format("one of {}", floor));
    constexpr double FarthestOffset = 1e30;
    for (int axis = 0; axis < 3; ++axis)
        check.that(std::abs(scene.mesh.offset[axis]) <= FarthestOffset, "an offset within 1e30",
                   fmt::format("{}", scene.mesh.offset[axis]));
    for (const std::optional<Camera>& camera : {settings.view, settings.camera})
        if (camera)
            check_camera(check, scene, *camera);
}

float largest_place(const Scene& scene) {
    return LargestCoordinate - 2.0f * scene.settings.bias;
}

} // namespace

const SectionGroup SettingsSections = {
    .add = add_settings, .read = read_settings, .check = check_settings};

bool can_start_rays(const Scene& scene, const glm::vec3& place) {
    return is_within(place, -largest_place(scene), largest_place(scene));
}

std::string expected_place(const Scene& scene) {
    return fmt::format("coordinates within {}", std::max(largest_place(scene), 0.0f));
}

void check_camera(const SceneCheck& check, const Scene& scene, const Camera& camera) {
    check.that(can_start_rays(scene, camera.eye) && can_start_rays(scene, camera.target),
               expected_place(scene),
               fmt::format("a camera at {} that looks at {}", SceneCheck::text_of(camera.eye),
                           SceneCheck::text_of(camera.target)));
}

} // namespace relumine::prt
