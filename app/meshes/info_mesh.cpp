#include "app/meshes/info_mesh.h"

#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/options/output_options.h"
#include "files/counted.h"
#include "relumine/in/material_report.h"
#include "relumine/in/mesh_files.h"
#include "relumine/in/mesh_remarks.h"
#include "relumine/in/place_report.h"
#include "relumine/in/places.h"
#include "relumine/out/pictures.h"

namespace relumine::app {

namespace {

using Model = mesh::MaterialModel;

const char* name_of(const mesh::Material& material) {
    switch (material.model) {
    case Model::Phong:
        return material.specular == glm::vec3(0.0f) ? "Lambert" : "Blinn-Phong";
    case Model::MetallicRoughness:
        return "metallic-roughness";
    case Model::SpecularGlossiness:
        return "specular-glossiness";
    case Model::Measured:
        return "measured";
    case Model::Unlit:
        break;
    }
    return "unlit";
}

/// The cells of a material, one for each heading.
class Row {
public:
    Row(const mesh::TriangleMesh& mesh, const mesh::Material& material)
        : mesh_(mesh), material_(material) {}

    static constexpr std::array<const char*, 14> Headings = {
        "material", "model",  "colour", "metallic", "roughness", "specular", "exponent",
        "emission", "normal", "ior",    "coat",     "sheen",     "film",     "anisotropy"};
    /// The first three are always shown.
    static constexpr std::size_t NumAlways = 3;

    [[nodiscard]] std::array<std::string, Headings.size()> cells() const {
        const mesh::Material& m = material_;
        const bool is_phong = m.model == Model::Phong, is_unlit = m.model == Model::Unlit;
        const bool is_metal = m.model == Model::MetallicRoughness;
        const mesh::Material usual;
        return {m.name,
                name_of(m),
                of(m.base_color, m.base_color_texture),
                is_metal ? of(m.metallic, m.metallic_texture ? m.metallic_texture
                                                             : m.metallic_roughness_texture)
                         : "",
                is_phong || is_unlit
                    ? ""
                    : of(m.roughness,
                         m.roughness_texture ? m.roughness_texture : m.metallic_roughness_texture),
                specular(),
                is_phong && m.specular != usual.specular ? fmt::format("{}", m.exponent) : "",
                m.emission != usual.emission ? of(m.emission, m.emission_texture) : "",
                m.normal_texture ? of(m.normal_scale, m.normal_texture) : "",
                m.ior != usual.ior || m.dispersion != usual.dispersion
                    ? fmt::format("{}{}", m.ior,
                                  m.dispersion != usual.dispersion
                                      ? fmt::format(", dispersion {}", m.dispersion)
                                      : "")
                    : "",
                m.coat != 0.0f
                    ? fmt::format("{}, roughness {}{}", of(m.coat, m.coat_texture),
                                  of(m.coat_roughness, m.coat_roughness_texture),
                                  m.coat_normal_texture
                                      ? ", normal " + of(m.coat_normal_scale, m.coat_normal_texture)
                                      : "")
                    : "",
                m.sheen != usual.sheen
                    ? fmt::format("{}, roughness {}", of(m.sheen, m.sheen_texture),
                                  of(m.sheen_roughness, m.sheen_roughness_texture))
                    : "",
                m.film != 0.0f ? film() : "",
                m.anisotropy != 0.0f
                    ? fmt::format("{}, turned by {}", of(m.anisotropy, m.anisotropy_texture),
                                  m.anisotropy_rotation)
                    : ""};
    }

private:
    using Slot = std::optional<mesh::TextureSlot>;

    [[nodiscard]] std::string texture(const Slot& slot) const {
        if (!slot)
            return "";
        const mesh::Texture& image = mesh_.textures[slot->texture];
        return fmt::format(" x {} ({} x {})", image.name, image.width, image.height);
    }
    [[nodiscard]] std::string of(float value, const Slot& slot) const {
        return fmt::format("{}{}", value, texture(slot));
    }
    [[nodiscard]] std::string of(const glm::vec3& color, const Slot& slot) const {
        return fmt::format("{} {} {}{}", color.r, color.g, color.b, texture(slot));
    }
    [[nodiscard]] std::string film() const {
        const mesh::Material& m = material_;
        const std::string thickness =
            m.film_thickness_texture
                ? fmt::format("{} to {} nm{}", m.film_thickness_at_0, m.film_thickness_at_1,
                              texture(m.film_thickness_texture))
                : fmt::format("{} nm", m.film_thickness_at_1);
        return fmt::format("{}, {}, ior {}", of(m.film, m.film_texture), thickness, m.film_ior);
    }
    [[nodiscard]] std::string specular() const {
        const mesh::Material& m = material_;
        if (m.model == Model::SpecularGlossiness ||
            (m.model == Model::Phong && m.specular != glm::vec3(0.0f)))
            return of(m.specular, m.specular_texture);
        const bool is_usual = m.specular_strength == 1.0f && !m.specular_strength_texture &&
                              m.specular_tint == glm::vec3(1.0f) && !m.specular_tint_texture;
        if (m.model != Model::MetallicRoughness || is_usual)
            return "";
        return fmt::format("{}, tint {}", of(m.specular_strength, m.specular_strength_texture),
                           of(m.specular_tint, m.specular_tint_texture));
    }

