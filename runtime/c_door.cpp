// The functions of the C header: arguments are checked here, and exceptions become codes.
#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "cubemap/resample/resample_lat_long.h"
#include "files/pixel_values.h"
#include "prt/scene/section_reader.h"
#include "relight/harmonics/harmonics.h"
#include "runtime/runtime_scene.h"

using relumine::runtime::RuntimeScene;

struct RelumineScene {
    RuntimeScene own;
};

namespace relumine::runtime {

namespace {

static_assert(sizeof(glm::vec3) == 3 * sizeof(float));

thread_local std::string last_error;

/// A file that was not a scene.
struct WrongFile {
    std::string message;
};

RelumineResult failed(RelumineResult code, std::string message) noexcept {
    try {
        last_error = std::move(message);
    } catch (...) {
    }
    return code;
}

/// Runs the work of one function.
template<class Work>
RelumineResult run(const Work& work) noexcept {
    last_error.clear();
    try {
        work();
        return RELUMINE_OK;
    } catch (const WrongFile& error) {
        return failed(RELUMINE_WRONG_FILE, error.message);
    } catch (const RuntimeScene::NotLit& error) {
        return failed(RELUMINE_NOT_LIT, error.message);
    } catch (const RuntimeScene::NotThere& missing) {
        return failed(RELUMINE_NOT_THERE, fmt::format("expected {}", missing.what));
    } catch (const std::bad_alloc&) {
        return failed(RELUMINE_OUT_OF_MEMORY, "out of memory");
    } catch (const std::length_error&) {
        return failed(RELUMINE_OUT_OF_MEMORY, "out of memory");
    } catch (const std::invalid_argument& error) {
        return failed(RELUMINE_WRONG_ARGUMENT, error.what());
    } catch (const std::exception& error) {
        return failed(RELUMINE_FAILED, error.what());
    } catch (...) {
        return failed(RELUMINE_FAILED, "unknown");
    }
}

void require(const void* pointer, const char* name) {
    if (pointer == nullptr)
        throw std::invalid_argument(fmt::format("{}: expected a pointer, got NULL", name));
}

void require_count(std::size_t got, std::size_t expected) {
    if (got != expected)
        throw std::invalid_argument(fmt::format("count: expected {}, got {}", expected, got));
}

/// Copies a caller's struct, which may come from another version: an older one is shorter, and what
/// it does not have stays as it is by default. A longer one may ask for what is not known here.
template<class Struct>
Struct taken(const Struct* given, const char* name) {
    Struct own{};
    if (given == nullptr)
        return own;
    if (given->size < sizeof given->size)
        throw std::invalid_argument(fmt::format("{}: expected its size, which is {} here, got {}",
                                                name, sizeof own, given->size));
    if (given->size > sizeof own)
        throw std::invalid_argument(
            fmt::format("{}: expected a size of at most {}, got {}: the program was compiled for "
                        "another version",
                        name, sizeof own, given->size));
    std::memcpy(&own, given, given->size);
    return own;
}

/// Runs the work on a scene, with its threads.
template<class Scene, class Work>
RelumineResult with(Scene* scene, const Work& work) noexcept {
    return run([&] {
        require(scene, "scene");
        const WithJobs jobs(scene->own.jobs());
        work(scene->own);
    });
}
/// Whatever a file does wrong is one kind of failure.
template<class MakeReader>
prt::RelightingScene scene_of(const MakeReader& reader) {
    try {
        return prt::relighting_scene_of(reader());
    } catch (const std::runtime_error& error) {
        throw WrongFile{error.what()};
    } catch (const std::invalid_argument& error) {
        throw WrongFile{error.what()};
    }
}

template<class MakeReader>
RelumineResult open(const RelumineOpenOptions* options, RelumineScene** scene,
                    const MakeReader& reader) noexcept {
    return run([&] {
        require(scene, "scene");
        const RelumineOpenOptions own = taken(options, "options");
        const RelumineJobs jobs = taken(own.jobs, "jobs");
        if (own.jobs != nullptr)
            require(reinterpret_cast<const void*>(jobs.run), "jobs.run");
        if (own.harmonics != 0)
            relight::require_order(own.harmonics);
        const WithJobs with_jobs(jobs);
        // NOLINTNEXTLINE(bugprone-unhandled-exception-at-new): run() catches it
        *scene = new RelumineScene{RuntimeScene(scene_of(reader), own.harmonics, jobs)};
    });
}

std::span<const glm::vec3> vectors(const float* values, std::size_t count) {
    return {reinterpret_cast<const glm::vec3*>(values), count};
}

/// Writes a vector for each receiver.
template<class Value>
void write(const RuntimeScene& own, float* values, std::size_t count, const Value& value) {
    require(values, "the array");
    require_count(count, 3 * own.num_receivers());
    for (std::size_t i = 0; i < own.num_receivers(); ++i) {
        const glm::vec3 vector = value(i);
        std::copy_n(&vector.x, 3, values + 3 * i);
    }
}

cubemap::CubeMap cube_map_of(std::uint32_t resolution, const float* rgb) {
    require(rgb, "rgb");
    cubemap::CubeMap map(resolution);
    const std::span<const glm::vec3> texels = vectors(rgb, map.texels.size());
    std::copy(texels.begin(), texels.end(), map.texels.begin());
    return map;
}

cubemap::CubeMap cube_map_of(std::uint32_t width, std::uint32_t height, std::uint32_t resolution,
                             const float* rgb) {
    constexpr std::uint32_t LargestEdge = 32768;
    require(rgb, "rgb");
    if (height < 1 || width > LargestEdge || width != 2 * height)
        throw std::invalid_argument(fmt::format(
            "expected a lat-long of twice its height, 2 x 1 to {} x {} pixels, got {} x {}",
            LargestEdge, LargestEdge / 2, width, height));
    cubemap::EnvironmentImage image;
    image.width = width;
    image.height = height;
    const std::span<const glm::vec3> pixels = vectors(rgb, std::size_t{width} * height);
    relight::require_radiance(pixels);
    image.pixels.assign(pixels.begin(), pixels.end());
    return cubemap::detail::cube_from_lat_long(
        image, resolution != 0 ? resolution : std::max((width + 2) / 4, 1u));
}

void write_map(const cubemap::CubeMap& map, float* rgb, std::size_t count) {
    require(rgb, "rgb");
    require_count(count, 3 * map.texels.size());
    for (const glm::vec3& texel : map.texels)
        rgb = std::copy_n(&texel.x, 3, rgb);
}

cubemap::TexelRectangle rectangle_of(std::uint32_t face, std::uint32_t x, std::uint32_t y,
                                     std::uint32_t width, std::uint32_t height) {
    if (face >= cubemap::NumFaces)
        throw std::invalid_argument(
            fmt::format("face: expected 0 to 5 (+X -X +Y -Y +Z -Z), got {}", face));
    constexpr std::uint32_t LargestEdge = 16384;
    if (x > LargestEdge || y > LargestEdge || width > LargestEdge || height > LargestEdge)
        throw std::invalid_argument("expected a rectangle on the face, got a larger one");
    return {static_cast<cubemap::Face>(face), x, y, x + width, y + height};
}

RelumineKind kind_of(const prt::Scene& scene) {
    if (scene.receivers.have_no_surface)
        return RELUMINE_POINTS;
    if (prt::on_vertices(scene.layout))
        return RELUMINE_VERTICES;
    return std::holds_alternative<prt::PixelLayout>(scene.layout) ? RELUMINE_PIXELS
                                                                  : RELUMINE_TEXELS;
}

RelumineInfo info_of(const RuntimeScene& own) {
    const prt::Scene& scene = own.scene();
    const prt::PlaceGrid grid =
        std::visit([](const auto& layout) { return layout.grid(); }, scene.layout);
    RelumineInfo info{};
    info.kind = kind_of(scene);
    info.num_receivers = static_cast<std::uint32_t>(own.num_receivers());
    info.num_clusters = static_cast<std::uint32_t>(scene.transfer.num_clusters());
    info.num_vertices = static_cast<std::uint32_t>(scene.mesh.num_vertices());
    info.num_triangles = static_cast<std::uint32_t>(scene.mesh.num_triangles());
    info.num_harmonics = static_cast<std::uint32_t>(own.num_harmonics());
    info.has_bounces = scene.bounces ? 1 : 0;
    info.width = grid.width;
    info.height = grid.height;
    info.tolerance = scene.settings.tolerance;
    info.resolution = own.environment().resolution;
    return info;
}

} // namespace

} // namespace relumine::runtime

