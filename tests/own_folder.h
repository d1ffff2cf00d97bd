// A folder for the files of one test, and the messages of calls that fail.
#pragma once

#include <unistd.h>

#include <algorithm>
#include <exception>
#include <filesystem>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

namespace relumine::tests {

/// A path of this test's own.
inline std::filesystem::path folder_of_test() {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string("relumine_") + test.test_suite_name() + "_" + test.name() + "_" +
                       std::to_string(::getpid());
    std::replace(name.begin(), name.end(), '/', '_');
    return std::filesystem::path(testing::TempDir()) / name;
}

/// A test with a folder: empty at first, gone afterwards.
class FolderTest : public testing::Test {
protected:
    FolderTest() {
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    ~FolderTest() override {
        std::error_code ignored;
        std::filesystem::remove_all(folder_, ignored);
    }

    [[nodiscard]] std::size_t num_files() const {
        return static_cast<std::size_t>(
            std::distance(std::filesystem::directory_iterator(folder_), {}));
    }

    const std::filesystem::path folder_ = folder_of_test();
};

/// Returns what the std::exception says that a call throws; nothing where it throws none.
template<typename Call>
std::string message_of(const Call& call) {
    try {
        call();
    } catch (const std::exception& error) {
        return error.what();
    }
    return {};
}

} // namespace relumine::tests
