#include "prt/scene/receiver_sections.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "prt/scene/bounce_sections.h"

namespace relumine::prt {

namespace {

glm::vec3 vector(const files::Json& json) {
    if (json.values().size() != 3)
        throw std::out_of_range("expected three numbers");
    return {real(json.values().at(0)), real(json.values().at(1)), real(json.values().at(2))};
}

files::Json json_of(const PixelLayout& layout) {
    return {{"kind", "pixels"},
            {"width", layout.width},
            {"height", layout.height},
            {"samples_per_axis", layout.samples_per_axis},
            {"eye", layout.camera.eye},
            {"target", layout.camera.target},
            {"fov_degrees", layout.camera.fov_degrees}};
}

files::Json json_of(const TexelLayout& layout) {
    return {{"kind", "texels"}, {"width", layout.width}, {"height", layout.height}};
}

/// Returns the bits of the places that have a receiver.
std::vector<std::byte> mask(const std::vector<std::uint32_t>& places, std::size_t num_places) {
    std::vector<bool> bits(num_places);
    for (const std::uint32_t place : places)
        bits[place] = true;
    return packed(bits);
}

std::size_t num_places(const PixelLayout& layout) {
    return layout.num_samples();
}
std::size_t num_places(const TexelLayout& layout) {
    return layout.num_texels();
}
const std::vector<std::uint32_t>& places(const PixelLayout& layout) {
    return layout.samples;
}
const std::vector<std::uint32_t>& places(const TexelLayout& layout) {
    return layout.texels;
}

template<typename Layout>
void check(const Layout& layout, const Receivers& receivers) {
    const std::vector<std::uint32_t>& own = places(layout);
    const bool ascending =
        std::adjacent_find(own.begin(), own.end(), std::greater_equal<>()) == own.end() &&
        (own.empty() || own.back() < num_places(layout));
    if (num_places(layout) > MaxLayoutPlaces || own.size() != receivers.num_own() || !ascending)
        throw std::invalid_argument(
            fmt::format("expected one place in the layout for each of {} receivers, got {} in {}",
                        receivers.num_own(), own.size(), num_places(layout)));
}

template<typename Layout>
void add_layout(NewSections& sections, const Layout& layout, const Receivers& receivers) {
    check(layout, receivers);
    if (receivers.normals.size() != receivers.size() || receivers.points.size() != receivers.size())
        throw std::invalid_argument(
            fmt::format("expected a normal and a point for each of {} receivers, got {} and {}",
                        receivers.size(), receivers.normals.size(), receivers.points.size()));
    const std::string text = json_of(layout).text(2);
    sections["layout"] = bytes_of(text);
    sections["layout_mask"] = mask(places(layout), num_places(layout));
    sections["r_positions"] = SectionContent::view(receivers.positions);
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
}

std::vector<Surface> read_surfaces(const SectionReader& reader, std::size_t count) {
    if (!reader.has("r_albedo"))
        return {};
    const std::vector<glm::vec3> albedo = reader.elements<glm::vec3>("r_albedo", count);
    const std::vector<glm::vec3> specular = reader.elements<glm::vec3>("r_specular", count);
    const auto highlight = reader.elements<std::uint8_t>("r_highlight", count);
    const auto shape = reader.elements<float>("r_shape", count);
    if (std::any_of(highlight.begin(), highlight.end(),
                    [](auto h) { return h > static_cast<std::uint8_t>(Highlight::BlinnPhong); }))
        reader.fail("r_highlight", "highlights of known shapes");
    std::vector<Surface> surfaces(count);
    for (std::size_t i = 0; i < count; ++i)
        surfaces[i] = {.albedo = albedo[i],
                       .specular = specular[i],
                       .highlight = static_cast<Highlight>(highlight[i]),
                       .roughness_or_exponent = shape[i]};
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

/// Returns a size, checked before anything is done with it.
std::uint32_t size_of(const files::Json& json) {
    const std::uint32_t size = natural(json);
    if (size < 1 || size > MaxPictureSize)
        throw std::out_of_range("expected a size of a picture");
    return size;
}

ReceiverLayout layout_of(const files::Json& json) {
    if (json.at("kind").string() == "texels") {
        TexelLayout layout{.width = size_of(json.at("width")),
                           .height = size_of(json.at("height"))};
        if (layout.num_texels() > MaxLayoutPlaces)
            throw std::out_of_range("expected fewer texels");
        return layout;
    }
    if (json.at("kind").string() != "pixels")
        throw std::out_of_range("expected pixels or texels");
    PixelLayout layout{.camera = {.eye = vector(json.at("eye")),
                                  .target = vector(json.at("target")),
                                  .fov_degrees = real(json.at("fov_degrees"))},
                       .width = size_of(json.at("width")),
                       .height = size_of(json.at("height")),
                       .samples_per_axis = natural(json.at("samples_per_axis"))};
    // Throws for a camera without a direction, and for sizes out of bounds.
    static_cast<void>(
        PictureRays(layout.camera, layout.width, layout.height, layout.samples_per_axis));
    if (layout.num_samples() > MaxLayoutPlaces)
        throw std::out_of_range("expected fewer samples");
    return layout;
}

template<typename Layout>
std::vector<std::uint32_t> read_places(const SectionReader& reader, const Layout& layout) {
    const std::vector<bool> bits = reader.bits("layout_mask", num_places(layout));
    std::vector<std::uint32_t> result;
    for (std::size_t i = 0; i < bits.size(); ++i)
        if (bits[i])
            result.push_back(static_cast<std::uint32_t>(i));
    return result;
}

} // namespace

void add_receiver_sections(NewSections& sections, const Receivers& receivers,
                           const ReceiverLayout& layout) {
    const auto fits = [&](std::size_t size) {
        return size == 0 || size == receivers.size();
    };
    if (!fits(receivers.to_eye.size()) || !fits(receivers.surfaces.size()))
        throw std::invalid_argument(
            fmt::format("expected none or {} directions to the eye and surfaces, got {} and {}",
                        receivers.size(), receivers.to_eye.size(), receivers.surfaces.size()));
    if (const auto* pixels = std::get_if<PixelLayout>(&layout))
        add_layout(sections, *pixels, receivers);
    else if (const auto* texels = std::get_if<TexelLayout>(&layout))
        add_layout(sections, *texels, receivers);
    if (!receivers.to_eye.empty())
        sections["r_to_eye"] = SectionContent::view(receivers.to_eye);
    if (!receivers.surfaces.empty())
        add_surfaces(sections, receivers.surfaces);
}

ReceiverLayout read_layout(const SectionReader& reader) {
    if (!reader.has("layout"))
        return VertexLayout{};
    const files::Json json = reader.json("layout");
    ReceiverLayout layout;
    try {
        layout = layout_of(json);
    } catch (const std::exception&) {
        reader.fail("layout", "JSON with the layout of the receivers");
    }
    if (auto* pixels = std::get_if<PixelLayout>(&layout))
        pixels->samples = read_places(reader, *pixels);
    else if (auto* texels = std::get_if<TexelLayout>(&layout))
        texels->texels = read_places(reader, *texels);
    return layout;
}

Receivers read_receivers(const SectionReader& reader, const ReceiverLayout& layout,
                         const mesh::TriangleMesh& mesh) {
    Receivers receivers;
    if (std::holds_alternative<VertexLayout>(layout)) {
        receivers = vertex_receivers(mesh);
    } else {
        const auto* pixels = std::get_if<PixelLayout>(&layout);
        const std::size_t num_own = pixels != nullptr ? pixels->samples.size()
                                                      : std::get<TexelLayout>(layout).texels.size();
        receivers.positions = reader.elements<glm::vec3>("r_positions");
        const std::size_t count = receivers.size();
        // A plan has no bounces yet.
        const bool may_bounce = has_bounces(reader) || reader.has("plan");
        const std::size_t most_added = may_bounce ? mesh.num_vertices() : 0;
        if (count < num_own || count - num_own > most_added)
            reader.fail("r_positions",
                        "the layout's receivers, and no more vertices than there are");
        receivers.num_added = count - num_own;
        receivers.normals = reader.elements<glm::vec3>("r_normals", count);
        receivers.points = read_points(reader, count, mesh);
    }
    receivers.to_eye = reader.elements<glm::vec3>("r_to_eye", receivers.size(), true);
    receivers.surfaces = read_surfaces(reader, receivers.size());
    return receivers;
}

} // namespace relumine::prt
