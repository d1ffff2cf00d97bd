// Files that are damaged, and what the error about one must look like.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace relumine::scenes {

/// Changes one byte in place.
inline void put_byte(const std::filesystem::path& path, std::size_t at, std::byte value) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(at));
    file.put(static_cast<char>(value));
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
