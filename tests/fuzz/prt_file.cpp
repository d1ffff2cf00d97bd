#include "tests/fuzz/prt_file.h"

#include <cstring>

#include <xxhash.h>

namespace relumine::fuzz {

namespace {

// Where things are in the file: docs/prt-format.md.
constexpr std::size_t FileSizeAt = 16, NumSectionsAt = 24, ChecksumAt = 32, HeaderSize = 40,
                      EntrySize = 48;

std::uint64_t number_at(const std::vector<std::byte>& file, std::size_t at, std::size_t num_bytes) {
    std::uint64_t value = 0;
    std::memcpy(&value, file.data() + at, num_bytes);
    return value;
}

void put(std::vector<std::byte>& file, std::size_t at, std::uint64_t value) {
    std::memcpy(file.data() + at, &value, sizeof value);
}

} // namespace

std::vector<std::byte> with_checksums(std::span<const std::byte> input) {
    std::vector<std::byte> file(input.begin(), input.end());
    if (file.size() < HeaderSize)
        return file;
    put(file, FileSizeAt, file.size());
    const std::uint64_t num_sections = number_at(file, NumSectionsAt, 4);
    if (num_sections > (file.size() - HeaderSize) / EntrySize)
        return file;
    for (std::size_t i = 0; i < num_sections; ++i) {
        const std::size_t entry = HeaderSize + i * EntrySize;
        const std::uint64_t offset = number_at(file, entry + 16, 8),
                            size = number_at(file, entry + 24, 8);
        if (offset <= file.size() && size <= file.size() - offset)
            put(file, entry + 40, XXH64(file.data() + offset, size, 0));
    }
    std::vector<std::byte> table(file.begin(), file.begin() + ChecksumAt);
    table.insert(table.end(), file.begin() + HeaderSize,
                 file.begin() + static_cast<std::ptrdiff_t>(HeaderSize + num_sections * EntrySize));
    put(file, ChecksumAt, XXH64(table.data(), table.size(), 0));
    return file;
}

} // namespace relumine::fuzz
