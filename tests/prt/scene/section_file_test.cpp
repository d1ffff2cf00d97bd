#include "prt/scene/section_file.h"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>
#include <zstd.h>

#include "files/output_file.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/section_format.h"
#include "tests/own_folder.h"
#include "tests/prt/damaged_file.h"

namespace relumine::prt {
namespace {

namespace fs = std::filesystem;

class SectionFileTest : public tests::FolderTest {
protected:
    void write(const std::vector<std::byte>& bytes) const {
        std::ofstream(file_, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
    }
    void expect_refused(const std::string& reason) const {
        scenes::expect_refused(file_, reason, [&] { static_cast<void>(read_sections(file_)); });
    }

    fs::path file_ = folder_ / "scene.prt";
};

std::vector<std::byte> text(const std::string& characters) {
    std::vector<std::byte> bytes(characters.size());
    std::memcpy(bytes.data(), characters.data(), bytes.size());
    return bytes;
}

Sections examples() {
    std::mt19937 random(1);
    std::vector<std::byte> noise(10000);
    std::generate(noise.begin(), noise.end(), [&] { return static_cast<std::byte>(random()); });
    return {{"empty", {}},
            {"one", text("x")},
            {"sixteen_letters_", text("abc")},
            {"noise", noise},
            {"zeros", std::vector<std::byte>(1000000)}};
}

// Where the format has its fields: header of 40 bytes, entries of 48.
constexpr std::size_t ByteOrderAt = 8, VersionAt = 12, FileSizeAt = 16, NumSectionsAt = 24,
                      ReservedAt = 28, HeaderChecksumAt = 32, HeaderSize = 40, EntrySize = 48,
                      OffsetAt = 16, StoredSizeAt = 24, SizeAt = 32, ChecksumAt = 40;

template<typename Value>
Value value_at(const std::vector<std::byte>& bytes, std::size_t at) {
    Value value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

template<typename Value>
void put(std::vector<std::byte>& bytes, std::size_t at, Value value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
}

/// Makes the header's checksum right again, as who forges a file would.
void sign(std::vector<std::byte>& bytes) {
    const std::size_t table = value_at<std::uint32_t>(bytes, NumSectionsAt) * EntrySize;
    std::vector<std::byte> covered(bytes.begin(), bytes.begin() + HeaderChecksumAt);
    covered.insert(covered.end(), bytes.begin() + HeaderSize,
                   bytes.begin() + static_cast<std::ptrdiff_t>(HeaderSize + table));
    put(bytes, HeaderChecksumAt, XXH64(covered.data(), covered.size(), 0));
}

TEST_F(SectionFileTest, RoundTrip) {
    const std::uint64_t size = write_sections(file_, to_write(examples()));
    EXPECT_EQ(size, fs::file_size(file_));
    EXPECT_EQ(read_sections(file_), examples());
    EXPECT_LT(fs::file_size(file_), 12000u) << "zeros should be compressed";
    write_sections(file_, {});
    EXPECT_TRUE(read_sections(file_).empty());
}

TEST_F(SectionFileTest, SameSectionsSameBytes) {
    write_sections(file_, to_write(examples()));
    const std::vector<std::byte> first = files::read(file_);
    write_sections(file_, to_write(examples()));
    EXPECT_EQ(files::read(file_), first);
}

TEST_F(SectionFileTest, ViewsAndMadeBytesAreWrittenAsOwnOnes) {
    // More than a batch of frames, so that contents come and go while others are written.
    std::mt19937 random(5);
    std::vector<std::uint32_t> numbers(std::size_t{9} << 20);
    std::generate(numbers.begin(), numbers.end(),
                  [&] { return static_cast<std::uint32_t>(random() % 5); });
    const std::vector<std::byte> bytes(std::as_bytes(std::span(numbers)).begin(),
                                       std::as_bytes(std::span(numbers)).end());
    write_sections(file_, {{"a", text("first")}, {"b", bytes}, {"c", bytes}, {"d", text("last")}});
    const std::vector<std::byte> own = files::read(file_);
    std::atomic<std::size_t> num_made = 0;
    const SectionContent made(bytes.size(), [&](std::uint64_t begin, std::span<std::byte> piece) {
        num_made += piece.size();
        std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(begin), piece.size(),
                    piece.begin());
    });
    write_sections(file_, {{"a", text("first")},
                           {"b", SectionContent::view(numbers)},
                           {"c", made},
                           {"d", text("last")}});
    EXPECT_TRUE(files::read(file_) == own);
    EXPECT_EQ(num_made, bytes.size());
    EXPECT_TRUE(read_sections(file_).at("c") == bytes);
}

TEST_F(SectionFileTest, LayoutIsTheDocumentedOne) {
    write_sections(file_, {{"abc", text("hello")}});
    const std::vector<std::byte> bytes = files::read(file_);
    EXPECT_EQ(std::memcmp(bytes.data(), "RELUMINE", 8), 0);
    const std::vector<std::byte> little_endian(bytes.begin() + ByteOrderAt,
                                               bytes.begin() + VersionAt);
    EXPECT_EQ(little_endian, (std::vector{std::byte{4}, std::byte{3}, std::byte{2}, std::byte{1}}));
    EXPECT_EQ(value_at<std::uint32_t>(bytes, VersionAt), SceneFileVersion);
    EXPECT_EQ(value_at<std::uint64_t>(bytes, FileSizeAt), bytes.size());
    EXPECT_EQ(value_at<std::uint32_t>(bytes, NumSectionsAt), 1u);
    EXPECT_STREQ(reinterpret_cast<const char*>(bytes.data() + HeaderSize), "abc");
    const auto offset = value_at<std::uint64_t>(bytes, HeaderSize + OffsetAt);
    const auto stored = value_at<std::uint64_t>(bytes, HeaderSize + StoredSizeAt);
    EXPECT_EQ(offset, HeaderSize + EntrySize);
    EXPECT_EQ(offset + stored, bytes.size());
    EXPECT_EQ(value_at<std::uint64_t>(bytes, HeaderSize + SizeAt), 5u);
    EXPECT_EQ(value_at<std::uint64_t>(bytes, HeaderSize + ChecksumAt),
              XXH64(bytes.data() + offset, stored, 0));
    std::vector<std::byte> signed_again = bytes;
    sign(signed_again);
    EXPECT_EQ(signed_again, bytes);
}

TEST_F(SectionFileTest, RefusesBadNames) {
    EXPECT_THROW(write_sections(file_, {{"", {}}}), std::invalid_argument);
    EXPECT_THROW(write_sections(file_, {{"seventeen_letters", {}}}), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SectionFileTest, RefusesMoreSectionsThanItReads) {
    Sections many;
    for (char a = 'a'; a < 'a' + 13; ++a)
        for (char b = 'a'; b < 'a' + 10; ++b)
            many[{a, b}] = {};
    EXPECT_THROW(write_sections(file_, to_write(many)), std::invalid_argument);
    EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(SectionFileTest, RefusesEveryTruncationAndAppendedBytes) {
    write_sections(file_, {{"abc", text("hello")}, {"zeros", std::vector<std::byte>(300)}});
    const std::vector<std::byte> bytes = files::read(file_);
    std::vector<std::byte> longer = bytes;
    longer.push_back(std::byte{0});
    write(longer);
    expect_refused("truncated or damaged");
    for (std::size_t length = bytes.size(); length-- > 0;) {
        fs::resize_file(file_, length);
        expect_refused("");
    }
}

TEST_F(SectionFileTest, RefusesEveryChangedBit) {
    write_sections(file_, {{"abc", text("hello")}, {"zeros", std::vector<std::byte>(300)}});
    const std::vector<std::byte> bytes = files::read(file_);
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (unsigned bit = 0; bit < 8; ++bit) {
            scenes::put_byte(file_, i, bytes[i] ^ static_cast<std::byte>(1u << bit));
            expect_refused("");
            scenes::put_byte(file_, i, bytes[i]);
        }
}

TEST_F(SectionFileTest, SaysWhatIsWrong) {
    write_sections(file_, {{"abc", text("hello")}});
    const std::vector<std::byte> good = files::read(file_);
    const auto changed = [&](const std::function<void(std::vector<std::byte>&)>& change) {
        std::vector<std::byte> bad = good;
        change(bad);
        write(bad);
    };
    changed([](auto& b) { put(b, VersionAt, std::uint32_t{0}); });
    expect_refused(fmt::format("expected .prt version {}, got version 0, made by an older relumine",
                               SceneFileVersion));
    changed([](auto& b) { put(b, VersionAt, SceneFileVersion + 1); });
    expect_refused(fmt::format("expected .prt version {}, got version {}, made by a newer relumine",
                               SceneFileVersion, SceneFileVersion + 1));
    changed([](auto& b) { std::reverse(b.begin() + ByteOrderAt, b.begin() + VersionAt); });
    expect_refused("expected a little-endian .prt scene, got a big-endian one");
    changed([](auto& b) { b.resize(b.size() - 3); });
    expect_refused("truncated");
    changed([](auto& b) { b.back() ^= std::byte{1}; });
    expect_refused("damaged section 'abc'");
    changed([](auto& b) { b[HeaderSize] = std::byte{'x'}; });
    expect_refused("damaged section table");
    write(text("#!/bin/sh\necho this is no scene, but it is long enough to hold a header\n"));
    expect_refused("expected a .prt scene, got another kind of file");
    write({});
    expect_refused("expected a .prt scene, got another kind of file");
    std::mt19937 random(2);
    for (int round = 0; round < 200; ++round) {
        std::vector<std::byte> garbage(random() % 500);
        std::generate(garbage.begin(), garbage.end(),
                      [&] { return static_cast<std::byte>(random()); });
        if (round % 2 == 0 && garbage.size() > 8)
            std::memcpy(garbage.data(), "RELUMINE", 8);
        write(garbage);
        expect_refused("");
    }
    fs::remove(file_);
    expect_refused("cannot read");
}

TEST_F(SectionFileTest, RefusesForgedTables) {
    write_sections(file_, {{"abc", text("hello")}, {"big", std::vector<std::byte>(100000)}});
    const std::vector<std::byte> good = files::read(file_);
    const auto forged = [&](const std::function<void(std::vector<std::byte>&)>& change) {
        std::vector<std::byte> bad = good;
        change(bad);
        sign(bad);
        write(bad);
        expect_refused("");
    };
    for (const std::uint64_t value :
         {std::uint64_t{1} << 40, ~std::uint64_t{0}, ~std::uint64_t{0} - 40}) {
        forged([&](auto& b) { put(b, HeaderSize + OffsetAt, value); });
        forged([&](auto& b) { put(b, HeaderSize + StoredSizeAt, value); });
        forged([&](auto& b) { put(b, HeaderSize + SizeAt, value); });
    }
    for (const std::uint64_t size : {0u, 4u, 6u, 100000u, 3000000u}) // of 5 bytes
        forged([&](auto& b) { put(b, HeaderSize + SizeAt, size); });
    forged([](auto& b) {
        put(b, NumSectionsAt, std::uint32_t{1}), put(b, HeaderSize + OffsetAt, std::uint64_t{0});
    });
    // Two sections of one name.
    forged([](auto& b) {
        std::copy_n(b.begin() + HeaderSize, EntrySize, b.begin() + HeaderSize + EntrySize);
    });
    // Names that descend.
    forged([](auto& b) { b[HeaderSize] = std::byte{'x'}; });
    // Something behind a name.
    forged([](auto& b) { b[HeaderSize + 4] = std::byte{'x'}; });
    // A word that must be 0.
    forged([](auto& b) { put(b, ReservedAt, std::uint32_t{1}); });
    // Content that is not zstd, rightly signed.
    forged([](auto& b) {
        const auto offset = value_at<std::uint64_t>(b, HeaderSize + OffsetAt);
        const auto stored = value_at<std::uint64_t>(b, HeaderSize + StoredSizeAt);
        std::fill_n(b.begin() + static_cast<std::ptrdiff_t>(offset), stored, std::byte{7});
        put(b, HeaderSize + ChecksumAt, XXH64(b.data() + offset, stored, 0));
    });
}

TEST_F(SectionFileTest, WhatPacksWellIsReadAndLiesAreRefused) {
    // 3000 times its stored size: true, so it is read.
    std::vector<std::byte> zeros((std::size_t{1} << 27) + 12345);
    zeros.back() = std::byte{1};
    write_sections(file_, {{"zeros", zeros}});
    EXPECT_TRUE(read_sections(file_).at("zeros") == zeros);

    std::vector<std::byte> lie = files::read(file_);
    const auto offset = value_at<std::uint64_t>(lie, HeaderSize + OffsetAt);
    const std::uint64_t claimed = 0x0c000000; // 200 MB
    // zstd's magic number, a frame header with nothing but the size in four bytes, five bytes of
    // one last raw block.
    std::vector<std::byte> frame = text(std::string("\x28\xb5\x2f\xfd\xa0????\x29\0\0hello", 17));
    put(frame, 5, static_cast<std::uint32_t>(claimed));
    frame.resize(20000);
    lie.resize(offset);
    lie.insert(lie.end(), frame.begin(), frame.end());
    put(lie, FileSizeAt, std::uint64_t{lie.size()});
    put(lie, HeaderSize + StoredSizeAt, std::uint64_t{frame.size()});
    put(lie, HeaderSize + SizeAt, claimed);
    put(lie, HeaderSize + ChecksumAt, XXH64(frame.data(), frame.size(), 0));
    sign(lie);
    write(lie);
    expect_refused("expected zstd data, got a damaged section 'zeros'");
}

TEST_F(SectionFileTest, AFileHasOneBudget) {
    const SectionContent zeros(std::uint64_t{200} << 20,
                               [](std::uint64_t, std::span<std::byte> piece) {
                                   std::fill(piece.begin(), piece.end(), std::byte{0});
                               });
    const SectionContent too_many(std::uint64_t{300} << 20,
                                  [](std::uint64_t, std::span<std::byte> piece) {
                                      std::fill(piece.begin(), piece.end(), std::byte{0});
                                  });
    write_sections(file_, {{"a", zeros}, {"b", zeros}, {"c", too_many}, {"d", text("small")}});
    const PackedSections packed(file_);
    const auto refuses = [&](const std::string& name) {
        scenes::expect_refused(file_, "sections that a file of ",
                               [&] { static_cast<void>(packed.bytes(name)); });
    };
    refuses("c");
    scenes::expect_refused(file_, "sections that a file of ", [&] {
        packed.stream("c", std::nullopt, [](std::span<const std::byte>) {});
    });
    scenes::expect_refused(file_, "sections that a file of ",
                           [&] { static_cast<void>(packed.bytes("d", std::uint64_t{1} << 28)); });
    EXPECT_EQ(packed.bytes("a").size(), zeros.size());
    refuses("b"); // beside the first one
    EXPECT_EQ(packed.bytes("d"), text("small")) << "what nobody asks for costs nothing";
}

TEST_F(SectionFileTest, MillionsOfFramesAreRefused) {
    write_sections(file_, {{"empty", {}}});
    std::vector<std::byte> bad = files::read(file_);
    const auto offset =
        static_cast<std::ptrdiff_t>(value_at<std::uint64_t>(bad, HeaderSize + OffsetAt));
    const std::vector<std::byte> frame(bad.begin() + offset, bad.end());
    bad.insert(bad.end(), frame.begin(), frame.end());
    put(bad, FileSizeAt, std::uint64_t{bad.size()});
    put(bad, HeaderSize + StoredSizeAt, std::uint64_t{2 * frame.size()});
    put(bad, HeaderSize + ChecksumAt, XXH64(bad.data() + offset, 2 * frame.size(), 0));
    sign(bad);
    write(bad);
    expect_refused("expected zstd data, got a damaged section 'empty'");
}

TEST_F(SectionFileTest, LargeSectionsAreSeveralFrames) {
    std::mt19937 random(3);
    std::vector<std::byte> large((std::size_t{5} << 20) + 7);
    std::generate(large.begin(), large.end(), [&] { return static_cast<std::byte>(random() % 3); });
    write_sections(file_, {{"large", large}});
    EXPECT_TRUE(read_sections(file_).at("large") == large);
    std::vector<std::byte> streamed;
    PackedSections(file_).stream("large", large.size(), [&](std::span<const std::byte> piece) {
        streamed.insert(streamed.end(), piece.begin(), piece.end());
    });
    EXPECT_TRUE(streamed == large);

    const std::vector<std::byte> good = files::read(file_);
    const auto offset = value_at<std::uint64_t>(good, HeaderSize + OffsetAt);
    std::vector<std::size_t> ends = {offset};
    while (ends.back() < good.size())
        ends.push_back(ends.back() + ZSTD_findFrameCompressedSize(good.data() + ends.back(),
                                                                  good.size() - ends.back()));
    EXPECT_EQ(ends.size(), 4u) << "frames of 2 MiB";
    // A frame that is missing, and one too many.
    for (const bool is_missing : {true, false}) {
        std::vector<std::byte> bad = good;
        if (is_missing)
            bad.resize(ends[2]);
        else
            bad.insert(bad.end(), good.begin() + static_cast<std::ptrdiff_t>(ends[2]), good.end());
        const std::uint64_t stored = bad.size() - offset;
        put(bad, FileSizeAt, std::uint64_t{bad.size()});
        put(bad, HeaderSize + StoredSizeAt, stored);
        put(bad, HeaderSize + ChecksumAt, XXH64(bad.data() + offset, stored, 0));
        sign(bad);
        write(bad);
        expect_refused("expected zstd data, got a damaged section 'large'");
    }
}

TEST_F(SectionFileTest, UnwritablePlacesLeaveNothing) {
    const fs::path missing = folder_ / "missing" / "scene.prt";
    scenes::expect_refused(missing, "cannot write",
                           [&] { write_sections(missing, to_write(examples())); });
    fs::create_directories(folder_ / "folder.prt");
    const fs::path folder = folder_ / "folder.prt";
    scenes::expect_refused(folder, "cannot write",
                           [&] { write_sections(folder, to_write(examples())); });
    EXPECT_EQ(std::distance(fs::recursive_directory_iterator(folder_),
                            fs::recursive_directory_iterator()),
              1);
}

} // namespace
} // namespace relumine::prt
