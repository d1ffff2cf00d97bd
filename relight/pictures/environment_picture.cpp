#include "relight/pictures/environment_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "cubemap/doctor/sky_angles.h"
#include "cubemap/luminance.h"
#include "cubemap/resample/resample.h"
#include "relight/pictures/picture.h"
#include "relight/pictures/tone_map.h"

namespace relumine::relight {

namespace {

constexpr int MapWidth = 1024, MapHeight = 512;
/// Pixels of a letter's dot, on a side.
constexpr int Dot = 2;

struct Glyph {
    char letter;
    std::array<std::string_view, 7> rows;
};

constexpr std::array<Glyph, 9> Glyphs = {{
    {'+', {".....", "..#..", "..#..", "#####", "..#..", "..#..", "....."}},
    {'-', {".....", ".....", ".....", "#####", ".....", ".....", "....."}},
    {'X', {"#...#", "#...#", ".#.#.", "..#..", ".#.#.", "#...#", "#...#"}},
    {'Y', {"#...#", "#...#", ".#.#.", "..#..", "..#..", "..#..", "..#.."}},
    {'Z', {"#####", "....#", "...#.", "..#..", ".#...", "#....", "#####"}},
    {'s', {".....", ".....", ".####", "#....", ".###.", "....#", "####."}},
    {'u', {".....", ".....", "#...#", "#...#", "#...#", "#..##", ".##.#"}},
    {'n', {".....", ".....", "#.##.", "##..#", "#...#", "#...#", "#...#"}},
    {'?', {".###.", "#...#", "....#", "...#.", "..#..", ".....", "..#.."}},
}};

class Canvas {
public:
    explicit Canvas(relight::Picture& picture) : picture_(picture) {}

    void put(int x, int y, const glm::vec3& colour, float opacity = 1.0f) {
        if (x < 0 || y < 0 || x >= MapWidth || y >= MapHeight)
            return;
        glm::vec3& pixel =
            picture_.pixels[static_cast<std::size_t>(y) * MapWidth + static_cast<std::size_t>(x)];
        pixel = glm::mix(pixel, colour, opacity);
    }

    /// Fills a rectangle's pixels.
    void box(int x0, int y0, int x1, int y1, const glm::vec3& colour, float opacity) {
        for (int y = y0; y < y1; ++y)
            for (int x = x0; x < x1; ++x)
                put(x, y, colour, opacity);
    }

    /// Draws letters centred at (x, y), moved into the picture.
    void text(int x, int y, std::string_view letters, const glm::vec3& colour) {
        const int width = static_cast<int>(letters.size()) * 6 * Dot + Dot, height = 9 * Dot;
        const int left = std::clamp(x - width / 2, 0, MapWidth - width);
        const int top = std::clamp(y - height / 2, 0, MapHeight - height);
        box(left, top, left + width, top + height, glm::vec3(0.0f), 0.7f);
        int start = left + Dot;
        for (const char letter : letters) {
            const auto glyph = std::find_if(Glyphs.begin(), Glyphs.end(),
                                            [&](const Glyph& g) { return g.letter == letter; });
            if (glyph == Glyphs.end())
                throw std::invalid_argument(fmt::format("no picture of the letter '{}'", letter));
            for (int row = 0; row < 7; ++row) {
                for (int column = 0; column < 5; ++column) {
                    const int dot_x = start + column * Dot, dot_y = top + (row + 1) * Dot;
                    if (glyph->rows[static_cast<std::size_t>(row)]
                                   [static_cast<std::size_t>(column)] == '#')
                        box(dot_x, dot_y, dot_x + Dot, dot_y + Dot, colour, 1.0f);
                }
            }
            start += 6 * Dot;
        }
    }

    void cross(int x, int y, const glm::vec3& colour) {
        constexpr int Arm = 9;
        box(x - Arm - 1, y - 2, x + Arm + 2, y + 3, glm::vec3(0.0f), 0.7f);
        box(x - 2, y - Arm - 1, x + 3, y + Arm + 2, glm::vec3(0.0f), 0.7f);
        box(x - Arm, y - 1, x + Arm + 1, y + 2, colour, 1.0f);
        box(x - 1, y - Arm, x + 2, y + Arm + 1, colour, 1.0f);
    }

