#include "files/output_file.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

namespace relumine::files {
namespace {

namespace fs = std::filesystem;

class OutputFileTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }
    [[nodiscard]] std::size_t num_files() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }
    fs::path folder_ =
        fs::path(testing::TempDir()) /
        ("output_file_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
};

std::vector<std::byte> bytes_of(const std::string& text) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return bytes;
}

TEST_F(OutputFileTest, AppearsOnlyWithCommit) {
    const fs::path target = folder_ / "out.txt";
    {
        OutputFile file(target);
        file.write(bytes_of("new"));
        EXPECT_FALSE(fs::exists(target));
        file.commit();
    }
    EXPECT_EQ(read(target), bytes_of("new"));
    EXPECT_EQ(size(target), 3u);
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, WithoutCommitTheOldFileStaysAndNothingElse) {
    const fs::path target = folder_ / "out.txt";
    std::ofstream(target) << "old";
    {
        OutputFile file(target);
        file.write(bytes_of("half"));
    }
    EXPECT_EQ(read(target), bytes_of("old"));
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, KeepsTheExtensionForWritersThatLookAtIt) {
    const OutputFile file(folder_ / "picture.exr");
    EXPECT_EQ(file.temporary().extension(), ".exr");
    EXPECT_EQ(file.temporary().parent_path(), folder_);
}

TEST_F(OutputFileTest, NamesTheTargetWhenItCannotBeWritten) {
    try {
        const OutputFile file(folder_ / "missing" / "out.txt");
        FAIL() << "a file in a missing folder was accepted";
    } catch (const std::runtime_error& error) {
        EXPECT_NE(std::string(error.what()).find("missing/out.txt: cannot write: No such file"),
                  std::string::npos)
            << error.what();
    }
    EXPECT_THROW(OutputFile{folder_}, std::runtime_error);
}

TEST_F(OutputFileTest, FullDiskIsReportedAndTheOldFileStays) {
    if (!fs::exists("/dev/full"))
        GTEST_SKIP() << "this system has no /dev/full";
    const fs::path target = folder_ / "out.txt";
    std::ofstream(target) << "old";
    {
        OutputFile file(target);
        fs::remove(file.temporary());
        fs::create_symlink("/dev/full", file.temporary());
        try {
            file.write(bytes_of("new"));
            FAIL() << "a full disk went unnoticed";
        } catch (const std::runtime_error& error) {
            EXPECT_NE(std::string(error.what()).find("out.txt: cannot write: No space left"),
                      std::string::npos);
        }
    }
    EXPECT_EQ(read(target), bytes_of("old"));
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, ReadRefusesFoldersPipesAndMissingFiles) {
    const fs::path pipe = folder_ / "pipe";
    ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
    EXPECT_THROW(static_cast<void>(read(pipe)), std::runtime_error);
    EXPECT_THROW(static_cast<void>(read(folder_)), std::runtime_error);
    EXPECT_THROW(static_cast<void>(read(folder_ / "nothing")), std::runtime_error);
    EXPECT_THROW(static_cast<void>(size(folder_)), std::runtime_error);
}

} // namespace
} // namespace relumine::files
