#include "files/hash.h"

#include <xxhash.h>

#include "files/output_file.h"

namespace relumine::files {

std::uint64_t hash_of(std::span<const std::byte> bytes, std::uint64_t seed) {
    return XXH64(bytes.data(), bytes.size(), seed);
}

std::uint64_t file_hash(const std::filesystem::path& path) {
    return hash_of(read(path));
}

} // namespace relumine::files
