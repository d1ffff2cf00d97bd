#include "prt/scene/bounce_sections.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/prt/made_sections.h"

namespace relumine::prt {
namespace {

constexpr std::size_t NumReceivers = 100'000;

Receivers receivers() {
    return {.positions = std::vector(NumReceivers, glm::vec3(0.0f)), .normals = {}};
}

/// Two points in space before the others.
Receivers with_points() {
    Receivers result = receivers();
    result.have_no_surface = true;
    result.num_added = NumReceivers - 2;
    return result;
}

/// Lists of every kind: empty, with places far apart, with the same place twice.
BounceMatrix matrix_of_all_kinds() {
    BounceMatrix matrix{.weights = std::vector(NumReceivers, 0.0f),
                        .emitters = {},
                        .averaged = {},
                        .spectral_radius = 0.25f};
    const std::vector<std::vector<std::uint32_t>> emitters = {
        {0}, {}, {5, 5, 5}, {0, 127, 128, 255, 16'600, 99'999}, {99'999}};
    const std::vector<std::vector<std::uint32_t>> averaged = {{0, 2}, {}, {2}, {3}, {0, 4}};
    for (std::size_t place = 0; place < NumReceivers; ++place) {
        const bool is_first = place < emitters.size();
        matrix.emitters.append(is_first ? emitters[place] : std::vector<std::uint32_t>());
        matrix.averaged.append(is_first ? averaged[place] : std::vector<std::uint32_t>());
        matrix.weights[place] = is_first ? 0.125f : 0.0f;
    }
    return matrix;
}

TEST(BounceSections, KeepEveryRow) {
    const BounceMatrix matrix = matrix_of_all_kinds();
    NewSections sections;
    add_bounce_sections(sections, matrix);
    const SectionReader reader("scene.prt", packed_sections(sections));
    EXPECT_EQ(read_bounces(reader, receivers()), matrix);
}

TEST(BounceSections, KeepListsOfManyMegabytes) {
    // They are read in pieces of a megabyte on all threads; the longest list spans several.
    std::mt19937 random(1);
    BounceMatrix matrix{.weights = std::vector(NumReceivers, 0.125f),
                        .emitters = {},
                        .averaged = {},
                        .spectral_radius = 0.25f};
    for (std::size_t place = 0; place < NumReceivers; ++place) {
        std::vector<std::uint32_t> list(place == 40'000 ? 3'000'000
                                                        : random() % 3 * (random() % 60));
        for (std::uint32_t& emitter : list)
            emitter = static_cast<std::uint32_t>(random() % NumReceivers);
        std::sort(list.begin(), list.end());
        matrix.emitters.append(list);
        matrix.averaged.append({});
    }
    NewSections sections;
    add_bounce_sections(sections, matrix);
    const SectionReader reader("scene.prt", packed_sections(sections));
    ASSERT_GT(reader.size("bounce_hits"), std::size_t{6} << 20);
    EXPECT_TRUE(read_bounces(reader, receivers()) == matrix);
}

TEST(BounceSections, MayBeAbsent) {
    EXPECT_FALSE(read_bounces(scenes::reader_of("scene.prt", {}), receivers()));
}

TEST(BounceSections, KeepWhatPointsSee) {
    BounceMatrix matrix = matrix_of_all_kinds();
    matrix.points = {.num_directions = 3,
                     .emitters = {NoEmitter, 2, 99'999, 4, NoEmitter, NoEmitter}};
    NewSections sections;
    add_bounce_sections(sections, matrix);
    const SectionReader reader("scene.prt", packed_sections(sections));
    EXPECT_EQ(read_bounces(reader, with_points()), matrix);
}

TEST(BounceSections, DamageIsRefused) {
    const auto refuses = [](const std::function<void(Sections&)>& damage) {
        BounceMatrix matrix = matrix_of_all_kinds();
        matrix.points = {.num_directions = 2, .emitters = {2, NoEmitter, 4, 3}};
        NewSections added;
        add_bounce_sections(added, matrix);
        Sections sections = scenes::made(added);
        damage(sections);
        const SectionReader reader = scenes::reader_of("scene.prt", std::move(sections));
        EXPECT_THROW(static_cast<void>(read_bounces(reader, with_points())), std::runtime_error);
    };
    refuses([](Sections& s) { s["bounce_weights"].pop_back(); });
    for (const std::string name : {"bounce_hits", "bounce_near"}) {
        const std::string size = name + "_size";
        refuses([&](Sections& s) { s[size].pop_back(); });
        refuses([&](Sections& s) { s[size][4] = std::byte{1}; });
        refuses([&](Sections& s) { s[name].pop_back(); });
        refuses([&](Sections& s) { s[name].push_back(std::byte{0}); });
        refuses([&](Sections& s) { s[name].back() = std::byte{0xff}; });
        refuses([&](Sections& s) { s.erase(size); });
        // A size that lies must not be believed.
        refuses([&](Sections& s) { s[size][15] = std::byte{0xff}; });
    }
    refuses([](Sections& s) { s["bounce_radius"].clear(); });
    refuses([](Sections& s) { s.erase("point_rays"); });
    refuses([](Sections& s) { s["point_rays"][0] = std::byte{0}; });
    refuses([](Sections& s) { s["point_rays"][3] = std::byte{0xff}; });
    refuses([](Sections& s) { s["point_hits"].pop_back(); });
}

} // namespace
} // namespace relumine::prt
