#include <algorithm>
#include <stdexcept>
#include <type_traits>

#include <fmt/format.h>

#include "files/one_of_each.h"
#include "prt/glossy/lobe_list.h"
#include "prt/scene/bounce_sections.h"
#include "prt/scene/brdf_tables.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_group.h"
#include "prt/visibility/ray_scene.h"

namespace relumine::prt {

namespace {

const std::string Layout = "layout", Mask = "layout_mask", Shares = "layout_shares";

void check_fit(const ReceiverLayout& layout, const Receivers& receivers) {
    const std::span<const std::uint32_t> own = places(layout);
    const bool ascending =
        (receivers.veils.empty()
             ? std::adjacent_find(own.begin(), own.end(), std::greater_equal<>()) == own.end()
             : std::is_sorted(own.begin(), own.end())) &&
        (own.empty() || own.back() < num_places(layout));
    if (num_places(layout) > MaxLayoutPlaces || own.size() != receivers.num_own() || !ascending)
        throw std::invalid_argument(
            fmt::format("expected one place in the layout for each of {} receivers, got {} in {}",
                        receivers.num_own(), own.size(), num_places(layout)));
    const auto* pixels = std::get_if<PixelLayout>(&layout);
    if (pixels != nullptr && !pixels->have_shares_that_fit())
        throw std::invalid_argument("expected samples of a pixel that belong to one receiver each");
    if (receivers.have_no_surface == kind_of(layout).have_surface ||
        (!receivers.own_positions.empty() && receivers.own_positions.size() != receivers.size()))
        throw std::invalid_argument(
            fmt::format("expected receivers {} a surface, and no or {} positions of points",
                        kind_of(layout).have_surface ? "on" : "without", receivers.size()));
    if (receivers.num_points() == receivers.size())
        return;
    if (receivers.normals.size() != receivers.size() || receivers.points.size() != receivers.size())
        throw std::invalid_argument(
            fmt::format("expected a normal and a point for each of {} receivers, got {} and {}",
                        receivers.size(), receivers.normals.size(), receivers.points.size()));
}

constexpr std::size_t NumbersOfVeil = 4;

/// Pixels whose samples see several surfaces, one through the other.
void add_veils(NewSections& sections, std::span<const std::uint32_t> samples,
               const std::vector<mesh::Veil>& veils) {
    std::vector<std::uint8_t> counts;
    std::vector<float> numbers;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (i == 0 || samples[i] != samples[i - 1])
            counts.push_back(0);
        ++counts.back();
        const mesh::Veil& veil = veils[i];
        numbers.insert(numbers.end(),
                       {veil.weight, veil.through.r, veil.through.g, veil.through.b});
    }
    sections["layout_layers"] = bytes_of(counts);
    sections["r_veils"] = bytes_of(numbers);
}

/// Reads them, and gives every sample its receivers.
std::vector<mesh::Veil> read_veils(const SectionReader& reader,
                                   std::vector<std::uint32_t>& samples) {
    const auto counts = reader.elements<std::uint8_t>("layout_layers", samples.size());
    std::vector<std::uint32_t> layers;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] == 0 || counts[i] > RayScene::MostLayers)
            reader.fail("layout_layers", fmt::format("1 to {} layers", RayScene::MostLayers));
        layers.insert(layers.end(), counts[i], samples[i]);
    }
    samples = std::move(layers);
    const auto numbers = reader.elements<float>("r_veils", NumbersOfVeil * samples.size());
    if (!std::all_of(numbers.begin(), numbers.end(),
                     [](float x) { return x >= 0.0f && x <= 1.0f; }))
        reader.fail("r_veils", "numbers of 0 to 1");
    std::vector<mesh::Veil> veils;
    for (std::size_t i = 0; i < numbers.size(); i += NumbersOfVeil)
        veils.push_back({numbers[i], {numbers[i + 1], numbers[i + 2], numbers[i + 3]}});
    return veils;
}

