#include "cubemap/image/frame_sequence.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "cubemap/image/image_file.h"
#include "cubemap/image/image_size.h"
#include "cubemap/resample/resample.h"
#include "cubemap/resample/save_environment.h"
#include "files/output_file.h"
#include "tests/own_folder.h"

namespace relumine::cubemap {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class Frames : public tests::FolderTest {
protected:
    [[nodiscard]] std::string in(const std::string& name) const {
        return (folder_ / name).string();
    }
    void touch(const std::string& name) const { std::ofstream(folder_ / name) << "x"; }
    /// A cross of R = 2, all of one radiance.
    void frame(const std::string& name, float radiance, std::uint32_t resolution = 2) const {
        save_environment(in(name), CubeMap(resolution, glm::vec3(radiance)), Layout::VerticalCross);
    }
};

std::vector<std::int64_t> numbers(const std::vector<FrameFile>& frames) {
    std::vector<std::int64_t> result;
    for (const FrameFile& frame : frames)
        result.push_back(frame.number);
    return result;
}

TEST(FramePattern, NamesAndNumbersAreInverse) {
    for (const char* text :
         {"f.%04d.exr", "f.####.exr", "f.%d.exr", "f.%01d.exr", "dir#1/%02d/f_#.hdr", "%d", "##"}) {
        const auto pattern = FramePattern::parse(text);
        ASSERT_TRUE(pattern) << text;
        for (const std::int64_t number : {0, 7, 42, 9999, 10000, 123456789})
            EXPECT_EQ(pattern->number(pattern->name(number)), number) << text;
    }
    EXPECT_EQ(FramePattern::parse("f.%04d.exr")->name(7), "f.0007.exr");
    EXPECT_EQ(FramePattern::parse("f.###.exr")->name(12345), "f.12345.exr");
    EXPECT_EQ(FramePattern::parse("f.%d.exr")->name(7), "f.7.exr");
    EXPECT_EQ(FramePattern::parse("a/f.%d.exr")->name_of_all("all"), "a/f.all.exr");
}

TEST(FramePattern, NamesThatAreNoFrames) {
    const auto pattern = FramePattern::parse("f.%04d.exr");
    for (const char* name :
         {"f.007.exr", "f.00007.exr", "f.-001.exr", "f.+001.exr", "f.0x07.exr", "f..exr",
          "g.0007.exr", "f.0007.exr2", "f.99999999999999999999.exr", ""})
        EXPECT_FALSE(pattern->number(name)) << name;
}

TEST(FramePattern, TextsWithoutAPlace) {
    for (const char* text :
         {"f.exr", "f.%s.exr", "f.%4d.exr", "100%.exr", "%", "folder.%04d/f.exr"})
        EXPECT_FALSE(FramePattern::parse(text)) << text;
    EXPECT_THROW(static_cast<void>(FramePattern::parse("%02d.##.exr")), std::runtime_error);
}

TEST(FrameRange, Texts) {
    const FrameRange range = FrameRange::parse("10-200x5");
    EXPECT_EQ(range.first, 10);
    EXPECT_EQ(range.last, 200);
    EXPECT_EQ(range.step, 5);
    EXPECT_TRUE(range.contains(15));
    EXPECT_FALSE(range.contains(16));
    EXPECT_FALSE(range.contains(205));
    EXPECT_EQ(FrameRange::parse("7").last, 7);
    for (const char* text : {"", "-", "1-", "-5", "5-1", "1-2x0", "1-2x", "3x2", "1-2-3", "a",
                             "1-2x3x4", "1 - 2", "99999999999999999999"})
        EXPECT_THROW(static_cast<void>(FrameRange::parse(text)), std::runtime_error) << text;
}

TEST_F(Frames, APatternTakesItsFramesInOrder) {
    for (const char* name : {"f.0009.exr", "f.0010.exr", "f.0011.exr", "f.12.exr", "g.0012.exr"})
        touch(name);
    const std::vector<FrameFile> frames = find_frames(in("f.%04d.exr"));
    EXPECT_THAT(numbers(frames), ElementsAre(9, 10, 11));
    EXPECT_EQ(frames[1].path, in("f.0010.exr"));
    EXPECT_THAT(numbers(find_frames(in("f.####.exr"), FrameRange{10, 11})), ElementsAre(10, 11));
    EXPECT_THAT(numbers(find_frames(in("f.####.exr"), FrameRange{9, 11, 2})), ElementsAre(9, 11));
}

TEST_F(Frames, GapsAreToldInOneLine) {
    for (const int number : {1, 2, 5, 6, 9})
        touch("f." + std::to_string(number) + ".exr");
    EXPECT_EQ(tests::message_of([&] { static_cast<void>(find_frames(in("f.%d.exr"))); }),
              in("f.%d.exr") + ": expected frames 1 to 9 without a gap, got none for 3-4, 7-8");
    EXPECT_THAT(tests::message_of(
                    [&] { static_cast<void>(find_frames(in("f.%d.exr"), FrameRange{5, 8})); }),
                HasSubstr("none for 7-8"));
    EXPECT_THAT(numbers(find_frames(in("f.%d.exr"), FrameRange{1, 9, 4})), ElementsAre(1, 5, 9));
    EXPECT_THAT(tests::message_of([&] { static_cast<void>(find_frames(in("g.%d.exr"))); }),
                HasSubstr("no file of such a name"));
    EXPECT_THAT(tests::message_of([&] { static_cast<void>(find_frames(in("no/g.%d.exr"))); }),
                HasSubstr("cannot read the folder"));
}

TEST_F(Frames, AGlobTakesWhatIsThere) {
    for (const char* name : {"shot2_9.exr", "shot2_10.exr", "shot2_30.exr", "other.txt"})
        touch(name);
    EXPECT_THAT(numbers(find_frames(in("shot*.exr"))), ElementsAre(9, 10, 30));
    EXPECT_THAT(numbers(find_frames(in("shot2_??.exr"), FrameRange{10, 20})), ElementsAre(10));
    // The last number in all names is the same: counted in the order of the names.
    for (const char* name : {"b_v2.exr", "a_v2.exr"})
        touch(name);
    const std::vector<FrameFile> frames = find_frames(in("*_v2.exr"));
    EXPECT_THAT(numbers(frames), ElementsAre(1, 2));
    EXPECT_EQ(frames[0].path, in("a_v2.exr"));
    EXPECT_THROW(static_cast<void>(find_frames(in("none*.exr"))), std::runtime_error);
    EXPECT_THROW(static_cast<void>(find_frames(in("shot*.exr"), FrameRange{100, 200})),
                 std::runtime_error);
}

TEST_F(Frames, OneFileIsASequence) {
    touch("one.12.exr");
    EXPECT_THAT(numbers(find_frames(in("one.12.exr"))), ElementsAre(12));
    touch("we[i]rd#.exr");
    EXPECT_EQ(find_frames(in("we[i]rd#.exr")).size(), 1u);
}

TEST_F(Frames, SixFilesPerFrame) {
    for (const int number : {0, 1})
        for (const std::string_view face : FaceFileNames) {
            EnvironmentImage image;
            image.width = image.height = 4;
            image.pixels.assign(16, glm::vec3(static_cast<float>(number + 1)));
            files::OutputFile file(
                in("f." + std::to_string(number) + "." + std::string(face) + ".exr"));
            file.write(encode_exr(image));
            file.commit();
        }
    FrameSequence sequence(find_frames(in("f.%d.{face}.exr")));
    ASSERT_EQ(sequence.size(), 2u);
    EXPECT_EQ(sequence.image_size(), (ImageSize{4, 24}));
    EXPECT_EQ(sequence.load(1).pixels.front(), glm::vec3(2.0f));
    EXPECT_EQ(sequence.load(1).layout, Layout::Cube);
}

TEST_F(Frames, SizesFromHeadersAreThoseOfTheImages) {
    const CubeMap map(4, glm::vec3(1.0f));
    for (const Layout layout : AllLayouts)
        for (const char* extension : {".exr", ".hdr"}) {
            const std::string path = in(std::string("image") + extension);
            save_environment(path, map, layout);
            const EnvironmentImage image = load_environment(path, {.layout = layout});
            EXPECT_EQ(read_image_size(path), (ImageSize{image.width, image.height})) << path;
        }
    touch("text.exr");
    EXPECT_THROW(static_cast<void>(read_image_size(in("text.exr"))), std::runtime_error);
    EXPECT_THROW(static_cast<void>(read_image_size(in("missing.exr"))), std::runtime_error);
    std::ofstream(in("empty.exr")).close();
    EXPECT_THAT(tests::message_of([&] { static_cast<void>(read_image_size(in("empty.exr"))); }),
                HasSubstr("an empty file"));
}

TEST_F(Frames, LoadGivesEveryFrameInAnyOrder) {
    for (int i = 0; i < 5; ++i)
        frame("f." + std::to_string(i) + ".exr", static_cast<float>(i + 1));
    FrameSequence sequence(find_frames(in("f.%d.exr")));
    const auto radiance_of = [&](std::size_t i) {
        return resample(sequence.load(i), 2).texels.front().r;
    };
    for (const std::size_t i : {0u, 1u, 2u, 3u, 4u, 4u, 0u, 3u, 2u, 3u})
        EXPECT_EQ(radiance_of(i), static_cast<float>(i + 1)) << i;
    EXPECT_EQ(sequence.image_size(), (ImageSize{6, 8}));
}

TEST_F(Frames, AnotherSizeIsRefusedBeforeAnyFrameIsLoaded) {
    frame("f.0.exr", 1.0f);
    frame("f.1.exr", 1.0f, 3);
    int num_loaded = 0;
    EXPECT_EQ(tests::message_of([&] {
                  const FrameSequence sequence(find_frames(in("f.%d.exr")),
                                               [&](const fs::path& path) {
                                                   ++num_loaded;
                                                   return load_environment(path);
                                               });
              }),
              in("f.1.exr") + ": expected 6x8 as the first frame, " + in("f.0.exr") + ", got 9x12");
    EXPECT_EQ(num_loaded, 0);
}

TEST_F(Frames, ADamagedFrameIsToldWhenItsTurnComes) {
    for (int i = 0; i < 3; ++i)
        frame("f." + std::to_string(i) + ".exr", 1.0f, 32);
    fs::resize_file(in("f.1.exr"), fs::file_size(in("f.1.exr")) - 30);
    FrameSequence sequence(find_frames(in("f.%d.exr")));
    static_cast<void>(sequence.load(0)); // begins to load the damaged one
    EXPECT_THAT(tests::message_of([&] { static_cast<void>(sequence.load(1)); }),
                HasSubstr(in("f.1.exr")));
    EXPECT_EQ(sequence.load(2).width, 96u); // and nothing of it is left
}

TEST(ReadAhead, MakesOneAheadAndNoMore) {
    std::atomic<int> num_alive = 0;
    std::atomic<int> most = 0;
    struct Value {
        std::size_t index;
        std::atomic<int>* alive;
        Value(std::size_t i, std::atomic<int>* counter) : index(i), alive(counter) { ++*alive; }
        Value(Value&& other) noexcept
            : index(other.index), alive(std::exchange(other.alive, nullptr)) {}
        Value& operator=(Value&&) = delete;
        ~Value() {
            if (alive != nullptr)
                --*alive;
        }
    };
    {
        ReadAhead<Value> ahead(50, [&](std::size_t i) {
            Value value(i, &num_alive);
            most = std::max(most.load(), num_alive.load());
            return value;
        });
        for (std::size_t i = 0; i < 50; ++i)
            EXPECT_EQ(ahead.get(i).index, i);
    }
    EXPECT_EQ(num_alive, 0);
    EXPECT_LE(most, 2);
}

TEST(ReadAhead, NeverMakesTwoAtOnceInAnyOrder) {
    // Nothing guards the list: only that one is made at a time does, and the thread sanitizer looks
    // on. Other threads are slow, so that whoever does not wait for them is seen without it, too.
    std::vector<std::size_t> made;
    {
        const std::thread::id caller = std::this_thread::get_id();
        ReadAhead<std::size_t> ahead(5, [&](std::size_t i) {
            if (std::this_thread::get_id() != caller)
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            made.push_back(i);
            return i;
        });
        for (const std::size_t i : {0u, 1u, 4u, 2u, 2u, 0u})
            EXPECT_EQ(ahead.get(i), i);
    } // while 1 is made
    EXPECT_THAT(made, ElementsAre(0, 1, 2, 4, 2, 3, 2, 3, 0, 1));
}

TEST(ReadAhead, ThrowsForTheOneThatWasAskedForAlone) {
    ReadAhead<std::size_t> ahead(4, [](std::size_t i) {
        if (i == 1)
            throw std::runtime_error("one");
        return i;
    });
    EXPECT_EQ(ahead.get(0), 0u);
    EXPECT_EQ(ahead.get(2), 2u); // 1 had been begun
    EXPECT_EQ(tests::message_of([&] { static_cast<void>(ahead.get(1)); }), "one");
    EXPECT_EQ(ahead.get(0), 0u);
    EXPECT_EQ(tests::message_of([&] { static_cast<void>(ahead.get(1)); }), "one"); // made ahead
    EXPECT_EQ(ahead.get(3), 3u);
}

} // namespace
} // namespace relumine::cubemap
