#include "prt/scene/bounce_sections.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace relumine::prt {

namespace {

const std::string Radius = "bounce_radius", Weights = "bounce_weights", Sizes = "bounce_sizes",
                  Columns = "bounce_columns";

/// Numbers below 2^7 take a byte, below 2^14 two, and so on: seven bits a byte, the lowest first,
/// the eighth set where more follow.
void append_number(std::vector<std::uint8_t>& bytes, std::uint32_t number) {
    for (; number >= 0x80u; number >>= 7u)
        bytes.push_back(static_cast<std::uint8_t>(number | 0x80u));
    bytes.push_back(static_cast<std::uint8_t>(number));
}

/// Reads such numbers one after the other.
class Numbers {
public:
    Numbers(const SectionReader& reader, const std::string& section)
        : reader_(reader), section_(section), bytes_(reader.elements<std::uint8_t>(section)) {}

    std::uint32_t next() {
        std::uint64_t number = 0;
        for (std::uint32_t shift = 0; shift < 35; shift += 7) {
            if (at_ == bytes_.size())
                break;
            const std::uint64_t byte = bytes_[at_++];
            number |= (byte & 0x7fu) << shift;
            if (byte < 0x80u && number <= 0xffffffffu)
                return static_cast<std::uint32_t>(number);
        }
        reader_.fail(section_, "columns of bounces");
    }
    [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }
    [[nodiscard]] std::size_t size() const { return bytes_.size(); }

private:
    const SectionReader& reader_;
    const std::string& section_;
    std::vector<std::uint8_t> bytes_;
    std::size_t at_ = 0;
};

} // namespace

void add_bounce_sections(Sections& sections, const BounceMatrix& matrix) {
    sections[Radius] = bytes_of(std::vector{matrix.spectral_radius});
    sections[Weights] = bytes_of(matrix.weights);
    std::vector<std::uint32_t> sizes;
    std::vector<std::uint8_t> columns;
    for (std::size_t place = 0; place < matrix.num_rows(); ++place) {
        const auto row = matrix.row(place);
        sizes.push_back(static_cast<std::uint32_t>(row.size()));
        std::uint32_t before = 0;
        for (const std::uint32_t column : row) {
            append_number(columns, column - before);
            before = column;
        }
    }
    sections[Sizes] = bytes_of(sizes);
    sections[Columns] = bytes_of(columns);
}

std::optional<BounceMatrix> read_bounces(const SectionReader& reader, std::size_t num_receivers) {
    if (!reader.has(Weights))
        return std::nullopt;
    BounceMatrix matrix;
    matrix.spectral_radius = reader.elements<float>(Radius, 1).front();
    matrix.weights = reader.elements<float>(Weights, num_receivers);
    const auto sizes = reader.elements<std::uint32_t>(Sizes, num_receivers);
    Numbers numbers(reader, Columns);
    matrix.row_begin.reserve(num_receivers + 1);
    std::uint64_t num_columns = 0;
    for (const std::uint32_t size : sizes)
        num_columns += size;
    // Each column takes a byte at least, so a size that lies allocates nothing.
    if (num_columns > numbers.size())
        reader.fail(Sizes, "as many columns as there are");
    matrix.columns.reserve(num_columns);
    for (const std::uint32_t size : sizes) {
        std::uint32_t column = 0;
        for (std::uint32_t i = 0; i < size; ++i) {
            const std::uint32_t step = numbers.next();
            if (step >= num_receivers - column)
                reader.fail(Columns, "columns that are receivers");
            column += step;
            matrix.columns.push_back(column);
        }
        matrix.row_begin.push_back(matrix.columns.size());
    }
    if (!numbers.at_end())
        reader.fail(Columns, "an end after the last row");
    try {
        require_bounces(matrix, num_receivers, num_receivers);
    } catch (const std::invalid_argument&) {
        reader.fail(Weights, "weights of bounces that keep at most all of the light");
    }
    return matrix;
}

} // namespace relumine::prt