    const mesh::TriangleMesh& mesh_;
    const mesh::Material& material_;
};

/// Returns a line of headings and one for each material; columns that no material needs are left
/// out. Empty without materials.
std::vector<std::string> material_table(const mesh::TriangleMesh& mesh) {
    using Cells = std::array<std::string, Row::Headings.size()>;
    if (mesh.materials.empty())
        return {};
    std::vector<Cells> rows(1);
    std::copy(Row::Headings.begin(), Row::Headings.end(), rows[0].begin());
    for (const mesh::Material& material : mesh.materials)
        rows.push_back(Row(mesh, material).cells());
    std::vector<std::string> lines(rows.size());
    for (std::size_t column = 0; column < Row::Headings.size(); ++column) {
        std::size_t width = 0;
        for (std::size_t row = 1; row < rows.size(); ++row)
            width = std::max(width, rows[row][column].size());
        if (width == 0 && column >= Row::NumAlways)
            continue;
        width = std::max(width, rows[0][column].size());
        for (std::size_t row = 0; row < rows.size(); ++row)
            lines[row] += fmt::format("{:<{}}  ", rows[row][column], width);
    }
    for (std::string& line : lines)
        line.erase(line.find_last_not_of(' ') + 1);
    return lines;
}

/// "12, the first of vertices 3 and 17 at (0, 1, 2)"
std::string text_of(const mesh::TriangleMesh& mesh, const std::vector<mesh::VertexPair>& edges) {
    if (edges.empty())
        return "0";
    const auto& [a, b] = edges.front();
    const glm::dvec3 middle = place_of(mesh, 0.5f * (mesh.positions[a] + mesh.positions[b]));
    const int digits = mesh.offset == glm::dvec3(0.0) ? 6 : 10;
    return fmt::format("{}, the first between vertices {} and {} at ({:.{}g}, {:.{}g}, {:.{}g})",
                       edges.size(), a, b, middle.x, digits, middle.y, digits, middle.z, digits);
}

std::string text_of(const char* what, const std::vector<std::uint32_t>& items) {
    return items.empty() ? "0"
                         : fmt::format("{}, the first is {} {}", items.size(), what, items.front());
}

/// What is odd about the mesh, for people and for --json.
Report diagnosis_report(const mesh::TriangleMesh& mesh, const mesh::Diagnosis& found,
                        const Session& session) {
    const auto say = [&](const char* name, const std::string& text) {
        session.say(fmt::format("{:20}{}", name, text));
    };
    say("surface",
        fmt::format("{}, {} {}", found.is_closed() ? "closed" : "open", found.num_components,
                    found.num_components == 1 ? "component" : "components"));
    if (!found.boundary_edges.empty())
        say("boundary edges",
            text_of(mesh, found.boundary_edges) +
                (found.num_seam_edges == 0
                     ? ""
                     : fmt::format("; {} of them lie on seams of vertices at one place",
                                   found.num_seam_edges)));
    if (!found.non_manifold_edges.empty())
        say("edges of 3 or more", text_of(mesh, found.non_manifold_edges));
    if (!found.repeated_sides.empty())
        say("wound alike", text_of(mesh, found.repeated_sides) + ": sides of two triangles");
    if (!found.wrongly_wound.empty())
        say("to be turned", text_of("triangle", found.wrongly_wound));
    if (found.num_one_sided > 0)
        say("one-sided",
            fmt::format("{} edges that no turning makes consistent", found.num_one_sided));
    if (!found.non_manifold_vertices.empty())
        say("vertices of fans", text_of("vertex", found.non_manifold_vertices));
    if (!found.isolated_vertices.empty())
        say("without a triangle", text_of("vertex", found.isolated_vertices));
    if (!found.zero_area.empty())
        say("without an area", text_of("triangle", found.zero_area));
    if (!found.duplicates.empty())
        say("twice", text_of("triangle", found.duplicates));
    say("normals, winding",
        found.against_normals.empty()
            ? "agree"
            : "against each other: " + text_of("triangle", found.against_normals));
    Report result = {{"closed", found.is_closed()},
                     {"components", found.num_components},
                     {"boundary_edges", found.boundary_edges.size()},
                     {"seam_edges", found.num_seam_edges},
                     {"non_manifold_edges", found.non_manifold_edges.size()},
                     {"repeated_sides", found.repeated_sides.size()},
                     {"wrongly_wound", found.wrongly_wound.size()},
                     {"one_sided_edges", found.num_one_sided},
                     {"non_manifold_vertices", found.non_manifold_vertices.size()},
                     {"isolated_vertices", found.isolated_vertices.size()},
                     {"zero_area", found.zero_area.size()},
                     {"duplicates", found.duplicates.size()},
                     {"against_normals", found.against_normals.size()}};
    if (!found.repeated_sides.empty())
        result.set("first_repeated_side", std::vector<Report>{found.repeated_sides.front()[0],
                                                              found.repeated_sides.front()[1]});
    return result;
}

} // namespace

void say_lamps(std::span<const std::string> names, const Session& session) {
    for (const std::string& name : names)
        session.say(fmt::format("lamp                {}", name.empty() ? "all that glows" : name));
}

void describe_mesh(const MeshInfoOptions& options, const Session& session) {
    if (!options.picture.empty()) {
        require_extension("--picture", options.picture, {".png"});
        check_output(options.picture, {options.path});
    }
    mesh::LoadedMesh mesh =
        mesh::load(options.path, {.pose = options.mesh.pose, .variant = options.mesh.variant});
    const mesh::Bounds box = mesh::bounds(mesh);
    const mesh::Diagnosis diagnosis = mesh::diagnose(mesh);
    if (!options.picture.empty())
        relight::save_mesh_picture(options.picture, mesh, diagnosis);
    session.say(fmt::format("mesh                {} vertices, {}", mesh.num_vertices(),
                            files::counted(mesh.num_triangles(), "triangle")));
    session.say(fmt::format("box                 ({}) to ({})", place_text(mesh, box.min),
                            place_text(mesh, box.max)));
    session.say(fmt::format("colours, uvs        {}, {}", mesh.colors.empty() ? "no" : "yes",
                            !mesh.uvs.empty()          ? "yes"
                            : !mesh.corner_uvs.empty() ? "per corner"
                                                       : "no"));
    for (const std::string& line : material_table(mesh))
        session.say(line);
    std::vector<Report> materials;
    for (const mesh::Material& material : mesh.materials)
        materials.push_back(report_of(mesh, material));
    for (const std::string& group : mesh.groups)
        session.say(fmt::format("group               {}", group));
    const std::vector<std::string> lamps = prt::lamps_of(mesh).names();
    say_lamps(lamps, session);
    for (const std::string& name : mesh.variants)
        session.say(fmt::format("variant             {}", name));
    const Report faults = diagnosis_report(mesh, diagnosis, session);
    Report report = {{"kind", "mesh"},
                     {"vertices", mesh.num_vertices()},
                     {"triangles", mesh.num_triangles()},
                     {"min", place_json(mesh, box.min)},
                     {"max", place_json(mesh, box.max)},
                     {"diagnosis", faults},
                     {"colors", !mesh.colors.empty()},
                     {"uvs", !mesh.uvs.empty() || !mesh.corner_uvs.empty()},
                     {"materials", materials},
                     {"groups", mesh.groups},
                     {"lamps", lamps},
                     {"variants", mesh.variants}};
    // What a first picture says.
    const MeshRemarks remarks = remarks_on(prepared(std::move(mesh), options.path, options.mesh));
    const auto say = [&](const char* name, const std::vector<std::string>& lines) {
        for (const std::string& line : lines)
            session.say(fmt::format("{:20}{}", name, line));
    };
    say("not found", remarks.missing);
    say("read", remarks.notes);
    say("left out", remarks.left_out);
    say("suspect", remarks.doubts);
    files::update(report, {{"missing", remarks.missing},
                           {"notes", remarks.notes},
                           {"left_out", remarks.left_out},
                           {"suspect", remarks.doubts}});
    session.report(report);
}

} // namespace relumine::app