using namespace relumine;
using namespace relumine::runtime;

uint32_t relumine_runtime_version(void) {
    return RELUMINE_RUNTIME_VERSION;
}

const char* relumine_last_error(void) {
    return last_error.c_str();
}

RelumineResult relumine_open(const char* path, const RelumineOpenOptions* options,
                             RelumineScene** scene) {
    if (path == nullptr)
        return run([&] { require(path, "path"); });
    if (*path == '\0')
        return run([] { throw WrongFile{"path: expected a name, got an empty one"}; });
    return open(options, scene, [&] { return prt::SectionReader(path); });
}

RelumineResult relumine_open_bytes(const void* bytes, size_t num_bytes,
                                   const RelumineOpenOptions* options, RelumineScene** scene) {
    if (bytes == nullptr)
        return run([&] { require(bytes, "bytes"); });
    const auto* begin = static_cast<const std::byte*>(bytes);
    return open(options, scene, [&] {
        return prt::SectionReader("memory", std::vector(begin, begin + num_bytes));
    });
}

void relumine_close(RelumineScene* scene) {
    delete scene;
}

RelumineResult relumine_info(const RelumineScene* scene, RelumineInfo* info) {
    return with(scene, [&](const RuntimeScene& own) {
        require(info, "info");
        const std::size_t size = info->size;
        static_cast<void>(taken(info, "info"));
        RelumineInfo whole = info_of(own);
        whole.size = size;
        std::memcpy(info, &whole, size);
    });
}

