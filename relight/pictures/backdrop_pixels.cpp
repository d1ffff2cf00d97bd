#include "relight/pictures/backdrop_pixels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include <glm/common.hpp>
#include <glm/vec2.hpp>
#include <glm/vector_relational.hpp>

namespace relumine::relight {

namespace {

/// Returns the mean of a backdrop over a pixel whose corners see nearly the same of it.
std::optional<glm::vec3> even_backdrop(const prt::PictureRays& rays, std::uint32_t x,
                                       std::uint32_t y, const Backdrop& backdrop) {
    const std::uint32_t side = rays.samples_per_axis();
    if (side <= 2)
        return std::nullopt;
    glm::vec3 low(std::numeric_limits<float>::infinity()), high(0.0f), sum(0.0f);
    for (const std::uint32_t corner : {0u, side - 1, side * (side - 1), side * side - 1}) {
        const glm::vec3 seen = backdrop(rays.direction(x, y, corner));
        low = glm::min(low, seen);
        high = glm::max(high, seen);
        sum += seen;
    }
    constexpr float Alike = 0.9f;
    return glm::all(glm::greaterThanEqual(low, Alike * high)) ? std::optional(sum / 4.0f)
                                                              : std::nullopt;
}

/// Where the corners of an open pixel see nearly the same, nothing else is asked.
glm::vec3 seen_one_by_one(const prt::PictureRays& rays, std::uint32_t x, std::uint32_t y,
                          std::span<const glm::vec3> passed, const Backdrop& backdrop) {
    const auto num = static_cast<float>(passed.size());
    const bool is_open = std::find(passed.begin(), passed.end(), glm::vec3(0.0f)) == passed.end();
    if (const auto even = is_open ? even_backdrop(rays, x, y, backdrop) : std::nullopt)
        return std::accumulate(passed.begin(), passed.end(), glm::vec3(0.0f)) / num * *even;
    glm::vec3 sum(0.0f);
    for (std::uint32_t i = 0; i < passed.size(); ++i)
        if (passed[i] != glm::vec3(0.0f))
            sum += passed[i] * backdrop(rays.direction(x, y, i));
    return sum / num;
}

/// Whether the steps between places, and their changes, are so small that places in between follow:
/// no seam and no pole lies near. A straight line misses a curve by an eighth of its bend.
bool are_smooth(std::span<const glm::dvec2> steps, std::span<const glm::dvec2> bends) {
    constexpr double LargestStep = 4.0, LargestBend = 0.05;
    const auto within = [](std::span<const glm::dvec2> some, double most) {
        return std::all_of(some.begin(), some.end(), [&](const glm::dvec2& v) {
            return std::abs(v.x) < most && std::abs(v.y) < most;
        });
    };
    return within(steps, LargestStep) && within(bends, LargestBend);
}

/// The pixels around a place, and how far it lies between them.
struct Cell {
    std::int64_t x = 0, y = 0;
    glm::vec2 part{0.0f};

    explicit Cell(const glm::dvec2& place) {
        const glm::dvec2 whole = glm::floor(place);
        x = static_cast<std::int64_t>(whole.x);
        y = static_cast<std::int64_t>(whole.y);
        part = glm::vec2(place - whole);
    }
};

/// The four pixels around a cell's places.
struct CellPixels {
    glm::vec3 first, right, down, both;

