#include "files/output_file.h"
#include "tests/own_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace relumine::files {
namespace {

namespace fs = std::filesystem;

using OutputFileTest = tests::FolderTest;

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

TEST_F(OutputFileTest, ATargetKeepsItsPermissions) {
    const fs::path target = folder_ / "out.txt";
    const auto mode = [&] {
        struct stat status{};
        EXPECT_EQ(::stat(target.c_str(), &status), 0);
        return status.st_mode & 07777;
    };
    const mode_t mask = ::umask(022);
    save_text(target, "new");
    EXPECT_EQ(mode(), 0644u);
    for (const mode_t own : {0600u, 0640u, 0755u}) {
        ::chmod(target.c_str(), own);
        save_text(target, "newer");
        EXPECT_EQ(mode(), own);
    }
    ::umask(mask);
}

TEST_F(OutputFileTest, NamesMayBeAsLongAsTheSystemAllows) {
    for (const fs::path& target :
         {folder_ / std::string(255, 'a'), folder_ / (std::string(251, 'b') + ".exr"),
          folder_ / ("c." + std::string(253, 'c'))}) {
        save_text(target, "new");
        EXPECT_EQ(read(target), bytes_of("new"));
    }
    // Two names that differ only at their ends, at the same time.
    const fs::path one = folder_ / (std::string(254, 'd') + "1");
    const fs::path two = folder_ / (std::string(254, 'd') + "2");
    OutputFile first(one);
    OutputFile second(two);
    first.write(bytes_of("1"));
    second.write(bytes_of("2"));
    first.commit();
    second.commit();
    EXPECT_EQ(read(one), bytes_of("1"));
    EXPECT_EQ(read(two), bytes_of("2"));
    EXPECT_THROW(OutputFile(folder_ / std::string(256, 'e')), std::runtime_error);
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

/// Writes in a process of its own, which `prepare` sets up; returns its message.
template<class Prepare>
std::string written_elsewhere(const fs::path& target, std::size_t num_bytes,
                              const Prepare& prepare) {
    std::array<int, 2> pipe{};
    EXPECT_EQ(::pipe(pipe.data()), 0);
    const pid_t child = ::fork();
    if (child == 0) {
        prepare();
        std::string message = "nothing thrown";
        try {
            OutputFile file(target);
            file.write(std::vector<std::byte>(num_bytes));
            file.commit();
        } catch (const std::runtime_error& error) {
            message = error.what();
        }
        static_cast<void>(::write(pipe[1], message.data(), message.size()) == 0);
        ::_exit(0);
    }
    ::close(pipe[1]);
    std::string message(1000, ' ');
    message.resize(
        static_cast<std::size_t>(std::max<ssize_t>(0, ::read(pipe[0], message.data(), 1000))));
    ::close(pipe[0]);
    ::waitpid(child, nullptr, 0);
    return message;
}

/// In a process that may write files of `max_bytes`.
std::string written_under_a_limit(const fs::path& target, std::size_t num_bytes, rlim_t max_bytes) {
    return written_elsewhere(target, num_bytes, [&] {
        ::signal(SIGXFSZ, SIG_IGN);
        const struct rlimit limit = {max_bytes, max_bytes};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    });
}

TEST_F(OutputFileTest, SaysWhereThereAreNoRights) {
    fs::permissions(folder_, fs::perms::owner_read | fs::perms::owner_exec |
                                 fs::perms::others_read | fs::perms::others_exec);
    constexpr uid_t Nobody = 65534; // root has all rights
    const fs::path target = folder_ / "out.txt";
    EXPECT_EQ(written_elsewhere(
                  target, 10, [] { static_cast<void>(::geteuid() == 0 ? ::seteuid(Nobody) : 0); }),
              target.string() + ": cannot write: Permission denied");
    fs::permissions(folder_, fs::perms::owner_all);
    EXPECT_EQ(num_files(), 0u);
}

TEST_F(OutputFileTest, ALimitIsReportedWithTheBytesNeededAndTheOldFileStays) {
    const fs::path target = folder_ / "out.txt";
    std::ofstream(target) << "old";
    EXPECT_EQ(written_under_a_limit(target, 10000, 4096),
              target.string() + ": cannot write: File too large: 10000 bytes needed, 4096 allowed");
    EXPECT_EQ(read(target), bytes_of("old"));
    EXPECT_EQ(num_files(), 1u);
    EXPECT_EQ(written_under_a_limit(target, 4096, 4096), "nothing thrown");
    EXPECT_EQ(size(target), 4096u);
}

/// A file system of 64 KiB, where the system lets us have one.
class FullDiskTest : public OutputFileTest {
protected:
    void SetUp() override {
        OutputFileTest::SetUp();
        mounted_ = ::mount("tmpfs", folder_.c_str(), "tmpfs", 0, "size=64k") == 0;
        if (!mounted_)
            GTEST_SKIP() << "a small file system cannot be mounted here: " << std::strerror(errno);
    }
    void TearDown() override {
        if (mounted_)
            ::umount(folder_.c_str());
        OutputFileTest::TearDown();
    }

private:
    bool mounted_ = false;
};

TEST_F(FullDiskTest, TheBytesNeededAndThoseFreeAreNamedAndTheOldFileStays) {
    const fs::path target = folder_ / "out.txt";
    std::ofstream(target) << "old"; // takes a page of 4 KiB
    try {
        OutputFile file(target);
        file.write(std::vector<std::byte>(100000));
        FAIL() << "a full disk went unnoticed";
    } catch (const std::runtime_error& error) {
        EXPECT_EQ(error.what(),
                  target.string() +
                      ": cannot write: No space left on device: 100000 bytes needed, 61440 free");
    }
    EXPECT_EQ(read(target), bytes_of("old"));
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, AppendsPieceByPiece) {
    const fs::path target = folder_ / "out.txt";
    OutputFile file(target);
    file.append(bytes_of("one "));
    file.append(bytes_of("two"));
    file.commit();
    EXPECT_EQ(read(target), bytes_of("one two"));
    append_text(target, " three");
    EXPECT_EQ(read(target), bytes_of("one two three"));
}

TEST_F(OutputFileTest, ReplacesWhatWasWritten) {
    const fs::path target = folder_ / "out.txt";
    OutputFile file(target);
    file.append(bytes_of("...., 1 2 3"));
    file.replace(0, bytes_of("head"));
    EXPECT_THROW(file.replace(8, bytes_of("long")), std::invalid_argument);
    file.append(bytes_of(" 4"));
    file.commit();
    EXPECT_EQ(read(target), bytes_of("head, 1 2 3 4"));
}

TEST_F(OutputFileTest, FollowsLinks) {
    fs::create_directory(folder_ / "far");
    std::ofstream(folder_ / "far" / "real.txt") << "old";
    fs::create_symlink("far/real.txt", folder_ / "near.txt");
    fs::create_symlink("near.txt", folder_ / "link.txt");
    save_text(folder_ / "link.txt", "new");
    EXPECT_TRUE(fs::is_symlink(folder_ / "link.txt"));
    EXPECT_TRUE(fs::is_symlink(folder_ / "near.txt"));
    EXPECT_FALSE(fs::is_symlink(folder_ / "far" / "real.txt"));
    EXPECT_EQ(read(folder_ / "far" / "real.txt"), bytes_of("new"));
    // To nothing yet.
    fs::create_symlink(folder_ / "far" / "other.txt", folder_ / "dangling.txt");
    save_text(folder_ / "dangling.txt", "made");
    EXPECT_TRUE(fs::is_symlink(folder_ / "dangling.txt"));
    EXPECT_EQ(read(folder_ / "far" / "other.txt"), bytes_of("made"));
    // In a circle.
    fs::create_symlink("b", folder_ / "a");
    fs::create_symlink("a", folder_ / "b");
    EXPECT_THROW(save_text(folder_ / "a", "x"), std::runtime_error);
}

TEST_F(OutputFileTest, TakesOverWhatAKilledProcessLeft) {
    const fs::path target = folder_ / "out.txt";
    for (int i = 0; i < 5; ++i) {
        const pid_t child = ::fork();
        if (child == 0) {
            OutputFile file(target);
            file.write(bytes_of("half a fi"));
            ::kill(::getpid(), SIGKILL);
        }
        ::waitpid(child, nullptr, 0);
        EXPECT_EQ(num_files(), 1u);
        EXPECT_FALSE(fs::exists(target));
    }
    save_text(target, "whole");
    EXPECT_EQ(read(target), bytes_of("whole"));
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, WritersOfOneTargetDoNotMeet) {
    const fs::path target = folder_ / "out.txt";
    OutputFile first(target);
    OutputFile second(target);
    EXPECT_NE(first.temporary(), second.temporary());
    first.write(bytes_of("first"));
    second.write(bytes_of("second"));
    second.commit();
    first.commit();
    EXPECT_EQ(read(target), bytes_of("first"));
    EXPECT_EQ(num_files(), 1u);
}

TEST_F(OutputFileTest, OneOfManyProcessesWinsWhole) {
    const fs::path target = folder_ / "out.txt";
    constexpr std::size_t NumProcesses = 4;
    std::vector<pid_t> children;
    for (std::size_t i = 0; i < NumProcesses; ++i) {
        children.push_back(::fork());
        if (children.back() == 0) {
            int failures = 0;
            for (int round = 0; round < 50; ++round) {
                try {
                    OutputFile file(target);
                    file.write(std::vector<std::byte>(10000 + i, static_cast<std::byte>(i)));
                    file.commit();
                } catch (const std::exception&) {
                    ++failures;
                }
            }
            ::_exit(failures == 0 ? 0 : 1);
        }
    }
    const auto expect_whole = [&] {
        const std::vector<std::byte> bytes = read(target);
        ASSERT_GE(bytes.size(), 10000u);
        const std::size_t writer = bytes.size() - 10000;
        ASSERT_LT(writer, NumProcesses);
        ASSERT_TRUE(std::all_of(bytes.begin(), bytes.end(),
                                [&](std::byte b) { return b == static_cast<std::byte>(writer); }));
    };
    while (!fs::exists(target)) {
    }
    for (int i = 0; i < 50; ++i)
        expect_whole();
    for (const pid_t child : children) {
        int status = -1;
        ::waitpid(child, &status, 0);
        EXPECT_EQ(status, 0);
    }
    expect_whole();
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

TEST_F(OutputFileTest, AProcessThatEndsAtOnceLeavesNothing) {
    const fs::path target = folder_ / "a.txt";
    const pid_t child = ::fork();
    if (child == 0) {
        OutputFile done(folder_ / "done.txt");
        done.write(bytes_of("whole"));
        done.commit();
        OutputFile file(target);
        file.write(bytes_of("half"));
        abandon_outputs();
        ::_exit(0);
    }
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(fs::exists(folder_ / "done.txt"));
    EXPECT_EQ(num_files(), 1u);
}

} // namespace
} // namespace relumine::files