RelumineResult relumine_positions(const RelumineScene* scene, float* xyz, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        const bool are_vertices = prt::on_vertices(own.scene().layout);
        write(own, xyz, count, [&](std::size_t i) {
            return are_vertices ? own.scene().mesh.positions[i] : own.scene().receivers.places()[i];
        });
    });
}

RelumineResult relumine_normals(const RelumineScene* scene, float* xyz, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        write(own, xyz, count, [&](std::size_t i) { return own.scene().receivers.normals[i]; });
    });
}

RelumineResult relumine_triangles(const RelumineScene* scene, uint32_t* vertices, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        require(vertices, "vertices");
        require_count(count, 3 * own.scene().mesh.num_triangles());
        for (const mesh::Triangle& triangle : own.scene().mesh.triangles)
            vertices = std::copy(triangle.begin(), triangle.end(), vertices);
    });
}

RelumineResult relumine_places(const RelumineScene* scene, uint32_t* places, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        if (prt::on_vertices(own.scene().layout))
            throw RuntimeScene::NotThere{"pixels, texels or points, got a scene of vertices"};
        require(places, "places");
        require_count(count, own.num_receivers());
        const std::span<const std::uint32_t> own_places = prt::places(own.scene().layout);
        std::copy(own_places.begin(), own_places.end(), places);
    });
}

RelumineResult relumine_light_cube_map(RelumineScene* scene, uint32_t resolution,
                                       const float* rgb) {
    return with(scene, [&](RuntimeScene& own) { own.light(cube_map_of(resolution, rgb)); });
}

RelumineResult relumine_light_lat_long(RelumineScene* scene, uint32_t width, uint32_t height,
                                       uint32_t resolution, const float* rgb) {
    return with(scene,
                [&](RuntimeScene& own) { own.light(cube_map_of(width, height, resolution, rgb)); });
}

RelumineResult relumine_light_list(RelumineScene* scene, const RelumineLight* lights,
                                   size_t count) {
    return with(scene, [&](RuntimeScene& own) {
        if (count != 0)
            require(lights, "lights");
        std::vector<lights::DistantLight> list;
        for (const RelumineLight& light : std::span(lights, count))
            list.push_back(
                {.direction = {light.direction[0], light.direction[1], light.direction[2]},
                 .irradiance = {light.irradiance[0], light.irradiance[1], light.irradiance[2]}});
        own.light(list);
    });
}

