#include "files/append_log.h"

#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "files/output_file.h"

namespace relumine::files {
namespace {

namespace fs = std::filesystem;

class AppendLogTest : public testing::Test {
protected:
    void SetUp() override { fs::remove(path_); }
    void TearDown() override { fs::remove(path_); }
    static std::vector<std::byte> record(std::size_t i) {
        return std::vector<std::byte>(100 * i, static_cast<std::byte>(i));
    }
    /// Records 0 .. count - 1.
    static std::vector<std::vector<std::byte>> records(std::size_t count) {
        std::vector<std::vector<std::byte>> all;
        for (std::size_t i = 0; i < count; ++i)
            all.push_back(record(i));
        return all;
    }
    void append(std::size_t begin, std::size_t end) const {
        AppendLog log(path_);
        EXPECT_EQ(log.read(), records(begin));
        for (std::size_t i = begin; i < end; ++i)
            log.append(record(i));
        EXPECT_EQ(log.size(), size(path_));
    }
    fs::path path_ = fs::path(testing::TempDir()) /
                     (std::string("append_log_") +
                      testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(AppendLogTest, GivesBackWholeRecordsAcrossRuns) {
    append(0, 3);
    append(3, 5);
    EXPECT_EQ(AppendLog(path_).read(), records(5));
}

TEST_F(AppendLogTest, ATornRecordEndsTheListAndIsWrittenOver) {
    append(0, 4);
    const auto whole = fs::file_size(path_);
    for (const std::uint64_t missing :
         {1u, 299u, 300u, 301u, 323u}) { // in the last record and its head
        fs::resize_file(path_, whole - missing);
        append(3, 4);
        EXPECT_EQ(fs::file_size(path_), whole);
    }
    fs::resize_file(path_, whole + 1000); // zeros, as after a power cut
    append(4, 5);
}

TEST_F(AppendLogTest, AFlippedBitEndsTheList) {
    append(0, 4);
    std::vector<std::byte> bytes = read(path_);
    bytes[24 + 24 + 100 + 24 + 7] ^= std::byte{4}; // in record 2
    OutputFile file(path_);
    file.write(bytes);
    file.commit();
    EXPECT_EQ(AppendLog(path_).read(), records(2));
}

TEST_F(AppendLogTest, GoesNoFurtherThanAsked) {
    append(0, 4);
    const std::uint64_t of_two = 24 + 24 + 100;
    AppendLog log(path_);
    EXPECT_EQ(log.read(of_two), records(2));
    EXPECT_EQ(log.size(), of_two);
    log.append(record(2));
    EXPECT_EQ(AppendLog(path_).read(), records(3));
    EXPECT_TRUE(AppendLog(path_).read(0).empty());
}

} // namespace
} // namespace relumine::files
