#include "prt/scene/section_format.h"

#include <cstring>
#include <vector>

#include "files/hash.h"

namespace relumine::prt {

std::uint64_t table_checksum(const SectionFileHeader& header, std::span<const SectionEntry> table) {
    std::vector<std::byte> bytes(offsetof(SectionFileHeader, checksum) + table.size_bytes());
    std::memcpy(bytes.data(), &header, offsetof(SectionFileHeader, checksum));
    if (!table.empty())
        std::memcpy(bytes.data() + offsetof(SectionFileHeader, checksum), table.data(),
                    table.size_bytes());
    return files::hash_of(bytes);
}

} // namespace relumine::prt
