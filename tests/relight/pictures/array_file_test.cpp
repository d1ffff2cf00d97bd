#include "relight/pictures/array_file.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "files/output_file.h"
#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"

namespace relumine::relight {
namespace {

namespace fs = std::filesystem;

using ArrayFileTest = tests::FolderTest;

// The layout is numpy's NEP 1: magic, version 1.0, 16-bit length, a Python dictionary padded with
// spaces, the data.
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
        EXPECT_EQ(description.find("{'descr': '<f4', 'fortran_order': False, 'shape': (" +
                                   std::to_string(n) + ", 3), }"),
                  0u);
        EXPECT_EQ(description.find_first_not_of(' ', description.find('}') + 1), length - 1);
        EXPECT_EQ(description.back(), '\n');
        if (n > 0) {
            EXPECT_EQ(std::memcmp(bytes.data() + 10 + length, values.data(), n * 12), 0);
        }
    }
}

/// A file as numpy would write it.
void write_npy(const fs::path& path, const std::string& start, std::string description,
               const std::string& data) {
    description += '\n';
    std::ofstream file(path, std::ios::binary);
    file << start << static_cast<char>(description.size()) << '\0';
    if (start[6] != '\1')
        file << '\0' << '\0';
    file << description << data;
}

const std::string Version1("\x93NUMPY\x01\x00", 8);
const std::string Version2("\x93NUMPY\x02\x00", 8);

template<class T>
std::string bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

TEST_F(ArrayFileTest, ReadsBackBitByBit) {
    std::vector<glm::vec3> values;
    for (int i = 0; i < 777; ++i)
        values.emplace_back(0.1f * static_cast<float>(i), -1e-30f, 1e30f);
    save_npy(folder_ / "a.npy", values);
    const VectorArray array = load_npy(folder_ / "a.npy");
    EXPECT_EQ(array.shape, std::vector<std::size_t>{777});
    EXPECT_EQ(array.values, values);
    save_npy(folder_ / "none.npy", {});
    EXPECT_TRUE(load_npy(folder_ / "none.npy").values.empty());
}

TEST_F(ArrayFileTest, ReadsOtherShapesAndDoubles) {
    const fs::path path = folder_ / "a.npy";
    write_npy(path, Version2, "{'shape': (2, 1, 3), 'fortran_order': False, 'descr': '<f8'}",
              bytes_of(std::vector<double>{1, 2, 3, 4, 5, 6}));
    const VectorArray array = load_npy(path);
    EXPECT_EQ(array.shape, (std::vector<std::size_t>{2, 1}));
    EXPECT_EQ(array.values, (std::vector{glm::vec3(1, 2, 3), glm::vec3(4, 5, 6)}));
}

TEST_F(ArrayFileTest, RefusesWhatItDoesNotRead) {
    const fs::path path = folder_ / "a.npy";
    const std::string six = bytes_of(std::vector<float>(6));
    const auto refused = [&](const std::string& start, const std::string& description,
                             const std::string& data, const char* words) {
        write_npy(path, start, description, data);
        scenes::expect_refused(path, words, [&] { static_cast<void>(load_npy(path)); });
    };
    const std::string good = "{'descr': '<f4', 'fortran_order': False, 'shape': (2, 3), }";
    write_npy(path, Version1, good, six);
    EXPECT_EQ(load_npy(path).values.size(), 2u);
    refused("\x93NUMPX\x01 ", good, six, "expected a .npy file");
    refused(std::string("\x93NUMPY\x04\x00", 8), good, six, "expected a .npy file");
    refused(Version1, "{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3), }", six,
            "float32 or float64");
    refused(Version1, "{'descr': '<f4', 'fortran_order': True, 'shape': (2, 3), }", six, "C order");
    refused(Version1, "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2), }", six,
            "last axis is 3");
    refused(Version1, "{'descr': '<f4', 'fortran_order': False, 'shape': (), }", six,
            "last axis is 3");
    refused(Version1, "{'fortran_order': False, 'shape': (2, 3), }", six, "one number type");
    refused(Version1, good, six.substr(1), "expected 24 bytes of values, got 23");
    refused(Version1, good, six + "x", "expected 24 bytes of values, got 25");
    refused(Version1,
            "{'descr': '<f4', 'fortran_order': False, 'shape': (999999999999999999, "
            "999999999999999999, 3), }",
            six, "that memory can hold");
    std::ofstream(path, std::ios::binary) << Version1 << "\xff\xff{  ";
    scenes::expect_refused(path, "expected a description",
                           [&] { static_cast<void>(load_npy(path)); });
}

TEST_F(ArrayFileTest, UnwritablePlacesLeaveNothing) {
    const fs::path missing = folder_ / "missing" / "values.npy";
    scenes::expect_refused(missing, "cannot write", [&] { save_npy(missing, {}); });
    EXPECT_TRUE(fs::is_empty(folder_));
}

} // namespace
} // namespace relumine::relight
