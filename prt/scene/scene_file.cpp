#include "prt/scene/scene_file.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/output_file.h"
#include "prt/scene/bounce_sections.h"
#include "prt/scene/count_sections.h"
#include "prt/scene/glossy_sections.h"
#include "prt/scene/material_sections.h"
#include "prt/scene/older_counts.h"
#include "prt/scene/receiver_sections.h"
#include "prt/scene/scene_check.h"
#include "prt/scene/scene_sections.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

namespace {

/// Packs split flags with their number in front.
std::vector<std::byte> counted(const std::vector<bool>& flags) {
    std::vector<std::byte> bytes = bytes_of(std::vector{static_cast<std::uint32_t>(flags.size())});
    const std::vector<std::byte> bits = packed(flags);
    bytes.insert(bytes.end(), bits.begin(), bits.end());
    return bytes;
}

std::vector<std::byte> settings_json(const SceneSettings& settings) {
    files::Json json = {{"tolerance", settings.tolerance},
                        {"min_level", settings.min_level},
                        {"face_resolution", settings.face_resolution},
                        {"bias", settings.bias},
                        {"floor_vertices", settings.floor_vertices},
                        {"source", settings.source},
                        {"source_hash", fmt::format("{:016x}", settings.source_hash)}};
    if (settings.floor_added != 0)
        json.set("floor_added", settings.floor_added);
    if (settings.epsilon)
        json.set("epsilon", *settings.epsilon);
    if (settings.glossy_tolerance)
        json.set("glossy_tolerance", *settings.glossy_tolerance);
    if (settings.two_sided_bounces)
        json.set("two_sided_bounces", true);
    if (settings.view) {
        const Camera& view = *settings.view;
        json.set("view", {view.eye.x, view.eye.y, view.eye.z, view.target.x, view.target.y,
                          view.target.z, view.fov_degrees});
    }
    const std::string text = json.text(2);
    return bytes_of(text);
}

class SceneReader {
public:
    SceneReader(const std::filesystem::path& path, Sections&& sections, std::uint32_t version)
        : reader_(path, std::move(sections)), version_(version) {}

    /// A plan has no counts.
    Scene scene(bool is_plan) const {
        if (!is_plan && reader_.has("plan"))
            throw std::runtime_error(fmt::format(
                "{}: expected a scene, got {}", reader_.path().string(),
                reader_.has("part") ? "a part of one" : "a plan of one, which has no light yet"));
        Scene scene;
        scene.mesh = mesh();
        scene.blockers = blockers();
        scene.settings = settings();
        scene.layout = read_layout(reader_);
        scene.receivers = read_receivers(reader_, scene.layout, scene.mesh);
        scene.transfer = clusters(scene.receivers);
        if (!is_plan)
            read_light(scene.transfer, scene.receivers, scene.settings);
        scene.bounces = read_bounces(reader_, scene.receivers.size());
        check_scene(scene, reader_.path());
        return scene;
    }

private:
    mesh::TriangleMesh mesh() const {
        mesh::TriangleMesh mesh;
        mesh.positions = reader_.elements<glm::vec3>("positions");
        mesh.triangles = reader_.elements<mesh::Triangle>("triangles");
        mesh.normals = reader_.elements<glm::vec3>("normals", mesh.num_vertices());
        mesh.colors = reader_.elements<glm::vec3>("colors", mesh.num_vertices(), true);
        mesh.uvs = reader_.elements<glm::vec2>("uvs", mesh.num_vertices(), true);
        require_indices(mesh, "triangles");
        read_material_sections(reader_, mesh);
        return mesh;
    }

    std::optional<mesh::TriangleMesh> blockers() const {
        if (!reader_.has("block_triangles"))
            return std::nullopt;
        mesh::TriangleMesh blockers;
        blockers.positions = reader_.elements<glm::vec3>("block_positions");
        blockers.triangles = reader_.elements<mesh::Triangle>("block_triangles");
        require_indices(blockers, "block_triangles");
        return blockers;
    }

    void require_indices(const mesh::TriangleMesh& mesh, const std::string& section) const {
        for (const mesh::Triangle& triangle : mesh.triangles)
            if (std::any_of(triangle.begin(), triangle.end(),
                            [&](auto i) { return i >= mesh.num_vertices(); }))
                reader_.fail(section, "indices of vertices");
    }

    SceneSettings settings() const {
        const files::Json json = reader_.json("settings");
        SceneSettings settings;
        try {
            settings.tolerance = real(json.at("tolerance"));
            settings.min_level = natural(json.at("min_level"));
            settings.face_resolution = natural(json.at("face_resolution"));
            settings.bias = real(json.at("bias"));
            settings.floor_vertices = natural(json.at("floor_vertices"));
            if (json.find("floor_added"))
                settings.floor_added = natural(json.at("floor_added"));
            settings.source = json.at("source").string();
            settings.source_hash = std::stoull(json.at("source_hash").string(), nullptr, 16);
            if (json.find("epsilon"))
                settings.epsilon = real(json.at("epsilon"));
            if (json.find("glossy_tolerance"))
                settings.glossy_tolerance = real(json.at("glossy_tolerance"));
            if (json.find("two_sided_bounces"))
                settings.two_sided_bounces = json.at("two_sided_bounces").boolean();
            if (json.find("view")) {
                const files::Json& view = json.at("view");
                const auto at = [&](std::size_t i) {
                    return real(view.values().at(i));
                };
                settings.view = Camera{.eye = {at(0), at(1), at(2)},
                                       .target = {at(3), at(4), at(5)},
                                       .fov_degrees = at(6)};
                // Throws for a camera without a direction.
                static_cast<void>(axes_of(*settings.view, 1.0f));
            }
        } catch (const std::exception&) {
            reader_.fail("settings", "JSON with the settings");
        }
        return settings;
    }

