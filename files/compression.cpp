#include "files/compression.h"

#include <stdexcept>

#include <fmt/format.h>
#include <zstd.h>

namespace relumine::files {

std::vector<std::byte> compressed(std::span<const std::byte> bytes, int level) {
    std::vector<std::byte> result(ZSTD_compressBound(bytes.size()));
    const std::size_t size =
        ZSTD_compress(result.data(), result.size(), bytes.data(), bytes.size(), level);
    if (ZSTD_isError(size) != 0)
        throw std::runtime_error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
    result.resize(size);
    result.shrink_to_fit(); // many are kept side by side
    return result;
}

bool decompress(std::span<const std::byte> from, std::span<std::byte> to) {
    return ZSTD_decompress(to.data(), to.size(), from.data(), from.size()) == to.size();
}

} // namespace relumine::files
