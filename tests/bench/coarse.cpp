// What the first picture of coarse meshes is worth: its vertices, refined by themselves, against
// receivers in every pixel of the same view. See docs/meshes.md.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "data_gen/environments.h"
#include "files/pixel_values.h"
#include "mesh/normals.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/receivers/pixel_receivers.h"
#include "relight/pictures/picture.h"
#include "relumine/relumine.h"
#include "tests/bench/program.h"
#include "tests/real_data.h"

using namespace relumine;

namespace {

namespace fs = std::filesystem;
using Point = glm::dvec3;

struct Settings {
    fs::path data = real_data_folder(), pictures, references;
    std::vector<std::string> files;
    std::string only;
    std::uint32_t width = 320, height = 240;
    std::optional<float> tolerance = {}, bounce_tolerance = {};
    /// The floor gets more vertices, too.
    bool refined_floor = true;
    bool direct = false, generated = false;
};

/// A few boxes and stumps of cones in one mesh, as modellers put them together.
class Parts {
public:
    Parts& box(const Point& min, const Point& max) {
        return hull(4, [&](std::uint32_t k) {
            const bool right = k == 1 || k == 2, front = k >= 2;
            return std::array{Point(right ? max.x : min.x, min.y, front ? max.z : min.z),
                              Point(right ? max.x : min.x, max.y, front ? max.z : min.z)};
        });
    }
    /// Upright, with `n` sides; a cone where it has no radius above.
    Parts& stump(std::uint32_t n, const Point& foot, double below, double above, double height,
                 bool is_open = false) {
        return hull(
            n,
            [&](std::uint32_t k) {
                const double angle = (k + 0.5) / n * 2.0 * std::numbers::pi;
                const Point way(std::cos(angle), 0.0, std::sin(angle));
                return std::array{foot + below * way, foot + above * way + Point(0.0, height, 0.0)};
            },
            is_open);
    }
    /// A convex outline in the plane of an axis and y, drawn along the other axis, x or z.
    Parts& slab(const std::vector<glm::dvec2>& outline, char along, double from, double to) {
        return hull(static_cast<std::uint32_t>(outline.size()), [&](std::uint32_t k) {
            const auto at = [&](double t) {
                return along == 'x' ? Point(t, outline[k].y, outline[k].x)
                                    : Point(outline[k].x, outline[k].y, t);
            };
            return std::array{at(from), at(to)};
        });
    }
    [[nodiscard]] Mesh mesh() const {
        constexpr float Crease = 40.0f;
        return mesh::with_creases(mesh_, Crease);
    }

private:
    /// Sides between two rings of corners, and what closes them, facing outwards.
    Parts& hull(std::uint32_t n, const std::function<std::array<Point, 2>(std::uint32_t)>& corners,
                bool is_open = false) {
        const auto first = static_cast<std::uint32_t>(mesh_.num_vertices());
        for (std::uint32_t k = 0; k < n; ++k)
            for (const Point& corner : corners(k))
                mesh_.positions.emplace_back(corner);
        Point middle(0.0);
        for (std::uint32_t k = 0; k < 2 * n; ++k)
            middle += Point(mesh_.positions[first + k]) / (2.0 * n);
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            const std::array at = {Point(mesh_.positions[first + a]),
                                   Point(mesh_.positions[first + b]),
                                   Point(mesh_.positions[first + c])};
            if (glm::dot(glm::cross(at[1] - at[0], at[2] - at[0]), at[0] - middle) < 0.0)
                std::swap(b, c);
            mesh_.triangles.push_back({first + a, first + b, first + c});
        };
        for (std::uint32_t k = 0; k < n; ++k) {
            const std::uint32_t low = 2 * k, next = 2 * ((k + 1) % n);
            add(low, low + 1, next);
            add(next, low + 1, next + 1);
            if (k >= 2 && !is_open) {
                add(0, low - 2, low);
                add(1, low + 1, low - 1);
            }
        }
        return *this;
    }
    mesh::TriangleMesh mesh_;
};

