#include "cubemap/resample/save_environment.h"

#include "cubemap/resample/resample.h"
#include "files/output_file.h"

namespace relumine::cubemap {

void save_environment(const std::filesystem::path& path, const CubeMap& map, Layout layout) {
    check_environment_name(path);
    const ImageSize size = natural_size(layout, map.resolution);
    for (const std::filesystem::path& each : environment_files(path))
        files::OutputFile{each}; // finds a path that cannot be written before the work
    save_image(path,
               to_image(map, layout, size.width, size.height, default_sampling(path, layout)));
}

} // namespace relumine::cubemap
