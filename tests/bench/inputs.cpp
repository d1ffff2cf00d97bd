#include "tests/bench/inputs.h"

#include <fmt/format.h>

#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "relumine/in/environment.h"
#include "relumine/in/precompute.h"
#include "tests/real_data.h"

namespace relumine::bench {

namespace {

constexpr std::size_t TinyVertices = 1000;
constexpr float TinyTolerance = 0.1f;
constexpr std::uint32_t TinyResolution = 16;

} // namespace

Inputs::Inputs(Program& program) : program_(program), data_(real_data_folder()) {
    program.add("--data", data_, "folder with meshes/stanford and envs/debevec");
}

void Inputs::add_scene() {
    program_.add("--scene", scene_, "the bunny's .prt, where it is there");
}

Mesh Inputs::mesh(const std::string& name, std::uint32_t floor_vertices) const {
    if (is_tiny()) {
        Mesh blob(data_gen::blob(TinyVertices));
        blob.is_open = false; // as many vertices as that
        return blob;
    }
    const std::filesystem::path file = std::filesystem::path("meshes/stanford") / name;
    if (!std::filesystem::exists(data_ / file))
        throw Absent(file);
    MeshOptions options;
    if (floor_vertices != 0)
        options.floor_vertices = floor_vertices;
    return load_mesh(data_ / file, options);
}

Scene Inputs::bunny() const {
    if (!scene_.empty())
        return load_scene(scene_);
    if (is_tiny())
        return precompute(mesh(""), {.tolerance = TinyTolerance});
    Mesh bunny = mesh("bun_zipper.ply");
    fmt::print(stderr, "precompute; name a finished one with --scene to save the time\n");
    return precompute(std::move(bunny));
}

cubemap::CubeMap Inputs::map_of(const std::filesystem::path& file, std::uint32_t resolution) const {
    if (is_tiny())
        return data_gen::two_soft_boxes(TinyResolution);
    const std::filesystem::path path = "envs" / file;
    if (!std::filesystem::exists(data_ / path))
        throw Absent(path);
    return load_environment(data_ / path, {.face_resolution = resolution}).map;
}

cubemap::CubeMap Inputs::environment(const std::string& file, std::uint32_t resolution) const {
    return map_of(std::filesystem::path("debevec") / file, resolution);
}

cubemap::CubeMap Inputs::studio(std::uint32_t resolution) const {
    return map_of("polyhaven/studio_small_03_1k.hdr", resolution);
}

cubemap::LightLayer disc(const glm::dvec3& direction, double part_of_face, double intensity) {
    cubemap::LightLayer layer;
    layer.name = "disc";
    layer.region = cubemap::Disc{.direction = direction, .radius_degrees = 90.0 * part_of_face};
    layer.effect = cubemap::Emit{.radiance = glm::vec3(static_cast<float>(intensity))};
    return layer;
}

std::vector<NamedMap> Inputs::probes_and_sky(std::uint32_t resolution) const {
    std::vector<NamedMap> maps;
    for (const char* name : {"grace_cross.hdr", "stpeters_cross.hdr", "galileo_cross.hdr",
                             "beach_cross.hdr", "kitchen_cross.hdr"})
        maps.push_back({name, environment(name, resolution)});
    maps.push_back({"sun and sky", data_gen::sun_and_sky(resolution)});
    return maps;
}

} // namespace relumine::bench
