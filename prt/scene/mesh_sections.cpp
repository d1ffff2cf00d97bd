#include <algorithm>

#include <fmt/format.h>

#include "prt/scene/absent_groups.h"
#include "prt/scene/json_members.h"
#include "prt/scene/packed_mesh.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

void require_indices(const SectionReader& reader, const mesh::TriangleMesh& mesh,
                     const std::string& section) {
    for (const mesh::Triangle& triangle : mesh.triangles)
        if (std::any_of(triangle.begin(), triangle.end(),
                        [&](auto i) { return i >= mesh.num_vertices(); }))
            reader.fail(section, "indices of vertices");
}

void group_members(JsonMembers& member, std::vector<std::string>& names,
                   std::vector<std::string>& absent, SceneSettings& settings) {
    member("names", names);
    member.unusual("absent", absent, {});
    member.unusual("bounce_tolerance", settings.bounce_tolerance, 0.0f);
    member.unusual("rim_step", settings.rim_step, {});
}

/// Adds what moves need to know.
void add_groups(NewSections& sections, const Scene& scene) {
    std::vector<std::string> names = scene.mesh.groups, absent = absent_names(scene);
    SceneSettings settings = scene.settings;
    JsonMembers members;
    group_members(members, names, absent, settings);
    sections["groups"] = bytes_of(members.json.text(2));
    sections["t_groups"] = SectionContent::view(scene.mesh.triangle_groups);
    if (!scene.blockers)
        return;
    if (scene.blockers->groups.size() > names.size() ||
        !std::equal(scene.blockers->groups.begin(), scene.blockers->groups.end(), names.begin()))
        throw std::invalid_argument("expected blockers of the same groups as the mesh");
    sections["block_groups"] = SectionContent::view(scene.blockers->triangle_groups);
}

void read_groups(const SectionReader& reader, Scene& scene) {
    if (!reader.has("groups"))
        return;
    const files::Json json = reader.json("groups");
    std::vector<std::string> absent_names;
    try {
        JsonMembers members(json);
        group_members(members, scene.mesh.groups, absent_names, scene.settings);
    } catch (const std::exception&) {
        reader.fail("groups", "JSON with the names of groups");
    }
    scene.settings.is_movable = true;
    for (const std::string& name : absent_names) {
        const auto found = std::find(scene.mesh.groups.begin(), scene.mesh.groups.end(), name);
        const auto group = static_cast<std::uint32_t>(found - scene.mesh.groups.begin());
        if (found == scene.mesh.groups.end() || absent(scene, group) != nullptr)
            reader.fail("groups", "absent groups by their names, each once");
        scene.absent.push_back({.group = group}); // load_scene() takes it away
    }
    const auto read = [&](const std::string& section, mesh::TriangleMesh& mesh) {
        mesh.triangle_groups = reader.elements<std::uint32_t>(section, mesh.num_triangles());
        const std::size_t count = scene.mesh.groups.size();
        if (std::any_of(mesh.triangle_groups.begin(), mesh.triangle_groups.end(),
                        [&](std::uint32_t group) { return group >= count; }))
            reader.fail(section, "indices of groups");
    };
    read("t_groups", scene.mesh);
    if (!scene.blockers)
        return;
    scene.blockers->groups = scene.mesh.groups;
    read("block_groups", *scene.blockers);
}

