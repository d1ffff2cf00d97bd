#include "cubemap/image/image_size.h"

#include <algorithm>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "cubemap/image/image_file.h"
#include "files/output_file.h"

namespace relumine::cubemap {

namespace {

ImageSize size_of_file(const std::filesystem::path& path) {
    FileHead head{.path = path,
                  .bytes = {},
                  .num_bytes = files::size(path)}; // refuses a missing file and a folder
    head.bytes.resize(std::min(head.num_bytes, MaxHeadBytes));
    std::ifstream file(path, std::ios::binary);
    file.read(reinterpret_cast<char*>(head.bytes.data()),
              static_cast<std::streamsize>(head.bytes.size()));
    if (!file)
        throw std::runtime_error(fmt::format("{}: cannot read", path.string()));
    return format_of(head.bytes, path).size(head);
}

} // namespace

ImageSize read_image_size(const std::filesystem::path& path) {
    const std::vector<std::filesystem::path> files = environment_files(path);
    ImageSize size = size_of_file(files.front());
    if (files.size() == 1)
        return size;
    // Six faces become one cube.
    for (const std::filesystem::path& file : files)
        if (const ImageSize other = size_of_file(file); other != size)
            throw std::runtime_error(fmt::format("{}: expected {}x{} as the first face, got {}x{}",
                                                 file.string(), size.width, size.height,
                                                 other.width, other.height));
    size.height *= static_cast<std::uint32_t>(files.size());
    return size;
}

} // namespace relumine::cubemap