/// Adds the layout and the places of receivers that are not vertices.
void add_places(NewSections& sections, ReceiverLayout layout, const Receivers& receivers) {
    check_fit(layout, receivers);
    JsonMembers members;
    members.json.set("kind", kind_of(layout).name);
    std::visit([&](auto& own) { own.members(members); }, layout);
    sections[Layout] = bytes_of(members.json.text(2));
    std::vector<bool> bits(num_places(layout));
    for (const std::uint32_t place : places(layout))
        bits[place] = true;
    sections[Mask] = packed(bits);
    if (!receivers.veils.empty())
        add_veils(sections, places(layout), receivers.veils);
    if (const auto* pixels = std::get_if<PixelLayout>(&layout); pixels && !pixels->shares.empty())
        sections[Shares] = bytes_of(pixels->shares);
    sections["r_positions"] = SectionContent::view(receivers.positions);
    if (!receivers.own_positions.empty())
        sections["r_own_positions"] = SectionContent::view(receivers.own_positions);
    if (receivers.num_points() == receivers.size())
        return;
    sections["r_normals"] = SectionContent::view(receivers.normals);
    std::vector<std::uint32_t> triangles;
    std::vector<glm::vec2> barycentric;
    for (const MeshPoint& point : receivers.points) {
        triangles.push_back(point.triangle);
        barycentric.push_back(point.barycentric);
    }
    sections["r_triangles"] = bytes_of(triangles);
    sections["r_barycentric"] = bytes_of(barycentric);
}

/// Calls `use(section, member)` for what only files with such surfaces have.
template<class Use>
void for_each_unusual(const Use& use) {
    use("r_metallic", &Surface::metallic);
    use("r_emission", &Surface::emission);
    use("r_f0", &Surface::dielectric_f0);
    use("r_f90", &Surface::dielectric_f90);
    use("r_coat", &Surface::coat);
    use("r_coat_rough", &Surface::coat_roughness);
    use("r_coat_normal", &Surface::coat_normal);
    use("r_sheen", &Surface::sheen);
    use("r_sheen_rough", &Surface::sheen_roughness);
    use("r_film", &Surface::film);
    use("r_film_ior", &Surface::film_ior);
    use("r_film_thick", &Surface::film_thickness);
    use("r_stretch", &Surface::anisotropy);
    use("r_tangent", &Surface::tangent);
}

/// Stores field by field: a Surface in memory has padding.
void add_surfaces(NewSections& sections, const std::vector<Surface>& surfaces) {
    std::vector<glm::vec3> albedo, specular;
    std::vector<std::uint8_t> highlight;
    std::vector<float> shape;
    for (const Surface& surface : surfaces) {
        albedo.push_back(surface.albedo);
        specular.push_back(surface.specular);
        highlight.push_back(static_cast<std::uint8_t>(surface.highlight));
        shape.push_back(surface.roughness_or_exponent);
    }
    sections["r_albedo"] = bytes_of(albedo);
    sections["r_specular"] = bytes_of(specular);
    sections["r_highlight"] = bytes_of(highlight);
    sections["r_shape"] = bytes_of(shape);
    for_each_unusual([&](const char* name, auto member) {
        const auto usual = Surface().*member;
        if (std::all_of(surfaces.begin(), surfaces.end(),
                        [&](const Surface& surface) { return surface.*member == usual; }))
            return;
        std::vector<std::remove_const_t<decltype(usual)>> values;
        values.reserve(surfaces.size());
        for (const Surface& surface : surfaces)
            values.push_back(surface.*member);
        sections[name] = bytes_of(values);
    });
}