Mesh made(const std::string& name) {
    Parts parts;
    if (name == "beams before a wall") {
        parts.box({-3, 0, -0.2}, {3, 3, 0});
        for (int i = 0; i < 6; ++i)
            parts.box({-3 + 1.15 * i, 0, 0}, {-2.75 + 1.15 * i, 3, 0.25});
        parts.box({-3, 1.4, 0}, {3, 1.6, 0.2}).box({-3, 2.8, 0}, {3, 3, 0.3});
    } else if (name == "eaves")
        parts.box({-2, 0, -1.5}, {2, 2, 1.5})
            .slab({{-2.2, 1.8}, {0, 3.4}, {0, 3.6}, {-2.3, 1.9}}, 'x', -2.5, 2.5)
            .slab({{0, 3.4}, {2.2, 1.8}, {2.3, 1.9}, {0, 3.6}}, 'x', -2.5, 2.5)
            .box({0.8, 1.5, -0.8}, {1.3, 4, -0.3})
            .box({-0.4, 0, 1.5}, {0.4, 1.2, 1.6})
            .box({-1.6, 0.7, 1.45}, {-0.9, 1.3, 1.55});
    else if (name == "lamp")
        parts.stump(16, {0, 0, 0}, 0.8, 0.8, 0.15)
            .stump(8, {0, 0.15, 0}, 0.08, 0.08, 2.4)
            .stump(16, {0, 1.9, 0}, 1.0, 0.5, 1.0, true);
    else if (name == "slats") {
        parts.box({-1.7, 0, -0.1}, {-1.5, 3, 0.3}).box({1.5, 0, -0.1}, {1.7, 3, 0.3});
        for (int i = 0; i < 12; ++i)
            parts.slab({{0, 0.1 + 0.24 * i}, {0.2, 0.25 + 0.24 * i}, {0, 0.16 + 0.24 * i}}, 'x',
                       -1.5, 1.5);
        parts.box({-1.5, 0, -0.1}, {1.5, 3, -0.05});
    } else if (name == "steps")
        for (int i = 0; i < 8; ++i)
            parts.box({-1.5, 0, -0.4 * i}, {1.5, 0.25 * (i + 1), -0.4 * i + 0.4});
    else if (name == "arch") {
        parts.box({-2, 0, -0.5}, {-1, 2, 0.5}).box({1, 0, -0.5}, {2, 2, 0.5});
        for (int i = 0; i < 8; ++i) {
            const auto at = [&](int k, double r) {
                const double angle = k * std::numbers::pi / 8.0;
                return glm::dvec2(r * std::cos(angle), 2.0 + r * std::sin(angle));
            };
            parts.slab({at(i, 1), at(i, 2), at(i + 1, 2), at(i + 1, 1)}, 'z', -0.5, 0.5);
        }
    } else if (name == "table")
        parts.box({-1.5, 1.4, -0.8}, {1.5, 1.5, 0.8})
            .box({-1.4, 0, -0.7}, {-1.25, 1.4, -0.55})
            .box({1.25, 0, -0.7}, {1.4, 1.4, -0.55})
            .box({-1.4, 0, 0.55}, {-1.25, 1.4, 0.7})
            .box({1.25, 0, 0.55}, {1.4, 1.4, 0.7})
            .stump(12, {0.5, 1.5, 0}, 0.2, 0.3, 0.4)
            .box({-0.9, 1.5, -0.2}, {-0.3, 1.65, 0.3});
    else if (name == "tree")
        parts.stump(8, {0, 0, 0}, 0.2, 0.2, 1.0)
            .stump(12, {0, 0.7, 0}, 1.2, 0.3, 1.1)
            .stump(12, {0, 1.5, 0}, 1.0, 0.2, 1.0)
            .stump(12, {0, 2.2, 0}, 0.8, 0.0, 1.2);
    else if (name == "columns") {
        parts.box({-2.5, 0, -1.5}, {2.5, 0.2, 1.5}).box({-2.5, 2.6, -1.5}, {2.5, 3, 1.5});
        for (int i = 0; i < 8; ++i)
            parts.stump(12, {-2 + 1.3 * (i % 4), 0.2, i < 4 ? 1.0 : -1.0}, 0.25, 0.2, 2.4);
    } else if (name == "shelf") {
        parts.box({-1.5, 0, -0.5}, {1.5, 3, -0.4});
        for (const double x : {-1.5, -0.05, 1.4})
            parts.box({x, 0, -0.4}, {x + 0.1, 3, 0.4});
        for (int i = 0; i < 5; ++i)
            parts.box({-1.5, 0.72 * i, -0.4}, {1.5, 0.72 * i + 0.1, 0.4});
    } else if (name == "crates")
        parts.box({-1, 0, -1}, {0, 1, 0})
            .box({0.1, 0, -0.9}, {0.9, 0.8, -0.1})
            .box({-0.6, 1, -0.8}, {0.3, 1.7, -0.1})
            .stump(16, {-0.4, 0, 0.6}, 0.35, 0.35, 0.9)
            .stump(16, {0.6, 0, 0.5}, 0.4, 0.4, 0.2);
    else // sheets
        parts.stump(4, {0, 0, 0}, 1.4, 1.8, 1.2, true).stump(10, {0.2, 0, 0.1}, 0.3, 0.0, 1.6);
    return parts.mesh();
}
constexpr std::array<const char*, 12> Generated = {"beams before a wall",
                                                   "eaves",
                                                   "lamp",
                                                   "slats",
                                                   "steps",
                                                   "arch",
                                                   "table",
                                                   "tree",
                                                   "columns",
                                                   "shelf",
                                                   "crates",
                                                   "sheets"};

