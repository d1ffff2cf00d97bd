#include "files/packed_parts.h"

#include <zstd.h>

#include "files/compression.h"
#include "files/parallel.h"

namespace relumine::files {

namespace {

// The fastest level. Planes of bits of neighbouring directions shrink well at any level, and a
// checkpoint is read at most once.
constexpr int CompressionLevel = 1;

} // namespace

std::vector<std::byte> pack(std::size_t num_parts,
                            const std::function<std::vector<std::byte>(std::size_t)>& part) {
    std::vector<std::vector<std::byte>> parts(num_parts);
    files::parallel_for(std::size_t{0}, num_parts,
                        [&](std::size_t i) { parts[i] = compressed(part(i), CompressionLevel); });
    return joined_parts(std::vector<std::span<const std::byte>>(parts.begin(), parts.end()));
}

std::vector<std::byte> joined_parts(std::span<const std::span<const std::byte>> parts) {
    std::size_t num_bytes = sizeof(std::uint64_t) * (1 + parts.size());
    for (const std::span<const std::byte> bytes : parts)
        num_bytes += bytes.size();
    std::vector<std::byte> result(num_bytes);
    std::byte* at = result.data();
    const auto put = [&at](const void* bytes, std::size_t size) {
        if (size != 0)
            std::memcpy(at, bytes, size);
        at += size;
    };
    const std::uint64_t count = parts.size();
    put(&count, sizeof count);
    for (const std::span<const std::byte> bytes : parts) {
        const std::uint64_t size = bytes.size();
        put(&size, sizeof size);
        put(bytes.data(), bytes.size());
    }
    return result;
}

std::vector<std::span<const std::byte>> packed_parts(std::span<const std::byte> packed) {
    const auto take = [&packed](std::uint64_t size) {
        if (size > packed.size())
            throw std::runtime_error("expected more bytes");
        const std::span<const std::byte> taken = packed.first(size);
        packed = packed.subspan(size);
        return taken;
    };
    const auto number = [&take] {
        std::uint64_t value = 0;
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    };
    std::vector<std::span<const std::byte>> parts;
    for (std::uint64_t count = number(); count > 0; --count)
        parts.push_back(take(number()));
    if (!packed.empty())
        throw std::runtime_error("expected fewer bytes");
    return parts;
}

void unpack(std::span<const std::byte> packed,
            const std::function<void(std::span<const std::byte>)>& on_part) {
    std::vector<std::byte> part;
    for (const std::span<const std::byte> stored : packed_parts(packed)) {
        const std::uint64_t size = ZSTD_getFrameContentSize(stored.data(), stored.size());
        if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN ||
            size / MaxCompressionRatio > stored.size())
            throw std::runtime_error("expected zstd data");
        part.resize(size);
        if (ZSTD_decompress(part.data(), part.size(), stored.data(), stored.size()) != size)
            throw std::runtime_error("expected zstd data");
        on_part(part);
    }
}

} // namespace relumine::files