/// The numbers of the tables of measured surfaces, counted from 1; 0 for others.
void add_table_numbers(NewSections& sections, const Scene& scene) {
    const BrdfTables tables = brdf_tables(scene);
    std::vector<std::uint32_t> numbers;
    for (const Surface& surface : scene.receivers.surfaces)
        numbers.push_back(
            surface.table
                ? static_cast<std::uint32_t>(
                      std::find(tables.begin(), tables.end(), surface.table) - tables.begin()) +
                      1
                : 0);
    if (std::any_of(numbers.begin(), numbers.end(), [](auto number) { return number != 0; }))
        sections["r_brdf"] = bytes_of(numbers);
}

void read_table_numbers(const SectionReader& reader, const BrdfTables& tables,
                        std::vector<Surface>& surfaces) {
    const auto numbers = reader.elements<std::uint32_t>("r_brdf", surfaces.size(), true);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (numbers[i] > tables.size())
            reader.fail("r_brdf", "numbers of tables");
        if (numbers[i] != 0)
            surfaces[i].table = tables[numbers[i] - 1];
    }
}

std::vector<Surface> read_surfaces(const SectionReader& reader, std::size_t count) {
    if (!reader.has("r_albedo"))
        return {};
    const std::vector<glm::vec3> albedo = reader.elements<glm::vec3>("r_albedo", count);
    const std::vector<glm::vec3> specular = reader.elements<glm::vec3>("r_specular", count);
    const auto highlight = reader.elements<std::uint8_t>("r_highlight", count);
    const auto shape = reader.elements<float>("r_shape", count);
    if (std::any_of(highlight.begin(), highlight.end(), [](auto h) { return h >= NumHighlights; }))
        reader.fail("r_highlight", "highlights of known shapes");
    std::vector<Surface> surfaces(count);
    for (std::size_t i = 0; i < count; ++i)
        surfaces[i] = {.albedo = albedo[i],
                       .specular = specular[i],
                       .highlight = static_cast<Highlight>(highlight[i]),
                       .roughness_or_exponent = shape[i]};
    for_each_unusual([&](const char* name, auto member) {
        using Value = std::remove_cvref_t<decltype(Surface().*member)>;
        const std::vector<Value> values = reader.elements<Value>(name, count, true);
        for (std::size_t i = 0; i < values.size(); ++i)
            surfaces[i].*member = values[i];
    });
    return surfaces;
}

std::vector<MeshPoint> read_points(const SectionReader& reader, std::size_t count,
                                   const mesh::TriangleMesh& mesh) {
    const auto triangles = reader.elements<std::uint32_t>("r_triangles", count);
    const auto barycentric = reader.elements<glm::vec2>("r_barycentric", count);
    if (std::any_of(triangles.begin(), triangles.end(),
                    [&](auto t) { return t >= mesh.num_triangles(); }))
        reader.fail("r_triangles", "indices of triangles");
    // Allows for rounding of weights that end at an edge.
    constexpr float Slack = 1e-4f;
    if (!std::all_of(barycentric.begin(), barycentric.end(), [](const glm::vec2& b) {
            return b.x >= 0.0f && b.y >= 0.0f && b.x + b.y <= 1.0f + Slack;
        }))
        reader.fail("r_barycentric", "weights within a triangle");
    std::vector<MeshPoint> points(count);
    for (std::size_t i = 0; i < count; ++i)
        points[i] = {.triangle = triangles[i], .barycentric = barycentric[i]};
    return points;
}

ReceiverLayout layout_of(const files::Json& json) {
    for (ReceiverLayout& layout : files::one_of_each<ReceiverLayout>()) {
        if (on_vertices(layout) || kind_of(layout).name != json.at("kind").string())
            continue;
        JsonMembers members(json);
        std::visit([&](auto& own) { own.members(members); }, layout);
        check_size(layout);
        return layout;
    }
    throw std::out_of_range("expected a known kind");
}

