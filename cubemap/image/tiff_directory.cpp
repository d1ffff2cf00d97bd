#include "cubemap/image/tiff_directory.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace relumine::cubemap::tiff {

namespace {

/// Returns the bytes of one value; 0 for an unknown type.
std::size_t size_of(std::uint16_t type) {
    constexpr std::array<std::uint8_t, 19> Sizes = {0, 1, 1, 2, 4, 8, 1, 1, 2, 4,
                                                    8, 4, 8, 4, 0, 0, 8, 8, 8};
    return type < Sizes.size() ? Sizes[type] : 0;
}

} // namespace

Directory::Directory(const FileBytes& file) : file_(file) {
    const Fields start(file, file.read(0, std::min<std::uint64_t>(file.size(), 16)));
    is_big_endian_ = start.number(0, 1) == 'M';
    const Fields head(file, start.bytes(), is_big_endian_);
    is_big_tiff_ = head.u16(2) == 43;
    const std::uint64_t at = is_big_tiff_ ? head.number(8, 8) : head.number(4, 4);
    if (at == 0)
        file.refuse("a TIFF picture", "a file that was not finished");
    const std::size_t count_bytes = is_big_tiff_ ? 8 : 2;
    const std::size_t entry_bytes = is_big_tiff_ ? 20 : 12;
    const std::uint64_t count =
        Fields(file, file.read(at, count_bytes), is_big_endian_).number(0, count_bytes);
    constexpr std::uint64_t MostFields = 4096;
    if (count > MostFields)
        file.refuse(fmt::format("up to {} fields", MostFields), fmt::format("{}", count));
    const std::size_t offset_bytes = is_big_tiff_ ? 8 : 4;
    const Fields entries(file, file.read(at + count_bytes, count * entry_bytes), is_big_endian_);
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::uint64_t entry = i * entry_bytes;
        fields_.emplace(entries.u16(entry),
                        Field{.type = entries.u16(entry + 2),
                              .count = entries.number(entry + 4, offset_bytes),
                              .value_at = at + count_bytes + entry + 4 + offset_bytes,
                              .offset = entries.number(entry + 4 + offset_bytes, offset_bytes)});
    }
}

std::vector<std::uint64_t> Directory::numbers(Tag tag) const {
    const Fields bytes(file_, bytes_of(tag), is_big_endian_);
    const std::size_t size = has(tag) ? size_of(fields_.at(tag).type) : 1;
    std::vector<std::uint64_t> result(bytes.bytes().size() / size);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = bytes.number(i * size, size);
    return result;
}

std::uint64_t Directory::number(Tag tag, std::uint64_t otherwise) const {
    const std::vector<std::uint64_t> all = numbers(tag);
    return all.empty() ? otherwise : all.front();
}

std::vector<double> Directory::fractions(Tag tag) const {
    constexpr std::uint16_t Rational = 5;
    if (!has(tag) || fields_.at(tag).type != Rational)
        return {};
    const Fields bytes(file_, bytes_of(tag), is_big_endian_);
    std::vector<double> result(bytes.bytes().size() / 8);
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = bytes.u32(8 * i) / static_cast<double>(bytes.u32(8 * i + 4));
    return result;
}

std::vector<std::byte> Directory::bytes_of(Tag tag) const {
    if (!has(tag))
        return {};
    const Field& field = fields_.at(tag);
    const std::size_t size = size_of(field.type);
    if (size == 0 || field.count > file_.size() / size)
        file_.refuse("fields that lie in the file",
                     fmt::format("tag {} of type {} and {} values", static_cast<unsigned>(tag),
                                 field.type, field.count));
    const std::uint64_t num_bytes = field.count * size;
    return file_.read(num_bytes <= (is_big_tiff_ ? 8U : 4U) ? field.value_at : field.offset,
                      num_bytes);
}

} // namespace relumine::cubemap::tiff
