#include "prt/scene/section_group.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "mesh/materials/brdf_table.h"
#include "prt/glossy/lobe_list.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/precompute.h"
#include "prt/receivers/pixel_receivers.h"
#include "prt/receivers/point_receivers.h"
#include "prt/receivers/texel_receivers.h"
#include "prt/scene/scene_file.h"
#include "prt/visibility/ray_scene.h"
#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"
#include "tests/prt/made_sections.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

void precompute(Scene& scene) {
    scene.settings = {.tolerance = 0.1f, .min_level = 1, .face_resolution = 8, .bias = 1e-3f};
    scene.transfer =
        prt::precompute(scene.receivers, RayScene(scene.mesh),
                        {.tolerance = 0.1f, .min_level = 1, .face_resolution = 8, .bias = 1e-3f});
}

Scene pixel_scene(const mesh::Material& material = {},
                  std::optional<std::uint32_t> samples_per_axis = 3) {
    Scene scene;
    scene.mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    scene.mesh.materials = {material};
    scene.mesh.triangle_materials.assign(scene.mesh.num_triangles(), 0);
    PixelReceivers pixels = pixel_receivers(
        scene.mesh, RayScene(scene.mesh),
        {.camera = {.eye = {3.1f, 2.2f, 4.3f}, .fov_degrees = 33.3f, .roll_degrees = 7.5f},
         .width = 11,
         .height = 7,
         .samples_per_axis = samples_per_axis});
    scene.receivers = std::move(pixels.receivers);
    scene.layout = std::move(pixels.layout);
    precompute(scene);
    return scene;
}

Scene texel_scene() {
    Scene scene;
    scene.mesh = scenes::floor_grid(3, 2.0f);
    for (const glm::vec3& p : scene.mesh.positions)
        scene.mesh.uvs.emplace_back(0.3f * p.x + 0.5f, 0.4f * p.z + 0.5f);
    TexelReceivers texels = texel_receivers(scene.mesh, {.width = 9, .height = 5});
    scene.receivers = std::move(texels.receivers);
    scene.layout = std::move(texels.layout);
    precompute(scene);
    return scene;
}

Scene point_scene() {
    Scene scene;
    scene.mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    const std::vector<glm::vec3> points = {{0, 0, 0}, {0, 2, 0}, {3, 0, 0.5f}};
    scene.receivers = point_receivers(points, scene.mesh, RayScene(scene.mesh));
    scene.layout = PointLayout{.count = 3, .indices = {0, 1, 2}};
    precompute(scene);
    return scene;
}

Scene grid_scene() {
    Scene scene;
    scene.mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    GridLayout grid{.nx = 2, .ny = 1, .nz = 3, .low = {2, 2, 2}, .high = {3, 3, 3}};
    grid.indices = {0, 1, 2, 3, 4, 5};
    scene.receivers = point_receivers(grid_points(grid), scene.mesh, RayScene(scene.mesh));
    scene.layout = std::move(grid);
    precompute(scene);
    return scene;
}

void add_surfaces(Scene& scene) {
    for (std::size_t i = 0; i < scene.receivers.size(); ++i)
        scene.receivers.surfaces.push_back({.albedo = glm::vec3(0.001f * static_cast<float>(i)),
                                            .specular = {0.1f, 0.2f, 0.3f},
                                            .highlight = static_cast<Highlight>(i % 3),
                                            .roughness_or_exponent = 0.5f});
}

void expect_same(const Receivers& a, const Receivers& b) {
    EXPECT_EQ(a.positions, b.positions);
    EXPECT_EQ(a.normals, b.normals);
    EXPECT_EQ(a.to_eye, b.to_eye);
    EXPECT_EQ(a.surfaces, b.surfaces);
    EXPECT_EQ(a.points, b.points);
    EXPECT_EQ(a.veils, b.veils);
    EXPECT_EQ(a.own_positions, b.own_positions);
    EXPECT_EQ(a.have_no_surface, b.have_no_surface);
}

