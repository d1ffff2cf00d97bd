#include "prt/scene/bounce_sections.h"

#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

namespace relumine::prt {
namespace {

constexpr std::size_t NumReceivers = 100'000;

/// Rows of every kind: empty, with columns far apart, with the same column twice.
BounceMatrix matrix_of_all_kinds() {
    BounceMatrix matrix{.weights = std::vector(NumReceivers, 0.0f), .spectral_radius = 0.25f};
    const std::vector<std::vector<std::uint32_t>> rows = {
        {0}, {}, {5, 5, 5}, {0, 127, 128, 255, 16'600, 99'999}, {99'999}};
    for (std::size_t place = 0; place < NumReceivers; ++place) {
        if (place < rows.size()) {
            matrix.columns.insert(matrix.columns.end(), rows[place].begin(), rows[place].end());
            matrix.weights[place] = rows[place].empty() ? 0.0f : 0.125f;
        }
        matrix.row_begin.push_back(matrix.columns.size());
    }
    return matrix;
}

TEST(BounceSections, KeepEveryRow) {
    const BounceMatrix matrix = matrix_of_all_kinds();
    Sections sections;
    add_bounce_sections(sections, matrix);
    const SectionReader reader("scene.prt", std::move(sections));
    EXPECT_EQ(read_bounces(reader, NumReceivers), matrix);
}

TEST(BounceSections, MayBeAbsent) {
    EXPECT_FALSE(read_bounces(SectionReader("scene.prt", {}), NumReceivers));
}

TEST(BounceSections, DamageIsRefused) {
    const auto refuses = [](const std::function<void(Sections&)>& damage) {
        Sections sections;
        add_bounce_sections(sections, matrix_of_all_kinds());
        damage(sections);
        const SectionReader reader("scene.prt", std::move(sections));
        EXPECT_THROW(static_cast<void>(read_bounces(reader, NumReceivers)), std::runtime_error);
    };
    refuses([](Sections& s) { s["bounce_weights"].pop_back(); });
    refuses([](Sections& s) { s["bounce_sizes"].pop_back(); });
    refuses([](Sections& s) { s["bounce_sizes"][1] = std::byte{1}; });
    refuses([](Sections& s) { s["bounce_columns"].pop_back(); });
    refuses([](Sections& s) { s["bounce_columns"].push_back(std::byte{0}); });
    refuses([](Sections& s) { s["bounce_columns"].back() = std::byte{0xff}; });
    refuses([](Sections& s) { s["bounce_radius"].clear(); });
    refuses([](Sections& s) { s.erase("bounce_sizes"); });
    refuses([](Sections& s) { s["bounce_radius"] = bytes_of(std::vector{-1.0f}); });
    refuses([](Sections& s) { s["bounce_weights"] = bytes_of(std::vector(NumReceivers, 2.0f)); });
    // A size that lies must not be believed.
    refuses([](Sections& s) { s["bounce_sizes"][3] = std::byte{0xff}; });
}

} // namespace
} // namespace relumine::prt
