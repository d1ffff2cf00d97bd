#include "relight/pictures/array_file.h"

#include <bit>
#include <cstring>
#include <limits>
#include <regex>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace relumine::relight {

namespace {

/// Returns the bytes before the numbers. `shape` is as Python writes it: "(7, 3)".
std::string npy_header(const std::string& shape) {
    static_assert(std::endian::native == std::endian::little &&
                  sizeof(glm::vec3) == 3 * sizeof(float));
    // Magic, version, length of the description. The data begins at a multiple of 64 bytes (NEP 1).
    constexpr std::size_t PrefixSize = 10;
    constexpr std::size_t Alignment = 64;
    std::string description =
        fmt::format("{{'descr': '<f4', 'fortran_order': False, 'shape': {}, }}", shape);
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

NpyFrames::NpyFrames(const std::filesystem::path& path, std::size_t num_frames,
                     std::size_t num_values)
    : file_(path), frames_left_(num_frames), num_values_(num_values) {
    const std::string header = npy_header(fmt::format("({}, {}, 3)", num_frames, num_values));
    file_.expect(header.size() + num_frames * num_values * sizeof(glm::vec3));
    file_.append(std::as_bytes(std::span(header)));
}

void NpyFrames::append(std::span<const glm::vec3> values) {
    if (values.size() != num_values_ || frames_left_ == 0)
        throw std::invalid_argument("expected as many values and frames as were stated");
    --frames_left_;
    file_.append(std::as_bytes(values));
}

void NpyFrames::commit() {
    if (frames_left_ != 0)
        throw std::invalid_argument("expected all frames before the file is complete");
    file_.commit();
}

namespace {

/// The file's description: a Python dictionary of three entries in any order.
struct Description {
    bool is_double = false;
    /// With the last axis.
    std::vector<std::size_t> shape;
};

std::string entry(const std::string& text, const char* pattern, const std::filesystem::path& path,
                  const char* expected) {
    std::smatch match;
    if (!std::regex_search(text, match, std::regex(pattern)))
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path.string(), expected, text.substr(0, 100)));
    return match[1];
}

Description described(std::string text, const std::filesystem::path& path) {
    while (!text.empty() && (text.back() == '\n' || text.back() == ' '))
        text.pop_back();
    Description result;
    const std::string type =
        entry(text, "'descr' *: *'([<>|=]?[a-z][0-9]+)'", path, "a .npy file of one number type");
    if (type != "<f4" && type != "<f8")
        throw std::runtime_error(fmt::format(
            "{}: expected float32 or float64 ('<f4', '<f8'), got '{}'", path.string(), type));
    result.is_double = type == "<f8";
    if (entry(text, "'fortran_order' *: *(True|False)", path, "'fortran_order'") != "False")
        throw std::runtime_error(
            fmt::format("{}: expected values in C order, got Fortran order", path.string()));
    const std::string shape =
        entry(text, "'shape' *: *\\(([0-9, ]*)\\)", path, "a 'shape' of whole numbers");
    const std::regex number("[0-9]{1,18}");
    for (auto it = std::sregex_iterator(shape.begin(), shape.end(), number);
         it != std::sregex_iterator(); ++it)
        result.shape.push_back(std::stoull(it->str()));
    if (result.shape.empty() || result.shape.back() != 3)
        throw std::runtime_error(fmt::format("{}: expected a shape whose last axis is 3, got ({})",
                                             path.string(), shape));
    return result;
}

} // namespace

VectorArray load_npy(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = files::read(path);
    const auto byte = [&](std::size_t i) {
        return std::to_integer<std::size_t>(bytes[i]);
    };
    // Magic, two bytes of version, length of the description in 2 bytes (version 1) or 4.
    if (bytes.size() < 12 || std::memcmp(bytes.data(), "\x93NUMPY", 6) != 0 || byte(6) < 1 ||
        byte(6) > 3)
        throw std::runtime_error(
            fmt::format("{}: expected a .npy file of version 1 to 3, got {} other bytes",
                        path.string(), bytes.size()));
    const bool is_short = byte(6) == 1;
    const std::size_t begin = is_short ? 10 : 12;
    const std::size_t length =
        byte(8) | byte(9) << 8 | (is_short ? 0 : byte(10) << 16 | byte(11) << 24);
    if (length > bytes.size() - begin)
        throw std::runtime_error(fmt::format("{}: expected a description of {} bytes, got {}",
                                             path.string(), length, bytes.size() - begin));
    std::string text(length, ' ');
    std::memcpy(text.data(), bytes.data() + begin, length);
    const Description description = described(std::move(text), path);

    const std::size_t element = description.is_double ? sizeof(double) : sizeof(float);
    const std::size_t got = bytes.size() - begin - length;
    std::size_t count = 1; // numbers in the array
    for (const std::size_t axis : description.shape) {
        if (axis != 0 && count > std::numeric_limits<std::size_t>::max() / element / axis)
            throw std::runtime_error(
                fmt::format("{}: expected a shape that memory can hold, got an axis of {}",
                            path.string(), axis));
        count *= axis;
    }
    if (got != count * element)
        throw std::runtime_error(fmt::format("{}: expected {} bytes of values, got {}",
                                             path.string(), count * element, got));
    VectorArray result{.shape = {description.shape.begin(), description.shape.end() - 1},
                       .values = std::vector<glm::vec3>(count / 3)};
    const std::byte* const data = bytes.data() + begin + length;
    for (std::size_t i = 0; i < count; ++i) {
        float& value = result.values[i / 3][static_cast<glm::vec3::length_type>(i % 3)];
        if (description.is_double) {
            double wide = 0.0;
            std::memcpy(&wide, data + i * sizeof(double), sizeof(double));
            value = static_cast<float>(wide);
        } else {
            std::memcpy(&value, data + i * sizeof(float), sizeof(float));
        }
    }
    return result;
}

} // namespace relumine::relight