class ReceiverSectionsTest : public tests::FolderTest {
protected:
    void expect_round_trip(const Scene& scene) const {
        save_scene(file_, scene);
        const Scene loaded = load_scene(file_);
        EXPECT_EQ(loaded.layout, scene.layout);
        expect_same(loaded.receivers, scene.receivers);
        EXPECT_EQ(loaded.transfer.order, scene.transfer.order);
        EXPECT_EQ(loaded.transfer.normals, scene.transfer.normals);
        EXPECT_EQ(loaded.transfer.counts.visible, scene.transfer.counts.visible);
        EXPECT_EQ(loaded.mesh.positions, scene.mesh.positions);
    }

    void refused(const Sections& good, const std::string& reason,
                 const std::function<void(Sections&)>& forge) const {
        Sections sections = good;
        forge(sections);
        write_sections(file_, to_write(sections));
        scenes::expect_refused(file_, reason, [&] { static_cast<void>(load_scene(file_)); });
    }
    /// One element of a section replaced.
    template<typename Element>
    void refused(const Sections& good, const std::string& name, std::size_t index,
                 const Element& element) const {
        refused(good, "'" + name + "'", [&](Sections& sections) {
            std::memcpy(sections.at(name).data() + index * sizeof(Element), &element,
                        sizeof(Element));
        });
    }

    fs::path file_ = folder_ / "scene.prt";
};

TEST_F(ReceiverSectionsTest, PixelsComeBack) {
    Scene scene = pixel_scene();
    ASSERT_NE(std::get<PixelLayout>(scene.layout).num_samples() % 8, 0u); // not all is whole bytes
    expect_round_trip(scene);
    add_surfaces(scene);
    expect_round_trip(scene);
}

TEST_F(ReceiverSectionsTest, PixelsThatSeeThroughSurfacesComeBack) {
    const Scene scene = pixel_scene({.alpha_mode = mesh::AlphaMode::Blend, .alpha = 0.25f});
    ASSERT_EQ(scene.receivers.veils.size(), scene.receivers.size());
    expect_round_trip(scene);
    const Sections good = read_sections(file_);
    refused(good, "layout_layers", 0, std::uint8_t{0});
    refused(good, "layout_layers", 0, std::uint8_t{200});
    refused(good, "r_veils", 2, 1.5f);
    refused(good, "r_veils", 0, std::numeric_limits<float>::quiet_NaN());
}

TEST_F(ReceiverSectionsTest, PixelsThatShareSamplesComeBack) {
    for (const mesh::AlphaMode mode : {mesh::AlphaMode::Opaque, mesh::AlphaMode::Blend}) {
        const Scene scene = pixel_scene({.alpha_mode = mode, .alpha = 0.25f}, std::nullopt);
        const std::vector<std::uint16_t>& shares = std::get<PixelLayout>(scene.layout).shares;
        ASSERT_EQ(shares.size(), scene.receivers.size());
        expect_round_trip(scene);
        const Sections good = read_sections(file_);
        const auto partial = static_cast<std::size_t>(
            std::find_if(shares.begin(), shares.end(), [](auto share) { return share != 0xffff; }) -
            shares.begin());
        ASSERT_LT(partial, shares.size());
        refused(good, "layout_shares", partial, std::uint16_t{0});
        refused(good, "layout_shares", partial, static_cast<std::uint16_t>(shares[partial] << 1));
        refused(good, "'layout_shares'",
                [](Sections& sections) { sections.at("layout_shares").pop_back(); });
    }
    Scene scene = pixel_scene({}, std::nullopt);
    std::vector<std::uint16_t>& shares = std::get<PixelLayout>(scene.layout).shares;
    for (std::size_t i = 0; i + 1 < shares.size(); ++i)
        if (shares[i] != 0xffff) // samples of the pixel's other receivers
            shares[i] = static_cast<std::uint16_t>(0xffffu & ~((shares[i] & -shares[i]) - 1u));
    EXPECT_THROW(save_scene(file_, scene), std::invalid_argument);
}