    Quadtree quadtree() const {
        const std::vector<std::uint8_t> bytes = reader_.elements<std::uint8_t>("quadtree");
        std::uint32_t num_flags = 0;
        if (bytes.size() < sizeof num_flags)
            reader_.fail("quadtree", "split flags");
        std::memcpy(&num_flags, bytes.data(), sizeof num_flags);
        if (bytes.size() != sizeof num_flags + (std::size_t{num_flags} + 7) / 8)
            reader_.fail("quadtree", "split flags");
        std::vector<bool> flags(num_flags);
        for (std::size_t i = 0; i < flags.size(); ++i)
            flags[i] = (bytes[sizeof num_flags + i / 8] >> (i % 8) & 1) != 0;
        if (num_flags % 8 != 0 && bytes.back() >> (num_flags % 8) != 0)
            reader_.fail("quadtree", "split flags");
        try {
            return Quadtree(flags);
        } catch (const std::invalid_argument&) {
            reader_.fail("quadtree", "split flags of six trees");
        }
    }

    /// Returns a transfer without counts.
    Transfer clusters(const Receivers& receivers) const {
        Transfer transfer;
        const std::size_t num_receivers = receivers.size();
        transfer.quadtree = quadtree();
        transfer.order = reader_.elements<std::uint32_t>("order", num_receivers);
        std::vector<bool> seen(num_receivers);
        for (const std::uint32_t receiver : transfer.order) {
            if (receiver >= num_receivers || seen[receiver])
                reader_.fail("order", "every receiver once");
            seen[receiver] = true;
            transfer.normals.push_back(receivers.normals[receiver]);
        }
        return transfer;
    }

    void read_light(Transfer& transfer, const Receivers& receivers,
                    const SceneSettings& settings) const {
        transfer.counts.num_receivers = receivers.size();
        transfer.counts.num_leaves = transfer.quadtree.num_leaves();
        read_counts(reader_, version_, transfer.counts);
        if (version_ < 3)
            count_above_horizon(transfer.counts, transfer.quadtree, transfer.normals,
                                texel_level(settings.face_resolution));
        if (has_glossy(reader_)) {
            if (receivers.to_eye.empty() || receivers.surfaces.empty())
                reader_.fail("g_specular_b", "directions to the eye and surfaces with highlights");
            transfer.glossy = read_glossy(reader_, transfer.counts.num_blocks());
        }
        set_surfaces(transfer, receivers);
    }

    SectionReader reader_;
    std::uint32_t version_;
};

} // namespace

NewSections sections_without_light(const std::filesystem::path& path, const Scene& scene) {
    const bool on_vertices = std::holds_alternative<VertexLayout>(scene.layout);
    if (on_vertices && scene.receivers.size() != 0 &&
        scene.receivers.size() != scene.mesh.num_vertices())
        throw std::invalid_argument(
            fmt::format("{}: expected one receiver per vertex, got {} for {}", path.string(),
                        scene.receivers.size(), scene.mesh.num_vertices()));
    const std::size_t num_receivers =
        on_vertices ? scene.mesh.num_vertices() : scene.receivers.size();
    if (scene.transfer.num_receivers() != num_receivers ||
        scene.mesh.normals.size() != scene.mesh.num_vertices())
        throw std::invalid_argument(
            fmt::format("{}: expected the transfer of {} receivers and a normal for each of {} "
                        "vertices, got {} and {}",
                        path.string(), num_receivers, scene.mesh.num_vertices(),
                        scene.transfer.num_receivers(), scene.mesh.normals.size()));
    check_scene(scene, path);
    NewSections sections;
    sections["settings"] = settings_json(scene.settings);
    sections["positions"] = SectionContent::view(scene.mesh.positions);
    sections["triangles"] = SectionContent::view(scene.mesh.triangles);
    sections["normals"] = SectionContent::view(scene.mesh.normals);
    if (scene.blockers) {
        sections["block_positions"] = SectionContent::view(scene.blockers->positions);
        sections["block_triangles"] = SectionContent::view(scene.blockers->triangles);
    }
    if (!scene.mesh.colors.empty())
        sections["colors"] = SectionContent::view(scene.mesh.colors);
    if (!scene.mesh.uvs.empty())
        sections["uvs"] = SectionContent::view(scene.mesh.uvs);
    if (on_vertices && !scene.receivers.surfaces.empty())
        add_material_sections(sections, scene.mesh);
    add_receiver_sections(sections, scene.receivers, scene.layout);
    sections["order"] = SectionContent::view(scene.transfer.order);
    sections["quadtree"] = counted(scene.transfer.quadtree.split_flags());
    return sections;
}

std::uint64_t save_scene(const std::filesystem::path& path, const Scene& scene) {
    NewSections sections = sections_without_light(path, scene);
    add_counts(sections, scene.transfer.counts);
    if (scene.transfer.glossy)
        add_glossy_sections(sections, *scene.transfer.glossy);
    if (scene.bounces)
        add_bounce_sections(sections, *scene.bounces);
    return write_sections(path, sections);
}

Scene load_scene(const std::filesystem::path& path) {
    std::uint32_t version = 0;
    Sections sections = read_sections(path, &version);
    return scene_of(path, std::move(sections), version);
}

Scene scene_of(const std::filesystem::path& path, Sections&& sections, std::uint32_t version) {
    return SceneReader(path, std::move(sections), version).scene(false);
}

Scene plan_of(const std::filesystem::path& path, Sections&& sections) {
    return SceneReader(path, std::move(sections), SceneFileVersion).scene(true);
}

} // namespace relumine::prt