void check_surfaces(const SceneCheck& check, const std::vector<Surface>& surfaces) {
    const auto is_color = [](const glm::vec3& color) {
        return is_within(color, 0.0f, 1.0f + RangeSlack);
    };
    check.all("surfaces of albedo 0 to 1", surfaces, is_color,
              [](const Surface& s) { return s.albedo; });
    check.all("surfaces of specular colour 0 to 1", surfaces, is_color,
              [](const Surface& s) { return s.specular; });
    check.all("surfaces of metallic 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.metallic); });
    check.all("surfaces of F0 and F90 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.dielectric_f0, s.dielectric_f90, 0.0f); });
    check.all("coats of 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.coat, s.coat_roughness, 0.0f); });
    check.all("normals of coats of length 1 or 0", surfaces, is_unit_or_zero,
              [](const Surface& s) { return s.coat_normal; });
    check.all("sheen of 0 to 1", surfaces, is_color, [](const Surface& s) { return s.sheen; });
    check.all("sheen of roughness 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.sheen_roughness); });
    check.all("films of 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.film); });
    check.all("anisotropy of 0 to 1", surfaces, is_color,
              [](const Surface& s) { return glm::vec3(s.anisotropy); });
    check.all("tangents of length 1 or 0", surfaces, is_unit_or_zero,
              [](const Surface& s) { return s.tangent; });
    check.all(
        "films of an index of 1 to 1e6", surfaces,
        [](float ior) { return ior >= 1.0f && ior <= 1e6f; },
        [](const Surface& s) { return s.film_ior; });
    check.all(
        "films of a finite thickness, 0 or more", surfaces,
        [](float thickness) { return thickness >= 0.0f && std::isfinite(thickness); },
        [](const Surface& s) { return s.film_thickness; });
    check.all(
        "surfaces of emission 0 to 1e9", surfaces,
        [](const glm::vec3& color) { return is_within(color, 0.0f, 1e9f); },
        [](const Surface& s) { return s.emission; });
    for (std::size_t i = 0; i < surfaces.size(); ++i) {
        const LobeFacts& lobe = facts_of(surfaces[i].highlight);
        check.that(!lobe.is_table || surfaces[i].table != nullptr, "a table of each measured BRDF",
                   fmt::format("element {} without", i));
        const float shape = surfaces[i].roughness_or_exponent;
        if (!(shape >= 0.0f && shape <= lobe.largest_shape + RangeSlack))
            check.fail(fmt::format("{} of 0 to {}", lobe.shape.empty() ? "roughness" : lobe.shape,
                                   lobe.largest_shape),
                       fmt::format("element {}: {}", i, shape));
    }
}

void check_receivers(const SceneCheck& check, const Scene& scene) {
    const Receivers& receivers = scene.receivers;
    check.all("finite coordinates", receivers.positions, is_finite);
    check.all("finite coordinates of points", receivers.own_positions, is_finite);
    for (std::size_t i = 0; i < receivers.size(); ++i)
        if ((i < receivers.num_points() || receivers.normals[i] != glm::vec3(0.0f)) &&
            !can_start_rays(scene, receivers.positions[i]))
            check.fail(expected_place(scene), SceneCheck::text_of(receivers.positions[i]));
    if (const Camera* camera = own_camera(scene.layout))
        check_camera(check, scene, *camera);
    check.all("receivers' normals of length 1 or 0", receivers.normals, is_unit_or_zero);
    check.all("directions to the eye of length 1", receivers.to_eye, is_unit);
    check_surfaces(check, receivers.surfaces);
}

/// What the mesh alone does not tell. Plain vertices add nothing.
void add_receivers(NewSections& sections, const Scene& scene) {
    const Receivers& receivers = scene.receivers;
    const auto fits = [&](std::size_t size) {
        return size == 0 || size == receivers.size();
    };
    if (!fits(receivers.to_eye.size()) || !fits(receivers.surfaces.size()))
        throw std::invalid_argument(
            fmt::format("expected none or {} directions to the eye and surfaces, got {} and {}",
                        receivers.size(), receivers.to_eye.size(), receivers.surfaces.size()));
    if (!on_vertices(scene.layout))
        add_places(sections, scene.layout, receivers);
    if (!receivers.to_eye.empty())
        sections["r_to_eye"] = SectionContent::view(receivers.to_eye);
    if (!receivers.surfaces.empty())
        add_surfaces(sections, receivers.surfaces);
    add_table_numbers(sections, scene);
}

void read_points_in_space(const SectionReader& reader, Receivers& receivers) {
    receivers.have_no_surface = true;
    receivers.own_positions = reader.elements<glm::vec3>("r_own_positions", receivers.size(), true);
    if (receivers.num_added == 0)
        receivers.normals.resize(receivers.size(), glm::vec3(0.0f));
}

/// A file without a layout has vertices.
ReceiverLayout read_layout(const SectionReader& reader) {
    ReceiverLayout layout;
    if (!reader.has(Layout))
        return layout;
    const files::Json json = reader.json(Layout);
    try {
        layout = layout_of(json);
    } catch (const std::exception&) {
        reader.fail(Layout, "JSON with the layout of the receivers");
    }
    std::vector<std::uint32_t>& own = *std::visit([](auto& kind) { return kind.places(); }, layout);
    const std::vector<bool> bits = reader.bits(Mask, num_places(layout));
    for (std::size_t i = 0; i < bits.size(); ++i)
        if (bits[i])
            own.push_back(static_cast<std::uint32_t>(i));
    return layout;
}

void read_receivers(const SectionReader& reader, Scene& scene) {
    const mesh::TriangleMesh& mesh = scene.mesh;
    scene.layout = read_layout(reader);
    Receivers& receivers = scene.receivers;
    if (on_vertices(scene.layout)) {
        receivers = scene.settings.rim_step ? vertex_receivers(mesh, *scene.settings.rim_step)
                                            : vertex_receivers(mesh);
    } else {
        if (auto* pixels = std::get_if<PixelLayout>(&scene.layout); pixels && reader.has("r_veils"))
            receivers.veils = read_veils(reader, pixels->samples);
        const std::size_t num_own = places(scene.layout).size();
        if (auto* pixels = std::get_if<PixelLayout>(&scene.layout); pixels && reader.has(Shares)) {
            pixels->shares = reader.elements<std::uint16_t>(Shares, num_own);
            if (!pixels->have_shares_that_fit())
                reader.fail(Shares, "samples of a pixel that belong to one receiver each");
        }
        receivers.positions = reader.elements<glm::vec3>("r_positions");
        const std::size_t count = receivers.size();
        // A plan has no bounces yet.
        const bool may_bounce = has_bounces(reader) || reader.has("plan");
        const std::size_t most_added = may_bounce ? mesh.num_vertices() : 0;
        if (count < num_own || count - num_own > most_added)
            reader.fail("r_positions",
                        "the layout's receivers, and no more vertices than there are");
        receivers.num_added = count - num_own;
        if (!kind_of(scene.layout).have_surface)
            read_points_in_space(reader, receivers);
        if (receivers.num_points() == count)
            return;
        receivers.normals = reader.elements<glm::vec3>("r_normals", count);
        receivers.points = read_points(reader, count, mesh);
        for (std::size_t i = 0; i < receivers.num_points(); ++i)
            if (receivers.normals[i] != glm::vec3(0.0f))
                reader.fail("r_normals", "no normals of points in space");
    }
    receivers.to_eye = reader.elements<glm::vec3>("r_to_eye", receivers.size(), true);
    receivers.surfaces = read_surfaces(reader, receivers.size());
    if (on_vertices(scene.layout))
        leave_unlit_out(receivers);
    read_table_numbers(reader, scene.brdfs, receivers.surfaces);
}

} // namespace

const SectionGroup ReceiverSections = {
    .add = add_receivers, .read = read_receivers, .check = check_receivers};

} // namespace relumine::prt