TEST_F(ReceiverSectionsTest, TablesOfBrdfsComeBack) {
    Scene scene = pixel_scene();
    add_surfaces(scene);
    const std::array<std::shared_ptr<const mesh::BrdfTable>, 2> tables = {
        mesh::brdf_of([](const auto&) { return glm::vec3(0.1f); }),
        mesh::brdf_of([](const auto& at) {
            return glm::vec3(0.1f + 0.1f * at.to_light.z * at.to_eye.z, 0.1f, 0.2f);
        })};
    for (std::size_t i = 0; i < 4; ++i)
        scene.receivers.surfaces[i] = measured_surface(tables[i % 2]);
    save_scene(file_, scene);
    const Scene loaded = load_scene(file_);
    ASSERT_EQ(loaded.brdfs.size(), 2u);
    for (std::size_t i = 0; i < 4; ++i) {
        const Surface& surface = loaded.receivers.surfaces[i];
        ASSERT_EQ(surface.table, loaded.brdfs[i % 2]);
        EXPECT_EQ(surface.albedo, scene.receivers.surfaces[i].albedo);
        const std::vector<float> values = surface.table->values(), own = tables[i % 2]->values();
        for (std::size_t k = 0; k < values.size(); k += 991)
            EXPECT_NEAR(values[k], own[k], 1e-6f);
    }
    EXPECT_EQ(loaded.receivers.surfaces[4].table, nullptr);
    const Sections good = read_sections(file_);
    refused(good, "r_brdf", 1, std::uint32_t{3});
    refused(good, "a table of each measured BRDF", [](Sections& s) { s.erase("r_brdf"); });
    refused(good, "brdf_tables", 7, -1.0f);
    refused(good, "brdf_tables", [](Sections& s) { s.at("brdf_tables").resize(400); });
}

TEST_F(ReceiverSectionsTest, TexelsComeBack) {
    Scene scene = texel_scene();
    expect_round_trip(scene);
    add_surfaces(scene);
    expect_round_trip(scene);
}

TEST_F(ReceiverSectionsTest, PointsAndGridsComeBack) {
    const Scene points = point_scene();
    ASSERT_TRUE(points.receivers.is_inside(0));
    expect_round_trip(points);
    EXPECT_GT(load_scene(file_).transfer.num_points, 0u);
    expect_round_trip(grid_scene());
}

TEST_F(ReceiverSectionsTest, PointsThatDoNotFitAreRefused) {
    save_scene(file_, point_scene());
    const Sections good = read_sections(file_);
    const float none = std::numeric_limits<float>::quiet_NaN();
    refused(good, "finite coordinates of points", [&](Sections& sections) {
        std::memcpy(sections.at("r_own_positions").data(), &none, sizeof none);
    });
    refused(good, "'r_own_positions'",
            [](Sections& sections) { sections.at("r_own_positions").resize(12); });
    refused(good, "'r_positions'",
            [](Sections& sections) { sections.at("r_positions").resize(24); });
}

TEST_F(ReceiverSectionsTest, PlainVerticesAddNothing) {
    Scene scene;
    scene.mesh = scenes::box(glm::vec3(-1.0f), glm::vec3(1.0f));
    scene.receivers = vertex_receivers(scene.mesh);
    precompute(scene);
    save_scene(file_, scene);
    std::vector<std::string> names;
    for (const auto& [name, bytes] : read_sections(file_))
        names.push_back(name);
    EXPECT_EQ(names, (std::vector<std::string>{"count_codes", "counts_14", "mixed", "normals",
                                               "order", "positions", "quadtree", "settings",
                                               "triangles", "visible"}));
    const Scene loaded = load_scene(file_);
    EXPECT_EQ(loaded.layout, ReceiverLayout(VertexLayout{}));
    expect_same(loaded.receivers, scene.receivers);
    // Surfaces and an eye are kept for vertices, too.
    add_surfaces(scene);
    scene.receivers.to_eye.assign(scene.receivers.size(), glm::vec3(0, 1, 0));
    expect_round_trip(scene);
}

TEST_F(ReceiverSectionsTest, TheSameSceneGivesTheSameBytes) {
    Scene scene = pixel_scene();
    add_surfaces(scene);
    NewSections first, second;
    ReceiverSections.add(first, scene);
    ReceiverSections.add(second, scene);
    EXPECT_EQ(scenes::made(first), scenes::made(second));
}

