// All inputs of the corpus through the fuzz targets: what was found once stays mended. A crash or a
// broken promise ends the program, and names the file.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fuzz/command_edges.h"
#include "tests/fuzz/fuzz.h"

// As CMakeLists.txt lists them.
#ifdef RELUMINE_HDR_PHOTOS
#define RELUMINE_FUZZ_PHOTOS(X) X(avif) X(jxl)
#else
#define RELUMINE_FUZZ_PHOTOS(X)
#endif
#define RELUMINE_FUZZ_TARGETS(X)                                                                   \
    X(command_line)                                                                                \
    X(dds)                                                                                         \
    X(exr)                                                                                         \
    X(gain_map)                                                                                    \
    X(gltf)                                                                                        \
    X(hdr)                                                                                         \
    X(ies)                                                                                         \
    X(ktx)                                                                                         \
    X(layers)                                                                                      \
    X(lights)                                                                                      \
    X(mtl)                                                                                         \
    X(obj) X(off) X(pfm) X(ply) X(prt) X(sections) X(stl) X(texture) X(tiff) RELUMINE_FUZZ_PHOTOS(X)

#define RELUMINE_DECLARE(name)                                                                     \
    extern "C" int relumine_fuzz_##name(const std::uint8_t* data, std::size_t size);
RELUMINE_FUZZ_TARGETS(RELUMINE_DECLARE)

namespace relumine::fuzz {
namespace {

namespace fs = std::filesystem;

struct Target {
    std::string name;
    int (*run)(const std::uint8_t* data, std::size_t size);
};

std::vector<Target> targets() {
#define RELUMINE_LIST(name) {#name, relumine_fuzz_##name},
    return {RELUMINE_FUZZ_TARGETS(RELUMINE_LIST)};
}

std::vector<fs::path> files_below(const fs::path& folder) {
    std::vector<fs::path> result;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file())
            result.push_back(entry.path());
    std::sort(result.begin(), result.end());
    return result;
}

std::vector<std::uint8_t> content_of(const fs::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

class Corpus : public testing::TestWithParam<Target> {};

TEST_P(Corpus, IsReadOrRefused) {
    const std::vector<fs::path> files =
        files_below(fs::path(RELUMINE_FUZZ_CORPUS) / GetParam().name);
    ASSERT_FALSE(files.empty());
    num_accepted = 0;
    for (const fs::path& path : files) {
        const std::vector<std::uint8_t> content = content_of(path);
        const std::size_t before = num_accepted;
        std::fprintf(stderr, "%s", path.c_str()); // the last one is the culprit
        EXPECT_EQ(GetParam().run(content.data(), content.size()), 0);
        std::fprintf(stderr, ": %s\n", num_accepted > before ? "read" : "refused");
    }
    // Otherwise the seeds are of an old format, and fuzzing would begin at nothing.
    EXPECT_GT(num_accepted, 0u);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(targets()),
                         [](const auto& each) { return each.param.name; });

/// Readers share nothing: as a program reads files that loads several at once. Arguments
/// belong to one session of a process.
TEST(Fuzz, ReadersOfAllKindsWorkInSeveralThreads) {
    std::vector<std::thread> threads;
    for (std::size_t first = 0; first < 3; ++first)
        threads.emplace_back([first] {
            const std::vector<Target> all = targets();
            for (std::size_t i = 0; i < all.size(); ++i) {
                const Target& target = all[(first * 5 + i) % all.size()];
                if (target.name == "command_line")
                    continue;
                const auto files = files_below(fs::path(RELUMINE_FUZZ_CORPUS) / target.name);
                // Every third is enough to meet the others, in another place of each thread.
                for (std::size_t file = first; file < files.size(); file += 3) {
                    const std::vector<std::uint8_t> content = content_of(files[file]);
                    EXPECT_EQ(target.run(content.data(), content.size()), 0);
                }
            }
        });
    for (std::thread& thread : threads)
        thread.join();
}

class CommandLine : public testing::TestWithParam<std::size_t> {};

TEST_P(CommandLine, TakesOrRefusesNumbersAtTheEdges) {
    EXPECT_GE(run_all_edges(GetParam()),
              working_commands()[GetParam()].starts_with("info") ? 1u : 8u);
}

INSTANTIATE_TEST_SUITE_P(Edges, CommandLine,
                         testing::Range(std::size_t{0}, working_commands().size()),
                         [](const auto& each) { return working_commands()[each.param]; });

} // namespace
} // namespace relumine::fuzz
