#include "relight/array_file.h"

#include <bit>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace relumine::relight {

namespace {

/// What stands before the numbers. `shape` as Python writes it: "(7, 3)".
std::string npy_header(const std::string& shape) {
    static_assert(std::endian::native == std::endian::little && sizeof(glm::vec3) == 3 * sizeof(float));
    // Magic, version, length of the description; the data begins at a multiple of 64 bytes (NEP 1).
    constexpr std::size_t PrefixSize = 10;
    constexpr std::size_t Alignment = 64;
    std::string description = fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}", shape);
    while ((PrefixSize + description.size() + 1) % Alignment != 0)
        description += ' ';
    description += '\n';

    std::string header("\x93NUMPY\x01\x00", 8);
    header += static_cast<char>(description.size() & 0xff);
    header += static_cast<char>(description.size() >> 8);
    header += description;
    return header;
}

} // namespace

void save_npy(const std::filesystem::path& path, std::span<const glm::vec3> values) {
    const std::string header = npy_header(fmt::format("({}, 3)", values.size()));
    std::vector<std::byte> bytes(header.size() + values.size_bytes());
    std::memcpy(bytes.data(), header.data(), header.size());
    if (!values.empty())
        std::memcpy(bytes.data() + header.size(), values.data(), values.size_bytes());

    files::OutputFile file(path);
    file.write(bytes);
    file.commit();
}

NpyFrames::NpyFrames(const std::filesystem::path& path, std::size_t num_frames, std::size_t num_values)
    : file_(path), stream_(file_.temporary(), std::ios::binary | std::ios::trunc), frames_left_(num_frames),
      num_values_(num_values) {
    const std::string header = npy_header(fmt::format("({}, {}, 3)", num_frames, num_values));
    stream_.write(header.data(), static_cast<std::streamsize>(header.size()));
}

void NpyFrames::append(std::span<const glm::vec3> values) {
    if (values.size() != num_values_ || frames_left_ == 0)
        throw std::invalid_argument("expected as many values and frames as were stated");
    --frames_left_;
    stream_.write(reinterpret_cast<const char*>(values.data()),
                  static_cast<std::streamsize>(values.size_bytes()));
    stream_.flush();
    if (!stream_)
        throw std::runtime_error(
            fmt::format("{}: cannot write: {}", file_.target().string(), std::strerror(errno)));
}

void NpyFrames::commit() {
    if (frames_left_ != 0)
        throw std::invalid_argument("expected all frames before the file is complete");
    stream_.close();
    if (!stream_)
        throw std::runtime_error(
            fmt::format("{}: cannot write: {}", file_.target().string(), std::strerror(errno)));
    file_.commit();
}

} // namespace relumine::relight
