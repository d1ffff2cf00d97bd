// Files that are damaged, and what the error about one must look like.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <xxhash.h>

namespace relumine::scenes {

/// Changes one byte in place.
inline void put_byte(const std::filesystem::path& path, std::size_t at, std::byte value) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(value));
}

/// Makes a .prt file one of another version: the number in its header, and the header's checksum.
inline void sign_as_version(const std::filesystem::path& path, std::uint32_t version) {
    constexpr std::streamoff VersionAt = 12, NumSectionsAt = 24, ChecksumAt = 32, TableAt = 40;
    constexpr std::size_t EntrySize = 48;
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    const auto put = [&](std::streamoff at, const auto& number) {
        file.seekp(at);
        file.write(reinterpret_cast<const char*>(&number), sizeof number);
    };
    const auto get = [&](std::streamoff at, std::size_t size) {
        std::string bytes(size, '\0');
        file.seekg(at);
        file.read(bytes.data(), static_cast<std::streamsize>(size));
        return bytes;
    };
    put(VersionAt, version);
    std::uint32_t num_sections = 0;
    std::memcpy(&num_sections, get(NumSectionsAt, 4).data(), 4);
    const std::string head = get(0, ChecksumAt) + get(TableAt, num_sections * EntrySize);
    put(ChecksumAt, std::uint64_t{XXH64(head.data(), head.size(), 0)});
}

/// `action` throws std::runtime_error with one line that begins with the path and holds `reason`.
template<typename Action>
void expect_refused(const std::filesystem::path& path, const std::string& reason,
                    const Action& action) {
    try {
        action();
        ADD_FAILURE() << "accepted; expected: " << reason;
    } catch (const std::runtime_error& error) {
        const std::string message = error.what();
        EXPECT_EQ(message.find(path.string() + ": "), 0u) << message;
        EXPECT_NE(message.find(reason), std::string::npos) << message << "\nlacks: " << reason;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

} // namespace relumine::scenes
