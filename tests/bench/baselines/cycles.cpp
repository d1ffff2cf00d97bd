#include "tests/bench/baselines/cycles.h"

#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <glm/matrix.hpp>
#include <unistd.h>

#include "cubemap/image/convention.h"
#include "cubemap/image/environment.h"
#include "cubemap/resample/convert.h"
#include "cubemap/resample/resample.h"
#include "mesh/save.h"
#include "relight/pictures/array_file.h"

namespace relumine::bench {

namespace {

namespace fs = std::filesystem;

/// Returns what a command says.
std::string said(const std::string& command) {
    FILE* pipe = ::popen((command + " 2>&1").c_str(), "r");
    if (pipe == nullptr)
        throw std::runtime_error("expected a shell, got none for: " + command);
    std::string text;
    for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe))
        text += static_cast<char>(c);
    static_cast<void>(::pclose(pipe));
    return text;
}

/// As Blender reads it.
void save_for_blender(const fs::path& path, const cubemap::CubeMap& environment) {
    using cubemap::Layout;
    const cubemap::ImageSize size = natural_size(Layout::Cube, environment.resolution);
    const cubemap::EnvironmentImage image = cubemap::to_image(
        environment, Layout::Cube, size.width, size.height, cubemap::Sampling::TexelCentres);
    cubemap::save_image(
        path, cubemap::convert(image,
                               {Layout::LatLong, cubemap::Sampling::TexelCentres,
                                4 * environment.resolution, 2 * environment.resolution},
                               glm::transpose(cubemap::find_convention("blender")->world_from(
                                   Layout::LatLong))));
}

} // namespace

bool Cycles::is_there() {
    return std::system("command -v blender > /dev/null 2>&1") == 0;
}

Cycles::Cycles(const mesh::TriangleMesh& mesh)
    : folder_(fs::temp_directory_path() / fmt::format("relumine_bench_cycles_{}", ::getpid())) {
    fs::create_directories(folder_);
    mesh::save(folder_ / "mesh.ply", mesh);
    relight::save_npy(folder_ / "normals.npy", mesh.normals);
}

Cycles::~Cycles() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
}

Cycles::Baked Cycles::bake(const cubemap::CubeMap& environment, std::uint32_t samples) const {
    save_for_blender(folder_ / "environment.exr", environment);
    const std::string folder = folder_.string();
    const std::string text = said(fmt::format(
        "blender -b --factory-startup -P '{}' -- '{}/mesh.ply' '{}/environment.exr' {} 0 1 "
        "'{}/light.npy' '{}/normals.npy'",
        RELUMINE_CYCLES_BAKE, folder, folder, samples, folder, folder));
    constexpr const char* Before = "baked in ";
    const std::size_t place = text.find(Before);
    if (place == std::string::npos)
        throw std::runtime_error("Blender baked nothing: " + text);
    return {.radiance = relight::load_npy(folder_ / "light.npy").values,
            .seconds = std::stod(text.substr(place + std::char_traits<char>::length(Before)))};
}

} // namespace relumine::bench
