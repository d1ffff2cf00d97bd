#include "relight/array_file.h"

#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "files/output_file.h"

namespace relumine::relight {

void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> values) {
    static_assert(std::endian::native == std::endian::little && sizeof(glm::vec3) == 3 * sizeof(float));
    // Magic, version, length of the description; the data begins at a multiple of 64 bytes (NEP 1).
    constexpr std::size_t PrefixSize = 10;
    constexpr std::size_t Alignment = 64;
    std::string description =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': ({}, 3), }}", values.size());
    while ((PrefixSize + description.size() + 1) % Alignment != 0)
        description += ' ';
    description += '\n';

    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(description.size() & 0xff);
    header += static_cast<char>(description.size() >> 8);
    header += description;
    std::vector<std::byte> bytes(header.size() + values.size_bytes());
    std::memcpy(bytes.data(), header.data(), header.size());
    if (!values.empty())
        std::memcpy(bytes.data() + header.size(), values.data(), values.size_bytes());

    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

} // namespace relumine::relight
