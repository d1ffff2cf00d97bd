#include "files/hash.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "files/output_file.h"

namespace relumine::files {
namespace {

TEST(Hash, FileHashIsXxHash64OfTheBytes) {
    const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "hash_test.txt";
    save_text(file, "abc");
    EXPECT_EQ(file_hash(file), 0x44bc2cf5ad770999u); // published test value of XXH64("abc", seed 0)
    std::filesystem::remove(file);
    EXPECT_THROW(static_cast<void>(file_hash(file)), std::runtime_error);
}

} // namespace
} // namespace relumine::files
