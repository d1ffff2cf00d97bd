#include "relight/array_file.h"

#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/output_file.h"
#include "tests/prt/damaged_file.h"

namespace relumine::relight {
namespace {

namespace fs = std::filesystem;

class ArrayFileTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("array_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

// The layout is numpy's NEP 1: magic, version 1.0, 16-bit length, a Python dictionary padded with spaces, the data.
TEST_F(ArrayFileTest, IsNumpysFormat) {
    for (const std::size_t n : {0u, 1u, 9u, 10u, 12345u}) {
        std::vector<glm::vec3> values;
        for (std::size_t i = 0; i < n; ++i)
            values.emplace_back(i, -0.5f, 1e-20f);
        const fs::path path = folder_ / "values.npy";
        save_npy(path, values);
        const std::vector<std::byte> bytes = files::read(path);
        ASSERT_GT(bytes.size(), 64u);
        EXPECT_EQ(std::memcmp(bytes.data(), "\x93NUMPY\x01\x00", 8), 0);
        const std::size_t length =
            std::to_integer<std::size_t>(bytes[8]) + 256 * std::to_integer<std::size_t>(bytes[9]);
        EXPECT_EQ((10 + length) % 64, 0u);
        ASSERT_EQ(bytes.size(), 10 + length + n * 12);
        const std::string description(reinterpret_cast<const char*>(bytes.data()) + 10, length);
        EXPECT_EQ(description.find("{'descr': '<f4', 'fortran_order': False, 'shape': (" + std::to_string(n) +
                                   ", 3), }"),
                  0u);
        EXPECT_EQ(description.find_first_not_of(' ', description.find('}') + 1), length - 1);
        EXPECT_EQ(description.back(), '\n');
        if (n > 0) {
            EXPECT_EQ(std::memcmp(bytes.data() + 10 + length, values.data(), n * 12), 0);
        }
    }
}

TEST_F(ArrayFileTest, UnwritablePlacesLeaveNothing) {
    const fs::path missing = folder_ / "missing" / "values.npy";
    scenes::expect_refused(missing, "cannot write", [&] { save_npy(missing, {}); });
    EXPECT_TRUE(fs::is_empty(folder_));
}

} // namespace
} // namespace relumine::relight
