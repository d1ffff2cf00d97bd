// Reads tables of the MERL database: three counts of four bytes, then doubles, red, green and blue,
// each [theta_h][theta_d][phi_d] with half a turn of phi_d.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/output_file.h"
#include "mesh/materials/brdf_table.h"

namespace relumine::mesh {

namespace {

constexpr std::size_t NumFileAzimuth = 2 * BrdfTable::NumAzimuth;
constexpr std::size_t NumPerColor = BrdfTable::NumHalf * BrdfTable::NumDifference * NumFileAzimuth;
/// The unit of the file's numbers.
constexpr std::array<double, 3> Scales = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

std::vector<float> values_of(const std::vector<std::byte>& bytes) {
    std::array<std::int32_t, 3> sides{};
    if (bytes.size() < sizeof sides)
        throw std::invalid_argument(
            fmt::format("expected a table of a BRDF, got {} bytes", bytes.size()));
    std::memcpy(sides.data(), bytes.data(), sizeof sides);
    if (sides !=
        std::array<std::int32_t, 3>{BrdfTable::NumHalf, BrdfTable::NumDifference, NumFileAzimuth})
        throw std::invalid_argument(fmt::format(
            "expected {} x {} x {} values for each colour, got {} x {} x {}", BrdfTable::NumHalf,
            BrdfTable::NumDifference, NumFileAzimuth, sides[0], sides[1], sides[2]));
    const std::size_t expected = sizeof sides + 3 * NumPerColor * sizeof(double);
    if (bytes.size() != expected)
        throw std::invalid_argument(
            fmt::format("expected {} bytes, got {}", expected, bytes.size()));
    const auto value = [&](std::size_t color, std::size_t row, std::size_t azimuth) {
        double number = 0.0;
        const std::size_t index = color * NumPerColor + row * NumFileAzimuth + azimuth;
        std::memcpy(&number, bytes.data() + sizeof sides + index * sizeof number, sizeof number);
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
    const std::vector<std::byte> bytes = files::read(path);
    try {
        return std::make_shared<const BrdfTable>(values_of(bytes));
    } catch (const std::invalid_argument& error) {
        throw std::runtime_error(fmt::format("{}: {}", path.string(), error.what()));
    }
}

} // namespace relumine::mesh