TEST_F(ReceiverSectionsTest, RefusesToSaveWhatDoesNotBelongTogether) {
    const auto refused_by = [&](const std::function<void(Scene&)>& change) {
        Scene scene = pixel_scene();
        change(scene);
        EXPECT_THROW(save_scene(file_, scene), std::invalid_argument);
        EXPECT_FALSE(fs::exists(file_));
    };
    refused_by([](Scene& s) { s.receivers.points.pop_back(); });
    refused_by([](Scene& s) { s.receivers.normals.pop_back(); });
    refused_by([](Scene& s) { s.receivers.to_eye.pop_back(); });
    refused_by([](Scene& s) { s.receivers.surfaces.resize(1); });
    refused_by([](Scene& s) { std::get<PixelLayout>(s.layout).samples.pop_back(); });
    refused_by([](Scene& s) { std::get<PixelLayout>(s.layout).samples.back() = 11 * 7 * 9; });
    refused_by([](Scene& s) {
        std::swap(std::get<PixelLayout>(s.layout).samples[0],
                  std::get<PixelLayout>(s.layout).samples[1]);
    });
    refused_by([](Scene& s) { s.layout = VertexLayout{}; });
    refused_by([](Scene& s) { s.transfer.order.pop_back(); });
}

TEST_F(ReceiverSectionsTest, MissingAndShortSections) {
    Scene scene = pixel_scene();
    add_surfaces(scene);
    save_scene(file_, scene);
    const Sections good = read_sections(file_);
    for (const char* name : {"layout_mask", "r_positions", "r_normals", "r_triangles",
                             "r_barycentric", "r_specular", "r_highlight", "r_shape"})
        refused(good, std::string("expected a section '") + name + "', got none",
                [&](Sections& s) { s.erase(name); });
    for (const char* name : {"layout_mask", "r_positions", "r_normals", "r_to_eye", "r_triangles",
                             "r_barycentric", "r_albedo", "r_specular", "r_highlight", "r_shape"}) {
        const std::string quoted = std::string("'") + name + "'";
        refused(good, quoted, [&](Sections& s) { s.at(name).pop_back(); });
        refused(good, quoted, [&](Sections& s) { s.at(name).clear(); });
        refused(good, quoted, [&](Sections& s) { s.at(name).resize(s.at(name).size() + 48); });
    }
    // Those that most scenes do not have.
    EXPECT_FALSE(good.contains("r_metallic"));
    EXPECT_FALSE(good.contains("r_emission"));
    scene.receivers.surfaces[2].metallic = 0.5f;
    scene.receivers.surfaces[3].emission = glm::vec3(7.0f, 0.0f, 1.0f);
    Surface& layered = scene.receivers.surfaces[4];
    layered.dielectric_f0 = 0.25f;
    layered.dielectric_f90 = 0.5f;
    layered.coat = 0.75f;
    layered.coat_roughness = 0.125f;
    layered.coat_normal = {0.0f, 0.0f, 1.0f};
    layered.sheen = {1.0f, 0.5f, 0.0f};
    layered.sheen_roughness = 0.25f;
    layered.film = 0.5f;
    layered.film_ior = 1.75f;
    layered.film_thickness = 250.0f;
    layered.anisotropy = 0.75f;
    layered.tangent = {0.0f, 1.0f, 0.0f};
    save_scene(file_, scene);
    EXPECT_EQ(load_scene(file_).receivers.surfaces, scene.receivers.surfaces);
    const Sections unusual = read_sections(file_);
    for (const char* name : {"r_metallic", "r_emission", "r_f0", "r_f90", "r_coat", "r_coat_rough",
                             "r_coat_normal", "r_sheen", "r_sheen_rough", "r_film", "r_film_ior",
                             "r_film_thick", "r_stretch", "r_tangent"})
        refused(unusual, std::string("'") + name + "'",
                [&](Sections& s) { s.at(name).pop_back(); });
    refused(unusual, "metallic 0 to 1",
            [](Sections& s) { s.at("r_metallic")[3] = std::byte{0x7f}; });
    refused(unusual, "films of an index of 1 to 1e6",
            [](Sections& s) { s.at("r_film_ior")[3] = std::byte{0xbf}; });
    refused(unusual, "tangents of length 1 or 0",
            [](Sections& s) { s.at("r_tangent")[3] = std::byte{0x40}; });
    refused(unusual, "emission 0 to 1e9",
            [](Sections& s) { s.at("r_emission")[3] = std::byte{0xbf}; });
    // As if they were the vertices.
    refused(good, "'r_to_eye'", [](Sections& s) { s.erase("layout"); });
    refused(good, "", [](Sections& s) {
        s.erase("layout");
        s.erase("r_to_eye");
        s.erase("r_albedo");
    });
}