RelumineResult relumine_turn(RelumineScene* scene, double degrees) {
    return with(scene, [&](RuntimeScene& own) { own.turn(degrees); });
}

RelumineResult relumine_turn_coarse(RelumineScene* scene, double degrees, uint32_t resolution) {
    return with(scene, [&](RuntimeScene& own) { own.turn(degrees, resolution); });
}

RelumineResult relumine_update(RelumineScene* scene, uint32_t face, uint32_t x, uint32_t y,
                               uint32_t width, uint32_t height, const float* rgb) {
    return with(scene, [&](RuntimeScene& own) {
        const cubemap::TexelRectangle rectangle = rectangle_of(face, x, y, width, height);
        if (rectangle.num_texels() != 0)
            require(rgb, "rgb");
        own.update(rectangle, vectors(rgb, rectangle.num_texels()));
    });
}

RelumineResult relumine_set_albedo(RelumineScene* scene, const float* rgb, size_t count) {
    return with(scene, [&](RuntimeScene& own) {
        require(rgb, "rgb");
        require_count(count, 3 * own.num_receivers());
        own.set_albedo(vectors(rgb, own.num_receivers()));
    });
}

RelumineResult relumine_bounce(RelumineScene* scene, const RelumineBounces* how) {
    return with(scene, [&](RuntimeScene& own) {
        RelumineBounces given = taken(how, "how");
        relight::BounceLimits limits;
        if (given.num_bounces != 0)
            limits.num_bounces = given.num_bounces;
        if (!(given.tolerance >= 0.0f && given.tolerance <= 1.0f))
            throw std::invalid_argument(
                fmt::format("tolerance: expected 0 to 1, got {}", given.tolerance));
        if (given.tolerance > 0.0f)
            limits.tolerance = given.tolerance;
        own.bounce(limits, given.is_step != 0);
    });
}

RelumineResult relumine_radiance(const RelumineScene* scene, float* rgb, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        own.require_light();
        write(own, rgb, count, [&](std::size_t i) { return own.radiance(i); });
    });
}

RelumineResult relumine_radiance_half(const RelumineScene* scene, uint16_t* rgb, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        own.require_light();
        require(rgb, "rgb");
        require_count(count, 3 * own.num_receivers());
        for (std::size_t i = 0; i < own.num_receivers(); ++i) {
            const glm::vec3 value = own.radiance(i);
            for (int channel = 0; channel < 3; ++channel)
                *rgb++ = glm::packHalf1x16(std::min(value[channel], files::LargestHalf));
        }
    });
}

RelumineResult relumine_harmonics(const RelumineScene* scene, float* rgb, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        const std::vector<glm::vec3> light = own.harmonics();
        require(rgb, "rgb");
        require_count(count, 3 * light.size());
        for (const glm::vec3& value : light)
            rgb = std::copy_n(&value.x, 3, rgb);
    });
}

RelumineResult relumine_visible_parts(const RelumineScene* scene, const float* xyz,
                                      size_t num_directions, float radius, uint8_t* parts,
                                      size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        // Directions beyond any use must not overflow the size of the array.
        constexpr std::size_t MostDirections = 65536;
        require(xyz, "xyz");
        require(parts, "parts");
        if (num_directions == 0 || num_directions > MostDirections)
            throw std::invalid_argument(
                fmt::format("expected 1 to {} directions, got {}", MostDirections, num_directions));
        if (count % num_directions != 0 || count / num_directions > own.num_receivers())
            throw std::invalid_argument(
                fmt::format("count: expected {} times at most {} receivers, got {}", num_directions,
                            own.num_receivers(), count));
        own.visible_parts(vectors(xyz, num_directions), radius, {parts, count});
    });
}

RelumineResult relumine_environment(const RelumineScene* scene, float* rgb, size_t count) {
    return with(scene, [&](const RuntimeScene& own) {
        own.require_environment();
        write_map(own.environment(), rgb, count);
    });
}

RelumineResult relumine_contribution(const RelumineScene* scene, uint32_t receiver, float* rgb,
                                     size_t count) {
    return with(
        scene, [&](const RuntimeScene& own) { write_map(own.contribution(receiver), rgb, count); });
}
