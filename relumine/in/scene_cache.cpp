#include "relumine/in/scene_cache.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/hash.h"
#include "prt/arithmetic.h"
#include "prt/glossy/surface_sampling.h"
#include "prt/scene/section_format.h"
#include "relumine/in/precompute_table.h"
#include "relumine/in/scene.h"
#include "relumine/in/stages.h"

namespace relumine {

namespace {

namespace fs = std::filesystem;

/// Raise it when a change of the precompute makes scenes that were kept worthless.
constexpr int CacheVersion = 3;

/// Removes the scenes that were used longest ago, until the rest is within the limit. `kept` stays.
void remove_oldest(const SceneCache& cache, const fs::path& kept) {
    struct File {
        fs::file_time_type used;
        fs::path path;
        std::uint64_t size;
    };
    std::vector<File> files;
    std::uint64_t size = 0;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(cache.folder, error)) {
        if (entry.path().extension() != ".prt" || !entry.is_regular_file(error))
            continue;
        files.push_back({entry.last_write_time(error), entry.path(), entry.file_size(error)});
        size += files.back().size;
    }
    std::sort(files.begin(), files.end(),
              [](const File& a, const File& b) { return a.used < b.used; });
    for (const File& file : files)
        if (size > cache.max_bytes && file.path != kept && fs::remove(file.path, error))
            size -= file.size;
}

} // namespace

std::optional<SceneCache> user_cache() {
    constexpr std::array<std::array<const char*, 2>, 3> Places = {
        {{"RELUMINE_CACHE", nullptr}, {"XDG_CACHE_HOME", "relumine"}, {"HOME", ".cache/relumine"}}};
    for (const auto& [variable, below] : Places) {
        const char* const value = std::getenv(variable); // NOLINT(concurrency-mt-unsafe)
        if (value != nullptr && *value != '\0')
            return SceneCache{.folder =
                                  below == nullptr ? fs::path(value) : fs::path(value) / below};
        if (value != nullptr && below == nullptr)
            return std::nullopt;
    }
    return std::nullopt;
}

fs::path cached_file(const SceneCache& cache, const Mesh& mesh, const PrecomputeOptions& options) {
    if (options.surface || options.floor_surface != prt::Surface())
        throw std::invalid_argument("expected no surfaces beside a cache");
    PrecomputeOptions named = options;
    named.output.clear();
    named.resume = false;
    named.checkpoint_seconds = PrecomputeOptions{}.checkpoint_seconds;
    // Meshes of equal content may differ in which vertices are a floor, and which may become more.
    const std::string text =
        fmt::format("{} {} {} {} {} {} {}\n{}", CacheVersion, prt::SceneFileVersion,
                    prt::arithmetic(), mesh.floor_vertices, mesh.floor_added, mesh.is_floor_open,
                    mesh.is_open, settings_of(options_of(named)));
    const std::uint64_t of_options = files::hash_of(std::as_bytes(std::span(text)));
    Scene scene = unclustered_scene(mesh);
    if (!mesh.geometry.materials.empty())
        scene.receivers.surfaces = prt::vertex_surfaces(mesh.geometry);
    const std::uint64_t of_mesh = prt::hash_without_light(scene);
    const std::string name = fs::path(mesh.source).stem().string();
    return cache.folder / fmt::format("{}-{:016x}{:016x}.prt", name, of_mesh, of_options);
}

Scene cached_precompute(const SceneCache& cache, Mesh mesh, const PrecomputeOptions& options,
                        const PrecomputeWork& work, PrecomputeReport* report,
                        const std::function<void(const Mesh&)>& before) {
    const fs::path file = cached_file(cache, mesh, options);
    std::error_code error;
    if (fs::exists(file, error)) {
        try {
            Scene scene = load_scene(file);
            fs::last_write_time(file, fs::file_time_type::clock::now(), error);
            if (report != nullptr)
                *report = {};
            return scene;
        } catch (const std::runtime_error&) { // made anew
        }
    }
    if (before)
        before(mesh);
    fs::create_directories(cache.folder, error);
    PrecomputeOptions unsaved = options;
    unsaved.output.clear();
    Scene scene = precompute(std::move(mesh), unsaved, work, report);
    try {
        save_scene(file, scene);
        remove_oldest(cache, file);
    } catch (const std::runtime_error& failed) {
        warn(work, Warning::Checkpoint, fmt::format("{}; the scene is not kept", failed.what()));
    }
    return scene;
}

} // namespace relumine