    void ring(double x, double y, const glm::vec3& colour) {
        constexpr double Radius = 14.0;
        const auto reach = static_cast<int>(Radius) + 4;
        for (int dy = -reach; dy <= reach; ++dy) {
            for (int dx = -reach; dx <= reach; ++dx) {
                const int column = static_cast<int>(x) + dx, row = static_cast<int>(y) + dy;
                const double off = std::abs(std::hypot(column + 0.5 - x, row + 0.5 - y) - Radius);
                // The ring goes on at the other end of the row, as the sky does.
                if (off < 3.0)
                    put((column + MapWidth) % MapWidth, row, off < 1.5 ? colour : glm::vec3(0.0f),
                        off < 1.5 ? 1.0f : 0.6f);
            }
        }
    }

private:
    relight::Picture& picture_;
};

struct Place {
    double x, y;
};

Place place(const glm::dvec3& w) {
    const cubemap::SkyAngles angles = cubemap::sky_angles(w);
    return {(0.5 - angles.azimuth_degrees / 360.0) * MapWidth,
            (0.5 - angles.elevation_degrees / 180.0) * MapHeight};
}

/// Tone-maps the pixels. The brightest stays below white, and a black one does not spoil the mean.
void tone_map(std::vector<glm::vec3>& pixels) {
    std::vector<LuminanceSample> samples;
    samples.reserve(pixels.size());
    for (const glm::vec3& pixel : pixels)
        samples.push_back({.luminance = cubemap::luminance(glm::dvec3(pixel))});
    const ToneMap map(std::move(samples), {.floor = 1e-6});
    for (glm::vec3& pixel : pixels)
        pixel = map(glm::dvec3(pixel));
}

} // namespace

void save_environment_picture(const std::string& path, const cubemap::EnvironmentImage& image,
                              const SunMark& sun) {
    const cubemap::CubeMap map = cubemap::resample(
        image, std::min<std::uint32_t>(MapWidth / 4, cubemap::natural_resolution(image)));
    relight::Picture picture{
        .width = MapWidth,
        .height = MapHeight,
        .pixels = cubemap::to_image(map, cubemap::Layout::LatLong, MapWidth, MapHeight).pixels};
    tone_map(picture.pixels);

    Canvas canvas(picture);
    for (int x = 0; x < MapWidth; x += 8)
        canvas.box(x, MapHeight / 2, x + 2, MapHeight / 2 + 1, glm::vec3(1.0f), 0.6f);
    const glm::vec3 red(1.0f, 0.12f, 0.1f), green(0.15f, 0.9f, 0.15f), blue(0.25f, 0.5f, 1.0f),
        yellow(1.0f, 0.85f, 0.05f);
    struct Axis {
        std::string_view name;
        int x, y;
        glm::vec3 colour;
    };
    constexpr int Beside = 22; // from a cross to its name
    const int middle = MapHeight / 2;
    // A pole is a whole row of the picture, and -Z lies on both its ends.
    for (const Axis& axis :
         {Axis{"+X", MapWidth / 4, middle, red}, Axis{"-X", 3 * MapWidth / 4, middle, red},
          Axis{"+Z", MapWidth / 2, middle, blue}, Axis{"-Z", 0, middle, blue},
          Axis{"-Z", MapWidth - 1, middle, blue}, Axis{"+Y", MapWidth / 2, 0, green},
          Axis{"-Y", MapWidth / 2, MapHeight - 1, green}}) {
        canvas.cross(axis.x, axis.y, axis.colour);
        canvas.text(axis.x, axis.y + (axis.y > middle ? -Beside : Beside), axis.name, axis.colour);
    }
    if (!sun.label.empty()) {
        const Place at = place(sun.direction);
        canvas.ring(at.x, at.y, yellow);
        canvas.text(static_cast<int>(at.x), static_cast<int>(at.y + (at.y > 40.0 ? -28.0 : 28.0)),
                    sun.label, yellow);
    }
    relight::save_picture(path, picture);
}

} // namespace relumine::relight