constexpr std::array<const char*, 16> Files = {"lowpoly/house.obj",
                                               "lowpoly/building_castle_blue.obj",
                                               "lowpoly/treeSnow.stl",
                                               "gltf/draco/barrel.gltf",
                                               "gltf/draco/chest.gltf",
                                               "gltf/draco/cannon-large.gltf",
                                               "gltf/draco/boat-small.gltf",
                                               "gltf/draco/ambulance.gltf",
                                               "gltf/draco/burger.gltf",
                                               "gltf/plain/cornellBox.glb",
                                               "gltf/plain/runeSword.glb",
                                               "meshes/ugly/assimp_WusonOBJ.obj",
                                               "meshes/ugly/assimp_spider.obj",
                                               "meshes/ugly/happly_platonic_shelf.ply",
                                               "meshes/ugly/pmp_suzanne.obj",
                                               "meshes/ugly/cgal_boeing.off"};

struct Map {
    std::string name;
    Environment environment;
};

/// Lights a scene and draws it, with the camera and the exposure that are chosen where none is.
struct Shot {
    std::optional<Camera> camera = {};
    std::optional<double> exposure = {};
    Picture picture = {};
    void take(const LitScene& lit, const Lighting& lighting, const Settings& settings) {
        OutputOptions options{.background = NothingBehind{}};
        options.width = settings.width;
        options.height = settings.height;
        options.samples_per_axis = 1;
        options.camera = camera;
        Painter painter(lit, options);
        if (!exposure)
            exposure = painter.choose_exposure_ev(lighting);
        picture = painter.draw(lighting);
    }
};

glm::vec3 shown(const glm::vec3& radiance, double exposure) {
    glm::vec3 color =
        relight::on_screen(ToneCurve::Neutral, static_cast<float>(std::exp2(exposure)) * radiance);
    for (int i = 0; i < 3; ++i)
        color[i] = files::srgb_of_linear(color[i]);
    return 255.0f * color;
}

LitScene lit_by(const std::shared_ptr<const Scene>& scene, const Environment& environment,
                const Settings& settings) {
    LitScene lit(scene);
    lit.light(Environment(environment));
    if (scene->bounces && !settings.direct)
        lit.bounce({.albedo = bounce_albedo(*scene)});
    return lit;
}