TEST_F(ReceiverSectionsTest, NumbersOutOfRange) {
    Scene scene = pixel_scene();
    add_surfaces(scene);
    save_scene(file_, scene);
    const Sections good = read_sections(file_);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const std::vector<std::pair<const char*, const char*>> floats = {
        {"r_positions", "coordinates"},           {"r_normals", "normals of length 1 or 0"},
        {"r_to_eye", "to the eye of length 1"},   {"r_albedo", "albedo 0 to 1"},
        {"r_specular", "specular colour 0 to 1"}, {"r_shape", "exponent of 0 to 1000000"},
        {"r_barycentric", "'r_barycentric'"}};
    for (const auto& [name, reason] : floats)
        for (const float value : {nan, std::numeric_limits<float>::infinity(), 3e38f, -1e20f})
            refused(good, reason, [&, n = name](Sections& sections) {
                std::memcpy(sections.at(n).data() + 5 * sizeof value, &value, sizeof value);
            });
    refused(good, "r_barycentric", 3, -0.1f);
    refused(good, "r_barycentric", 3, 1.5f);
    refused(good, "r_triangles", 3, static_cast<std::uint32_t>(scene.mesh.num_triangles()));
    refused(good, "r_highlight", 3, std::uint8_t{NumHighlights});
    // A sample more than there are receivers, and bits behind the last sample.
    refused(good, "'r_positions'", [](Sections& s) {
        for (std::byte& byte : s.at("layout_mask"))
            if (byte != std::byte{0xff}) {
                byte = std::byte{0xff};
                break;
            }
    });
    refused(good, "layout_mask", good.at("layout_mask").size() - 1, std::byte{0xff});
}

TEST_F(ReceiverSectionsTest, LayoutsThatAreNone) {
    save_scene(file_, pixel_scene());
    const Sections good = read_sections(file_);
    const auto layout = [&](const std::string& text, const std::string& reason = "'layout'") {
        refused(good, reason, [&](Sections& s) {
            s.at("layout") = bytes_of(std::vector<char>(text.begin(), text.end()));
        });
    };
    const auto pixels = [](const std::string& changed, const std::string& value) {
        std::string text = "{\"kind\": \"pixels\"";
        for (const auto& [name, content] :
             std::vector<std::pair<std::string, std::string>>{{"width", "11"},
                                                              {"height", "7"},
                                                              {"samples_per_axis", "3"},
                                                              {"eye", "[3, 2, 4]"},
                                                              {"target", "[0, 0, 0]"},
                                                              {"fov_degrees", "33"}})
            text += ", \"" + name + "\": " + (name == changed ? value : content);
        return text + "}";
    };
    for (const char* text :
         {"", "{}", "[]", "7", "null", "{\"kind\": 3}", "{\"kind\": \"vertices\"}",
          "{\"kind\": \"texels\"}", "{\"kind\": \"texels\", \"width\": 0, \"height\": 4}",
          "{\"kind\": \"texels\", \"width\": 4294967296, \"height\": 4}"})
        layout(text);
    for (const char* name : {"width", "height", "samples_per_axis"})
        for (const char* value : {"0", "-1", "1.5", "4000000000", "\"7\"", "null"})
            layout(pixels(name, value));
    layout(pixels("width", "12"), "'layout_mask'");
    layout(pixels("samples_per_axis", "4"), "'layout_mask'");
    layout("{\"kind\": \"texels\", \"width\": 16384, \"height\": 16384}", "'layout_mask'");
    for (const char* value : {"[0, 0, 0]", "[1, 2]", "7", "[1, 2, \"3\"]", "[1e300, 0, 0]", "null"})
        layout(pixels("eye", value));
    for (const char* value : {"0", "180", "-5", "null", "1e300"})
        layout(pixels("fov_degrees", value));
}

} // namespace
} // namespace relumine::prt
