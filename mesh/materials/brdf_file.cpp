// Reads tables of the MERL database: three counts of four bytes, then doubles, red, green and blue,
// each [theta_h][theta_d][phi_d] with half a turn of phi_d.
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "files/output_file.h"
#include "mesh/materials/brdf_table.h"

namespace relumine::mesh {

namespace {

constexpr std::size_t NumFileAzimuth = 2 * BrdfTable::NumAzimuth;
constexpr std::size_t NumPerColor = BrdfTable::NumHalf * BrdfTable::NumDifference * NumFileAzimuth;
/// The unit of the file's numbers.
constexpr std::array<double, 3> Scales = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

constexpr std::size_t HeaderBytes = 3 * sizeof(std::int32_t);
constexpr std::size_t ValueBytes = 3 * NumPerColor * sizeof(double);

/// Refuses a file by its first bytes and its size, before memory is taken for its values.
void check_header(const std::vector<std::byte>& header, std::size_t file_size) {
    if (header.size() < HeaderBytes)
        throw std::invalid_argument(
            fmt::format("expected a table of a BRDF, got {} bytes", header.size()));
    std::array<std::int32_t, 3> sides{};
    std::memcpy(sides.data(), header.data(), HeaderBytes);
    if (sides !=
        std::array<std::int32_t, 3>{BrdfTable::NumHalf, BrdfTable::NumDifference, NumFileAzimuth})
        throw std::invalid_argument(fmt::format(
            "expected {} x {} x {} values for each colour, got {} x {} x {}", BrdfTable::NumHalf,
            BrdfTable::NumDifference, NumFileAzimuth, sides[0], sides[1], sides[2]));
    if (file_size != HeaderBytes + ValueBytes)
        throw std::invalid_argument(
            fmt::format("expected {} bytes, got {}", HeaderBytes + ValueBytes, file_size));
}

/// Returns the values behind the header, as BrdfTable takes them.
std::vector<float> values_of(const std::vector<std::byte>& bytes) {
    if (bytes.size() != ValueBytes) // a file that shrank meanwhile
        throw std::invalid_argument(fmt::format(
            "expected {} bytes, got {}", HeaderBytes + ValueBytes, HeaderBytes + bytes.size()));
    const auto value = [&](std::size_t color, std::size_t row, std::size_t azimuth) {
        double number = 0.0;
        const std::size_t index = color * NumPerColor + row * NumFileAzimuth + azimuth;
        std::memcpy(&number, bytes.data() + index * sizeof number, sizeof number);
        return number * Scales[color];
    };
    std::vector<float> values;
    values.reserve(3 * BrdfTable::NumPlaces);
    for (std::size_t color = 0; color < 3; ++color)
        for (std::size_t row = 0; row < BrdfTable::NumHalf * BrdfTable::NumDifference; ++row)
            for (std::size_t a = 0; a < BrdfTable::NumAzimuth; ++a)
                values.push_back(static_cast<float>(
                    0.5 * (value(color, row, a) + value(color, row, NumFileAzimuth - 1 - a))));
    return values;
}

} // namespace

std::shared_ptr<const BrdfTable> load_brdf(const std::filesystem::path& path) {
    const std::size_t file_size = files::size(path);
    const std::vector<std::byte> header = files::read(path, 0, HeaderBytes);
    try {
        check_header(header, file_size);
        return std::make_shared<const BrdfTable>(
            values_of(files::read(path, HeaderBytes, ValueBytes)));
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace relumine::mesh