void compare(const std::string& name, Mesh mesh, std::span<const Map> lights,
             const Settings& settings) {
    stand_on_floor(mesh);
    mesh.is_floor_open = mesh.is_floor_open && settings.refined_floor;
    const std::size_t before = mesh.geometry.num_vertices();
    PrecomputeOptions options{.tolerance = settings.tolerance,
                              .bounce_tolerance = settings.bounce_tolerance};
    if (settings.direct)
        options.bounce_tolerance = 0.0f;
    const auto start = std::chrono::steady_clock::now();
    const auto vertices = std::make_shared<const Scene>(precompute(mesh, options));
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    options.bounce_tolerance =
        vertices->bounces ? settings.bounce_tolerance.value_or(prt::BounceOptions{}.tolerance)
                          : 0.0f;
    options.tolerance = settings.tolerance.value_or(prt::PrecomputeOptions{}.tolerance);
    options.receivers = Pixels{settings.width, settings.height, 1}; // one sample a pixel
    Shot first;
    first.camera = camera_of(*vertices, static_cast<float>(settings.width) /
                                            static_cast<float>(settings.height));
    options.view = View{first.camera};
    // Vertices have no highlights without an eye.
    options.surface = [](const mesh::TriangleMesh&, std::uint32_t, const prt::Surface& own) {
        return prt::without_highlight(own);
    };
    if (mesh.geometry.materials.empty())
        options.surface = {};
    const fs::path kept = settings.references / (fs::path(name).stem().string() + ".prt");
    const bool is_kept = !settings.references.empty() && fs::exists(kept);
    if (!settings.references.empty())
        options.output = kept;
    const auto pixels = std::make_shared<const Scene>(
        is_kept ? load_scene(kept) : precompute(std::move(mesh), options));
    const auto& samples = std::get<prt::PixelLayout>(pixels->layout).samples;
    const std::vector<bool> is_floor = floor_receivers(*pixels);
    fmt::print("| {} | {} | {} | {:.1f} s |", name, before, vertices->mesh.num_vertices(),
               seconds.count());
    for (const Map& light : lights) {
        const LitScene lit = lit_by(vertices, light.environment, settings);
        const LitScene exact = lit_by(pixels, light.environment, settings);
        first.exposure.reset();
        first.take(lit, lit.lighting(), settings);
        Shot second{.camera = first.camera, .exposure = first.exposure};
        second.take(exact, exact.lighting(), settings);
        double sum = 0.0, count = 0.0;
        Picture difference = first.picture;
        difference.alpha.clear();
        std::fill(difference.pixels.begin(), difference.pixels.end(), glm::vec3(0.5f));
        for (std::size_t i = 0; i < samples.size(); ++i)
            if (is_floor.empty() || !is_floor[i]) {
                const glm::vec3 a = shown(first.picture.pixels[samples[i]], *first.exposure);
                const glm::vec3 b = shown(second.picture.pixels[samples[i]], *first.exposure);
                const glm::vec3 d = glm::abs(a - b);
                sum += (d.r + d.g + d.b) / 3.0;
                count += 1.0;
                difference.pixels[samples[i]] += (a - b) / 100.0f;
            }
        fmt::print(" {:.2f} |", sum / count);
        if (settings.pictures.empty())
            continue;
        Picture all{.width = 3 * settings.width, .height = settings.height};
        for (std::uint32_t y = 0; y < settings.height; ++y)
            for (const auto& [from, scale] :
                 {std::pair(&first.picture, std::exp2(*first.exposure)),
                  std::pair(&second.picture, std::exp2(*first.exposure)),
                  std::pair(&difference, 1.0)})
                for (std::uint32_t x = 0; x < settings.width; ++x)
                    all.pixels.push_back(static_cast<float>(scale) *
                                         from->pixels[std::size_t{y} * settings.width + x]);
        fs::create_directories(settings.pictures);
        relight::save_picture(settings.pictures / fmt::format("{}_{}.png",
                                                              fs::path(name).stem().string(),
                                                              light.name),
                              all, {.tone = ToneCurve::Neutral});
    }
    fmt::print("\n");
    std::fflush(stdout);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_coarse",
                           "first pictures of coarse meshes against receivers in every pixel");
    program.add("--data", settings.data, "folder with gltf, lowpoly, meshes and envs");
    program.add("--files", settings.files, "meshes A,B,.. in place of the list's");
    program.add("--only", settings.only, "rows whose names hold this word");
    program.add_flag("--generated", settings.generated, "no files");
    program.add("--width", settings.width, "of the pictures");
    program.add("--height", settings.height);
    program.add_flag("--direct", settings.direct, "no bounces");
    program.add("--references", settings.references,
                "folder that keeps the scenes of pixels for the next time");
    program.add("--pictures", settings.pictures,
                "folder for the first picture, that of pixels, and the difference");
    return program.run(argc, argv, [&] {
        std::vector<Map> lights;
        for (const char* file :
             {"envs/polyhaven/rooitou_park_1k.hdr", "envs/latlong/studio_1k.hdr"})
            if (!program.is_tiny() && fs::exists(settings.data / file))
                lights.push_back(
                    {fs::path(file).stem().string(), load_environment(settings.data / file)});
        if (program.is_tiny()) {
            settings.width = settings.height = 16;
            settings.tolerance = 0.1f;
            settings.bounce_tolerance = 0.2f;
            settings.refined_floor = false;
        }
        if (lights.empty()) {
            lights.emplace_back().name = "soft_boxes";
            lights.back().environment.map = data_gen::two_soft_boxes(64);
        }
        fmt::print("| mesh | vertices | refined | precompute |");
        for (const Map& light : lights)
            fmt::print(" {} |", light.name);
        fmt::print("\n|---|---|---|---|");
        for (std::size_t i = 0; i < lights.size(); ++i)
            fmt::print("---|");
        fmt::print("\n");
        const auto is_wanted = [&](const std::string& name) {
            return name.find(settings.only) != std::string::npos;
        };
        if (settings.files.empty())
            for (const char* name : Generated)
                if (is_wanted(name) && (!program.is_tiny() || name == Generated.back()))
                    compare(name, made(name), lights, settings);
        if (settings.generated || program.is_tiny())
            return;
        std::vector<std::string> files(Files.begin(), Files.end());
        if (!settings.files.empty())
            files = settings.files;
        for (const std::string& file : files) {
            const fs::path path = fs::exists(file) ? fs::path(file) : settings.data / file;
            if (!is_wanted(file))
                continue;
            if (fs::exists(path))
                compare(path.filename().string(), load_mesh(path), lights, settings);
            else
                fmt::print(stderr, "{}\n", absent_data(file));
        }
    });
}