void add_mesh(NewSections& sections, const Scene& scene) {
    const bool are_there = scene.absent.empty() || !scene.settings.is_movable;
    sections["positions"] = SectionContent::view(scene.mesh.positions);
    sections["triangles"] =
        are_there ? SectionContent::view(scene.mesh.triangles) : bytes_of(whole_mesh(scene));
    sections["normals"] = SectionContent::view(scene.mesh.normals);
    if (!scene.mesh.colors.empty())
        sections["colors"] = SectionContent::view(scene.mesh.colors);
    if (!scene.mesh.uvs.empty())
        sections["uvs"] = SectionContent::view(scene.mesh.uvs);
    if (!scene.mesh.second_uvs.empty())
        sections["second_uvs"] = SectionContent::view(scene.mesh.second_uvs);
    if (!scene.mesh.lifts.empty())
        sections["lifts"] = SectionContent::view(scene.mesh.lifts);
    if (!scene.free_lifts.empty() && scene.settings.is_movable)
        sections["free_lifts"] = SectionContent::view(scene.free_lifts);
    if (scene.blockers) {
        sections["block_positions"] = SectionContent::view(scene.blockers->positions);
        sections["block_triangles"] = are_there ? SectionContent::view(scene.blockers->triangles)
                                                : bytes_of(whole_blockers(scene));
    }
    if (scene.settings.is_movable)
        add_groups(sections, scene);
}

void read_mesh(const SectionReader& reader, Scene& scene) {
    mesh::TriangleMesh& mesh = scene.mesh;
    if (has_packed_mesh(reader)) {
        read_packed_mesh(reader, mesh);
        require_indices(reader, mesh, "packed_triangles");
        return;
    }
    mesh.positions = reader.elements<glm::vec3>("positions");
    mesh.triangles = reader.elements<mesh::Triangle>("triangles");
    mesh.normals = reader.elements<glm::vec3>("normals", mesh.num_vertices());
    mesh.colors = reader.elements<glm::vec3>("colors", mesh.num_vertices(), true);
    mesh.uvs = reader.elements<glm::vec2>("uvs", mesh.num_vertices(), true);
    mesh.second_uvs = reader.elements<glm::vec2>("second_uvs", mesh.num_vertices(), true);
    mesh.lifts = reader.elements<glm::vec3>("lifts", mesh.num_vertices(), true);
    scene.free_lifts = reader.elements<glm::vec3>("free_lifts", mesh.num_vertices(), true);
    require_indices(reader, mesh, "triangles");
    if (reader.has("block_triangles")) {
        mesh::TriangleMesh& blockers = scene.blockers.emplace();
        blockers.positions = reader.elements<glm::vec3>("block_positions");
        blockers.triangles = reader.elements<mesh::Triangle>("block_triangles");
        require_indices(reader, blockers, "block_triangles");
    }
    read_groups(reader, scene);
}

void check_mesh(const SceneCheck& check, const Scene& scene) {
    check.that(!scene.mesh.triangles.empty(), "triangles", "none");
    const auto check_places = [&](const mesh::TriangleMesh& mesh) {
        check.all("finite coordinates", mesh.positions, is_finite);
        check.all("finite lifts", mesh.lifts, is_finite);
        for (const mesh::Triangle& triangle : mesh.triangles)
            for (const std::uint32_t vertex : triangle)
                if (!can_start_rays(scene, mesh.positions[vertex]))
                    check.fail(expected_place(scene), SceneCheck::text_of(mesh.positions[vertex]));
    };
    check_places(scene.mesh);
    check.all("finite lifts", scene.free_lifts, is_finite);
    if (scene.blockers)
        check_places(*scene.blockers);
    check.all("normals of length 1 or 0", scene.mesh.normals, is_unit_or_zero);
    // Colours of a mesh file may be above 1, but what is multiplied with them must stay finite.
    constexpr float MaxColor = 1e6f;
    check.all(fmt::format("colours of 0 to {}", MaxColor), scene.mesh.colors,
              [](const glm::vec3& color) { return is_within(color, 0.0f, MaxColor); });
    check.all("finite uvs", scene.mesh.uvs, is_finite_uv);
    check.all("finite uvs", scene.mesh.second_uvs, is_finite_uv);
    for (const float value :
         {scene.settings.bounce_tolerance, scene.settings.rim_step.value_or(0.0f)})
        check.that(value >= 0.0f && std::isfinite(value), "numbers >= 0 with the groups",
                   SceneCheck::text_of(value));
}

} // namespace

const SectionGroup MeshSections = {.add = add_mesh, .read = read_mesh, .check = check_mesh};

} // namespace relumine::prt
