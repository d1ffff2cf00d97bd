// What a conversion of an environment to another layout and back costs: the sky at natural
// resolution 16 (a lat-long of 64 x 32) with a sun that fills a part of one pixel, from each layout
// to each other, through the size that `env convert` chooses and through an equal one.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "cubemap/resample/convert.h"
#include "cubemap/resample/resample.h"
#include "tests/bench/program.h"
#include "tests/cubemap/sunny_sky.h"

using namespace relumine::cubemap;

namespace {

constexpr std::uint32_t SourceResolution = 16;

/// The crosses and the strip are the cube's pixels elsewhere: bit by bit the same.
constexpr std::array<Layout, 5> Layouts = {Layout::LatLong, Layout::Cube, Layout::AngularMap,
                                           Layout::MirrorBall, Layout::Octahedral};

/// Three at a time, one in each channel: nothing in a conversion mixes them.
constexpr std::size_t NumSuns = 6;
struct Sun {
    const char* place;
    glm::dvec3 direction;
};
const std::array<Sun, NumSuns> Suns = {{
    {"near the pole of a lat-long and an octahedral map's middle", {0.1, 0.99, 0.05}},
    {"near the other pole and an octahedral map's corners", {-0.03, -1.0, 0.06}},
    {"at the rim of an angular map, 2 degrees from +Z", {0.03, 0.02, 1.0}},
    {"at the rim of a mirror ball, 2 degrees from -Z", {0.03, 0.02, -1.0}},
    {"6 degrees from -Z", {-0.08, 0.07, -1.0}},
    {"on an edge of a cube and an octahedral map's crease", {1.0, 0.01, 0.99}},
}};

/// A smooth sky, and in each channel a sun of its own.
CubeMap sky(std::size_t first_sun) {
    CubeMap map = smooth_sky();
    for (int channel = 0; channel < 3; ++channel) {
        glm::vec3 color(0.0f);
        color[channel] = 1.0f;
        add_sun(map, glm::normalize(Suns[first_sun + static_cast<std::size_t>(channel)].direction),
                color);
    }
    return map;
}

/// Total power and then the irradiance of every normal.
std::vector<glm::dvec3> measured(const EnvironmentImage& image) {
    const CubeMap map = resample(image, 128);
    std::vector<glm::dvec3> values = {total_power(map)};
    for (const glm::dvec3& normal : even_normals())
        values.push_back(irradiance(map, normal));
    return values;
}

/// Largest errors, relative.
struct Errors {
    double power = 0.0;
    /// Irradiance, relative to the same normal's where that is not much darker than the brightest
    double own = 0.0;
    /// Irradiance, relative to the largest
    double largest = 0.0;
    /// Where `own` occurred
    std::size_t sun = 0;

    void add(const std::vector<glm::dvec3>& before, const std::vector<glm::dvec3>& after,
             std::size_t first_sun, double darkest) {
        for (int channel = 0; channel < 3; ++channel) {
            power = std::max(power, std::abs(after[0][channel] / before[0][channel] - 1.0));
            double brightest = 0.0;
            for (std::size_t i = 1; i < before.size(); ++i)
                brightest = std::max(brightest, before[i][channel]);
            for (std::size_t i = 1; i < before.size(); ++i) {
                const double error = std::abs(after[i][channel] - before[i][channel]);
                largest = std::max(largest, error / brightest);
                if (before[i][channel] < darkest * brightest || error <= own * before[i][channel])
                    continue;
                own = error / before[i][channel];
                sun = first_sun + static_cast<std::size_t>(channel);
            }
        }
    }
};

struct Settings {
    /// On the way; 0: what conversion_size() says
    std::uint32_t resolution = 0;
    double darkest = 0.01;
    /// One layout only
    std::string from, through;
};

ImageShape shape_of(Layout layout, const ImageSize& size) {
    return {layout, Sampling::TexelCentres, size.width, size.height};
}

Errors there_and_back(Layout layout, Layout other, std::uint32_t resolution, double darkest) {
    const ImageShape shape = shape_of(layout, natural_size(layout, SourceResolution));
    Errors errors;
    for (std::size_t sun = 0; sun < NumSuns; sun += 3) {
        const EnvironmentImage image = to_image(sky(sun), layout, shape.width, shape.height);
        const ImageSize size =
            resolution == 0 ? conversion_size(image, other) : natural_size(other, resolution);
        const EnvironmentImage back = convert(convert(image, shape_of(other, size)), shape);
        errors.add(measured(image), measured(back), sun, darkest);
    }
    return errors;
}

std::string percent(double value) {
    return fmt::format("{:.2g} %", 100.0 * value);
}

void run(const Settings& settings) {
    fmt::print("{} places of the sun:\n\n", NumSuns);
    for (const Sun& sun : Suns)
        fmt::print("- {}\n", sun.place);
    fmt::print(
        "\n| from | through | power | own | largest | worst sun | equal size: own | largest |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (const Layout layout : Layouts) {
        for (const Layout other : Layouts) {
            if (layout == other || (!settings.from.empty() && settings.from != name(layout)) ||
                (!settings.through.empty() && settings.through != name(other)))
                continue;
            const Errors roomy =
                there_and_back(layout, other, settings.resolution, settings.darkest);
            const Errors equal = there_and_back(layout, other, SourceResolution, settings.darkest);
            fmt::print("| {} | {} | {} | {} | {} | {} | {} | {} |\n", name(layout), name(other),
                       percent(roomy.power), percent(roomy.own), percent(roomy.largest),
                       Suns.at(roomy.sun).place, percent(equal.own), percent(equal.largest));
            std::fflush(stdout);
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    Settings settings;
    relumine::bench::Program program(
        "bench_layouts", "what environments lose on the way to another layout and back: Markdown "
                         "on stdout, in some minutes");
    program.add("--face-resolution", settings.resolution,
                "natural resolution on the way, 0: what `env convert` chooses");
    program.add("--darkest", settings.darkest,
                "normals with less than this part of the largest irradiance count only against the "
                "largest");
    program.add("--from", settings.from, "this layout only, as the table names it");
    program.add("--through", settings.through, "this layout on the way only");
    return program.run(argc, argv, [&] {
        if (program.is_tiny()) {
            settings.from = name(Layout::LatLong);
            settings.through = name(Layout::Cube);
            settings.resolution = SourceResolution;
        }
        run(settings);
    });
}
