#include "relumine/environment.h"

#include <chrono>
#include <memory>

#include "cubemap/resample/resample.h"

namespace relumine {

cubemap::EnvironmentImage load_environment_image(const std::filesystem::path& path,
                                                 const EnvironmentOptions& options) {
    return cubemap::load_environment(
        path, {.layout = options.layout, .fix_bad_pixels = options.fix_bad_pixels});
}

cubemap::CubeMap cube_map_of(const cubemap::EnvironmentImage& image,
                             const EnvironmentOptions& options) {
    const std::uint32_t resolution =
        options.face_resolution != 0 ? options.face_resolution : cubemap::natural_resolution(image);
    cubemap::CubeMap map = cubemap::resample(image, resolution);
    if (options.rotate_degrees != 0.0)
        map = cubemap::rotated(map, options.rotate_degrees);
    return map;
}

Environment load_environment(const std::filesystem::path& path, const EnvironmentOptions& options) {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    const auto image =
        std::make_shared<const cubemap::EnvironmentImage>(load_environment_image(path, options));
    const Clock::time_point loaded = Clock::now();
    Environment result{
        .map = cube_map_of(*image, options),
        .file = {.image = image, .turn = cubemap::turn_about_y(options.rotate_degrees)},
        .assumptions = image->assumptions};
    result.num_fixed_pixels = image->fixed ? image->bad_pixels.count() : 0;
    result.seconds_load = std::chrono::duration<double>(loaded - start).count();
    result.seconds_resample = std::chrono::duration<double>(Clock::now() - loaded).count();
    return result;
}

} // namespace relumine
