// How clean pictures are: single pixels that stand out, grain, and the distance to a picture of
// many more rays and samples, of assets as `relumine relight MESH ENV` draws them. See
// docs/measurements.md.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "cubemap/layers/image_pyramid.h"
#include "data_gen/environments.h"
#include "files/pixel_values.h"
#include "mesh/tangents.h"
#include "relight/pictures/picture.h"
#include "relumine/relumine.h"
#include "tests/bench/process_usage.h"
#include "tests/bench/program.h"
#include "tests/real_data.h"

using namespace relumine;

namespace {

namespace fs = std::filesystem;

struct Settings {
    fs::path data = real_data_folder(), kept, pictures;
    std::string only;
    std::uint32_t width = 320, height = 240, rays = DefaultHighlightRays, samples = 3;
    std::uint32_t many_rays = 256, many_samples = 6;
    std::optional<float> tolerance = {};
};

struct Row {
    std::string name;
    /// A file of the data. Empty: made() of the name.
    std::string mesh;
    std::string map;
};

constexpr const char* Dawn = "envs/polyhaven/kiara_1_dawn_1k.hdr";
constexpr const char* Park = "envs/polyhaven/rooitou_park_1k.hdr";
constexpr const char* Studio = "envs/polyhaven/studio_small_03_1k.hdr";
constexpr const char* Sunset = "envs/latlong/sunset_1k.hdr";
constexpr const char* Workshop = "khronos/envs/aircraft_workshop_01_1k.hdr";
constexpr const char* Church = "envs/debevec/stpeters_cross.hdr";
constexpr const char* Loft = "lowpoly/newport_loft.hdr";

const std::vector<Row> Rows = {
    {"polished metal", "", Sunset},
    {"brushed metal", "", Workshop},
    {"glass", "", Church},
    {"rough glass", "", Park},
    {"helmet", "khronos/models/DamagedHelmet/glTF-Binary/DamagedHelmet.glb", Park},
    {"toy car", "khronos/models/ToyCar/glTF/ToyCar.gltf", Workshop},
    {"sheen chair", "khronos/models/SheenChair/glTF/SheenChair.gltf", Studio},
    {"coats", "khronos/models/ClearCoatTest/glTF/ClearCoatTest.gltf", Studio},
    {"normal maps", "khronos/models/NormalTangentTest/glTF/NormalTangentTest.gltf", Sunset},
    {"duck", "khronos/models/Duck/glTF/Duck.gltf", Dawn},
    {"attenuation", "khronos/models/AttenuationTest/glTF/AttenuationTest.gltf", Workshop},
    {"transmission", "khronos/models/TransmissionTest/glTF-Binary/TransmissionTest.glb", Loft},
    {"blended", "khronos/models/AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb", Park},
    {"shader ball", "gltf/plain/shaderBall.glb", Church},
    {"sword", "gltf/plain/runeSword.glb", Dawn},
    {"fan", "gltf/plain/vintageDeskFan/vintageFan_animated.gltf", Loft},
    {"barrel", "gltf/plain/ExplodingBarrel.glb", Studio},
    {"house", "lowpoly/house.obj", Sunset},
    {"hotel", "lowpoly/hotel/scene.glb", "lowpoly/kloppenheim_05_1k.hdr"},
};

/// Three balls of one material, which mirror each other.
Mesh made(const std::string& name, std::uint32_t rows) {
    mesh::TriangleMesh mesh;
    mesh::Material& material = mesh.materials.emplace_back();
    material.name = name;
    material.model = mesh::MaterialModel::MetallicRoughness;
    material.roughness = 0.05f;
    if (name == "polished metal" || name == "brushed metal") {
        material.metallic = 1.0f;
        material.base_color = {0.9f, 0.75f, 0.5f};
        if (name == "brushed metal") {
            material.roughness = 0.3f;
            material.anisotropy = 0.8f;
        }
    } else {
        material.transmission = 1.0f;
        material.thickness = 1.0f;
        material.roughness = name == "rough glass" ? 0.3f : 0.0f;
    }
    const std::uint32_t columns = 2 * rows;
    for (const glm::vec3& middle : {glm::vec3(-1.1f, 0.0f, 0.0f), glm::vec3(1.1f, 0.0f, 0.0f),
                                    glm::vec3(0.0f, 0.0f, -1.9f)}) {
        const auto first = static_cast<std::uint32_t>(mesh.num_vertices());
        for (std::uint32_t y = 0; y <= rows; ++y)
            for (std::uint32_t x = 0; x <= columns; ++x) {
                const glm::vec2 uv(static_cast<float>(x) / static_cast<float>(columns),
                                   static_cast<float>(y) / static_cast<float>(rows));
                const float around = 2.0f * std::numbers::pi_v<float> * uv.x;
                const float down = std::numbers::pi_v<float> * uv.y;
                const glm::vec3 normal(std::sin(down) * std::cos(around), std::cos(down),
                                       -std::sin(down) * std::sin(around));
                mesh.positions.push_back(middle + normal);
                mesh.normals.push_back(normal);
                mesh.uvs.push_back(uv);
            }
        for (std::uint32_t y = 0; y < rows; ++y)
            for (std::uint32_t x = 0; x < columns; ++x) {
                const std::uint32_t above = first + y * (columns + 1) + x,
                                    below = above + columns + 1;
                if (y + 1 < rows)
                    mesh.triangles.push_back({above, below, below + 1});
                if (y > 0)
                    mesh.triangles.push_back({above, below + 1, above + 1});
            }
    }
    mesh.triangle_materials.assign(mesh.triangles.size(), 0);
    mesh::set_tangents(mesh, {});
    return mesh;
}

Picture drawn(const LitScene& lit, const Lighting& lighting, const OutputOptions& options) {
    return Painter(lit, options).draw(lighting);
}

/// Values from 0 to 255, as a screen shows them.
std::vector<glm::vec3> shown(const Picture& picture, double exposure) {
    std::vector<glm::vec3> result = picture.pixels;
    for (glm::vec3& color : result) {
        color =
            relight::on_screen(ToneCurve::Neutral, static_cast<float>(std::exp2(exposure)) * color);
        for (int i = 0; i < 3; ++i)
            color[i] = 255.0f * files::srgb_of_linear(color[i]);
    }
    return result;
}

float largest(const glm::vec3& v) {
    return std::max({std::abs(v.r), std::abs(v.g), std::abs(v.b)});
}

/// What a picture differs by from a converged one.
struct Cleanness {
    std::size_t num_pixels = 0;
    std::vector<std::size_t> specks = {};
    double distance = 0.0, grain = 0.0;
};

/// Counts where `covered`, away from the picture's border.
Cleanness cleanness(const std::vector<glm::vec3>& seen, const std::vector<glm::vec3>& converged,
                    const std::vector<bool>& covered, std::uint32_t width) {
    /// So much a speck differs from the median of the pixels around it, and from the truth.
    constexpr float SpeckFrom = 40.0f;
    Cleanness result;
    for (std::size_t i = width + 1; i + width + 1 < seen.size(); ++i) {
        if (!covered[i] || i % width == 0 || i % width == width - 1)
            continue;
        std::array<std::size_t, 8> around{};
        for (std::size_t k = 0; k < 9; ++k)
            if (k != 4)
                around[k - (k > 4 ? 1 : 0)] = i + (k / 3) * width + k % 3 - width - 1;
        glm::vec3 median(0.0f), others(0.0f);
        for (int channel = 0; channel < 3; ++channel) {
            std::array<float, 8> values{};
            for (std::size_t k = 0; k < 8; ++k)
                values[k] = seen[around[k]][channel];
            std::sort(values.begin(), values.end());
            median[channel] = 0.5f * (values[3] + values[4]);
        }
        for (const std::size_t other : around)
            others += (seen[other] - converged[other]) / 8.0f;
        const glm::vec3 error = seen[i] - converged[i];
        if (largest(seen[i] - median) > SpeckFrom && largest(error) > SpeckFrom)
            result.specks.push_back(i);
        const glm::vec3 distance = glm::abs(error), grain = glm::abs(error - others);
        result.distance += (distance.r + distance.g + distance.b) / 3.0;
        result.grain += (grain.r + grain.g + grain.b) / 3.0;
        ++result.num_pixels;
    }
    result.distance /= static_cast<double>(std::max<std::size_t>(result.num_pixels, 1));
    result.grain /= static_cast<double>(std::max<std::size_t>(result.num_pixels, 1));
    return result;
}

Scene scene_of(const Row& row, const Settings& settings, bool is_tiny) {
    const fs::path kept = settings.kept.empty() ? fs::path() : settings.kept / (row.name + ".prt");
    if (!kept.empty() && fs::exists(kept))
        return load_scene(kept);
    Mesh mesh =
        row.mesh.empty() ? made(row.name, is_tiny ? 6 : 48) : load_mesh(settings.data / row.mesh);
    if (!is_tiny)
        stand_on_floor(mesh);
    return precompute(std::move(mesh),
                      {.tolerance = settings.tolerance, .no_refine = is_tiny, .output = kept});
}

/// Saves the picture, the converged one, and their difference with its specks in red.
void save(const fs::path& path, const std::vector<glm::vec3>& seen,
          const std::vector<glm::vec3>& converged, const Cleanness& cleanness,
          const Settings& settings) {
    Picture all{.width = 3 * settings.width, .height = settings.height};
    std::vector<glm::vec3> difference(seen.size());
    for (std::size_t i = 0; i < seen.size(); ++i)
        difference[i] = glm::vec3(127.5f) + 2.0f * (seen[i] - converged[i]);
    for (const std::size_t speck : cleanness.specks)
        for (const std::size_t i : {speck - 1, speck, speck + 1})
            difference[i] = {255.0f, 0.0f, 0.0f};
    for (std::uint32_t y = 0; y < settings.height; ++y)
        for (const auto* from : {&seen, &converged, &std::as_const(difference)})
            for (std::uint32_t x = 0; x < settings.width; ++x) {
                const glm::vec3 value =
                    glm::clamp((*from)[std::size_t{y} * settings.width + x] / 255.0f, 0.0f, 1.0f);
                all.pixels.emplace_back(files::linear_of_srgb(value.r),
                                        files::linear_of_srgb(value.g),
                                        files::linear_of_srgb(value.b));
            }
    fs::create_directories(settings.pictures);
    relight::save_picture(path, all, {.tone = ToneCurve::None});
}

struct Sums {
    std::size_t num_pixels = 0, num_specks = 0;
    std::vector<double> distances, grains;
    double seconds = 0.0;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values.empty() ? 0.0 : values[values.size() / 2];
}

void measure(const Row& row, const Settings& settings, bool is_tiny, Sums& sums) {
    const auto scene = std::make_shared<const Scene>(scene_of(row, settings, is_tiny));
    Environment environment;
    if (is_tiny)
        environment.map = data_gen::two_soft_boxes(64);
    else
        environment = load_environment(settings.data / row.map);
    LitScene lit(scene);
    lit.light(std::move(environment));
    if (scene->bounces)
        lit.bounce({.albedo = bounce_albedo(*scene)});
    const Lighting lighting = lit.lighting();
    OutputOptions options;
    options.width = settings.width;
    options.height = settings.height;
    options.samples_per_axis = settings.samples;
    options.highlight_rays = settings.rays;
    Painter painter(lit, options);
    const double exposure = painter.choose_exposure_ev(lighting);
    const double before = bench::cpu_seconds();
    const Picture picture = painter.draw(lighting);
    const double seconds = bench::cpu_seconds() - before;

    OutputOptions alone = options;
    alone.background = NothingBehind{};
    alone.samples_per_axis = 1;
    alone.highlight_rays = 0;
    std::vector<bool> covered;
    for (const float alpha : drawn(lit, lighting, alone).alpha)
        covered.push_back(alpha > 0.02f);

    Picture many;
    const fs::path kept = settings.kept.empty() ? fs::path() : settings.kept / (row.name + ".exr");
    if (!kept.empty() && fs::exists(kept)) {
        many = cubemap::load_picture(kept);
    } else {
        OutputOptions fine = options;
        fine.samples_per_axis = settings.many_samples;
        fine.highlight_rays = settings.many_rays;
        many = drawn(lit, lighting, fine);
        if (!kept.empty())
            relight::save_picture(kept, many, {.tone = ToneCurve::None});
    }
    const std::vector<glm::vec3> seen = shown(picture, exposure), truth = shown(many, exposure);
    const Cleanness clean = cleanness(seen, truth, covered, settings.width);
    fmt::print("| {} | {} | {} | {} | {:.2f} | {:.2f} | {:.1f} |\n", row.name,
               is_tiny ? "two soft boxes" : fs::path(row.map).stem().string(), clean.num_pixels,
               clean.specks.size(), clean.distance, clean.grain, seconds);
    std::fflush(stdout);
    sums.num_pixels += clean.num_pixels;
    sums.num_specks += clean.specks.size();
    sums.distances.push_back(clean.distance);
    sums.grains.push_back(clean.grain);
    sums.seconds += seconds;
    if (!settings.pictures.empty())
        save(settings.pictures / (row.name + ".png"), seen, truth, clean, settings);
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    bench::Program program("bench_pictures", "specks and grain of pictures against many more rays");
    program.add("--data", settings.data, "folder with khronos, gltf, lowpoly and envs");
    program.add("--only", settings.only, "rows whose names hold this word");
    program.add("--width", settings.width, "of the pictures");
    program.add("--height", settings.height);
    program.add("--rays", settings.rays, "of a highlight");
    program.add("--samples", settings.samples, "along an axis of a pixel");
    program.add("--many-rays", settings.many_rays, "of the converged picture, a power of two");
    program.add("--many-samples", settings.many_samples);
    program.add("--kept", settings.kept,
                "folder that keeps scenes and converged pictures for the next time");
    program.add("--pictures", settings.pictures,
                "folder for each picture, the converged one, and the difference");
    return program.run(argc, argv, [&] {
        if (program.is_tiny()) {
            settings.width = settings.height = 24;
            settings.many_rays = 32;
            settings.many_samples = 3;
            settings.tolerance = 0.1f;
        }
        if (!settings.kept.empty())
            fs::create_directories(settings.kept);
        fmt::print("| asset | map | pixels | specks | distance | grain | processor s |\n"
                   "|---|---|---|---|---|---|---|\n");
        Sums sums;
        for (const Row& row : Rows) {
            if (row.name.find(settings.only) == std::string::npos)
                continue;
            if (program.is_tiny() && !row.mesh.empty())
                break;
            for (const std::string& file : {row.mesh, row.map})
                if (!program.is_tiny() && !file.empty() && !fs::exists(settings.data / file))
                    throw bench::Absent(file);
            measure(row, settings, program.is_tiny(), sums);
        }
        fmt::print("| all | | {} | {} | {:.2f} | {:.2f} | {:.1f} |\n\n{:.1f} specks in a million "
                   "pixels; distance and grain are medians, of 255\n",
                   sums.num_pixels, sums.num_specks, median(sums.distances), median(sums.grains),
                   sums.seconds,
                   1e6 * static_cast<double>(sums.num_specks) /
                       static_cast<double>(std::max<std::size_t>(sums.num_pixels, 1)));
    });
}