    CellPixels(const Chart& chart, const Cell& cell) {
        const auto width = static_cast<std::int64_t>(chart.image->width);
        const auto height = static_cast<std::int64_t>(chart.image->height);
        const auto column = [&](std::int64_t x) {
            if (chart.is_closed)
                x = x < 0 ? x + width : x >= width ? x - width : x;
            return std::clamp<std::int64_t>(x, 0, width - 1);
        };
        const auto row = [&](std::int64_t y) {
            return std::clamp<std::int64_t>(y, 0, height - 1) * width;
        };
        const std::int64_t left = column(cell.x), other = column(cell.x + 1);
        const std::int64_t above = row(cell.y), below = row(cell.y + 1);
        const auto pixel = [&](std::int64_t at) -> const glm::vec3& {
            return chart.image->pixels[static_cast<std::size_t>(at)];
        };
        first = pixel(above + left);
        right = pixel(above + other) - first;
        down = pixel(below + left) - first;
        both = pixel(below + other) - first - right - down;
    }
    /// Returns the colour at one place, or the mean over places with these means of their parts and
    /// their product.
    [[nodiscard]] glm::vec3 at(const glm::vec2& part, float product) const {
        return first + part.x * right + part.y * down + product * both;
    }
};

} // namespace

BackdropPixels::BackdropPixels(const prt::PictureRays& rays, const Backdrop& backdrop,
                               const PixelRectangle& pixels)
    : rays_(rays), backdrop_(backdrop), pixels_(pixels) {
    if (backdrop.chart() == nullptr)
        return;
    const std::size_t num_corners = (pixels.width() + 1) * (pixels.bottom - pixels.top + 1);
    spots_.resize(num_corners);
    known_.resize(num_corners);
}

const ChartSpot& BackdropPixels::corner(std::uint32_t x, std::uint32_t y) {
    const std::size_t i = (y - pixels_.top) * (pixels_.width() + 1) + (x - pixels_.left);
    if (!known_[i]) {
        spots_[i] = backdrop_.chart()->spot(rays_.direction(glm::vec2(x, y)));
        known_[i] = true;
    }
    return spots_[i];
}

bool BackdropPixels::is_smooth(std::uint32_t x, std::uint32_t y) {
    if (pixels_.width() < 2 || pixels_.bottom - pixels_.top < 2)
        return false;
    // A line through the pixel's corners and the next one, inside of the rectangle.
    const std::uint32_t left = x + 2 <= pixels_.right ? x : x - 1;
    const std::uint32_t top = y + 2 <= pixels_.bottom ? y : y - 1;
    const auto place = [&](std::uint32_t u, std::uint32_t v) {
        return corner(u, v).place;
    };
    const glm::dvec2 first = place(left, y), second = place(left + 1, y),
                     third = place(left + 2, y);
    const glm::dvec2 above = place(x, top), middle = place(x, top + 1), below = place(x, top + 2);
    const std::array<glm::dvec2, 4> steps = {second - first, third - second, middle - above,
                                             below - middle};
    const std::array<glm::dvec2, 3> bends = {steps[1] - steps[0], steps[3] - steps[2],
                                             place(x + 1, y + 1) - place(x, y + 1) -
                                                 (place(x + 1, y) - place(x, y))};
    return are_smooth(steps, bends);
}

glm::vec3 BackdropPixels::seen(std::uint32_t x, std::uint32_t y,
                               std::span<const glm::vec3> passed) {
    if (const Chart* chart = backdrop_.chart(); chart != nullptr && is_smooth(x, y))
        return seen_on(*chart,
                       {corner(x, y), corner(x + 1, y), corner(x, y + 1), corner(x + 1, y + 1)},
                       passed);
    return seen_one_by_one(rays_, x, y, passed, backdrop_);
}

glm::vec3 BackdropPixels::seen_on(const Chart& chart, const std::array<ChartSpot, 4>& corners,
                                  std::span<const glm::vec3> passed) const {
    const std::uint32_t side = rays_.samples_per_axis();
    const glm::dvec2 right = corners[1].place - corners[0].place,
                     down = corners[2].place - corners[0].place,
                     both = corners[3].place - corners[2].place - right;
    const float step = 1.0f / static_cast<float>(side);
    const auto count = static_cast<float>(passed.size());
    const auto place = [&](float across, float along) {
        return corners[0].place + double{across} * right + double{along} * down +
               double{across * along} * both;
    };
    const auto hidden = [&](float across, float along) {
        return glm::mix(glm::mix(corners[0].hidden, corners[1].hidden, across),
                        glm::mix(corners[2].hidden, corners[3].hidden, across), along);
    };
    const bool is_plain = std::all_of(passed.begin(), passed.end(),
                                      [&](const glm::vec3& p) { return p == passed[0]; });
    const Cell first(corners[0].place);
    if (is_plain && std::all_of(corners.begin() + 1, corners.end(), [&](const ChartSpot& spot) {
            const Cell own(spot.place);
            return own.x == first.x && own.y == first.y;
        })) {
        // All samples lie between the same four pixels.
        glm::vec2 sum(0.0f);
        float products = 0.0f;
        for (std::uint32_t row = 0; row < side; ++row)
            for (std::uint32_t column = 0; column < side; ++column) {
                const glm::vec2 at = (glm::vec2(column, row) + 0.5f) * step;
                const glm::vec2 part =
                    first.part + glm::vec2(at.x * glm::vec2(right) + at.y * glm::vec2(down) +
                                           at.x * at.y * glm::vec2(both));
                sum += part;
                products += part.x * part.y;
            }
        const glm::vec3 shown = CellPixels(chart, first).at(sum / count, products / count);
        return passed[0] * glm::mix(shown, chart.hiding, hidden(0.5f, 0.5f));
    }
    glm::vec3 sum(0.0f);
    for (std::uint32_t row = 0; row < side; ++row)
        for (std::uint32_t column = 0; column < side; ++column) {
            const glm::vec3& own = passed[row * side + column];
            if (own == glm::vec3(0.0f))
                continue;
            const glm::vec2 at = (glm::vec2(column, row) + 0.5f) * step;
            const Cell cell(place(at.x, at.y));
            sum += own * glm::mix(CellPixels(chart, cell).at(cell.part, cell.part.x * cell.part.y),
                                  chart.hiding, hidden(at.x, at.y));
        }
    return sum / count;
}

} // namespace relumine::relight
