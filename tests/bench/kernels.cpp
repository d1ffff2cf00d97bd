// Times of the steps that run when an environment changes, on a generated scene. See `./dev bench
// kernels --help`.
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "cubemap/layers/layer_composite.h"
#include "cubemap/resample/convert.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "lights/light_clusters.h"
#include "lights/place_lights.h"
#include "relight/relighter.h"
#include "relumine/in/precompute.h"
#include "relumine/light/edits.h"
#include "relumine/light/lit_scene.h"

namespace {

using namespace relumine;

/// With --tiny
bool is_tiny = false;

/// R of a map.
std::uint32_t resolution_of(std::int64_t full) {
    return static_cast<std::uint32_t>(is_tiny ? full / 16 : full);
}

/// A boulder of 20,000 vertices, precomputed once for all benchmarks.
struct Fixture {
    std::shared_ptr<const Scene> scene = std::make_shared<const Scene>(
        precompute(data_gen::blob(is_tiny ? 1000 : 20000),
                   {.tolerance = is_tiny ? 0.1f : 0.02f, .no_refine = is_tiny}));
    const prt::Transfer& transfer = scene->transfer;

    static const Fixture& instance() {
        static const Fixture Instance;
        return Instance;
    }
};

void BM_Bin(benchmark::State& state) {
    const Fixture& fixture = Fixture::instance();
    const std::uint32_t resolution = resolution_of(state.range(0));
    const cubemap::CubeMap map(resolution, glm::vec3(1.0f));
    const relight::LightBinning binning(resolution);
    for (auto _ : state)
        benchmark::DoNotOptimize(binning.sums(map, fixture.transfer.quadtree.leaves()));
    state.SetBytesProcessed(state.iterations() *
                            static_cast<std::int64_t>(map.texels.size() * sizeof(glm::vec3)));
}
BENCHMARK(BM_Bin)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

/// By an angle about no axis of the faces.
void BM_Turn(benchmark::State& state) {
    const cubemap::CubeMap map(resolution_of(state.range(0)), glm::vec3(1.0f));
    const glm::dmat3 turn = cubemap::turn_about_x(20.0) * cubemap::turn_about_y(33.0);
    for (auto _ : state)
        benchmark::DoNotOptimize(cubemap::turned(map, turn));
}
BENCHMARK(BM_Turn)->Arg(256)->Arg(512)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Relight(benchmark::State& state) {
    relight::Relighter relighter(Fixture::instance().transfer);
    const cubemap::CubeMap map = data_gen::two_soft_boxes(64);
    double seconds = 0.0;
    for (auto _ : state) {
        seconds = relighter.set_environment(map).seconds_relight;
        state.SetIterationTime(seconds);
    }
}
BENCHMARK(BM_Relight)->Unit(benchmark::kMillisecond)->UseManualTime();

void BM_Edit(benchmark::State& state) {
    relight::Relighter relighter(Fixture::instance().transfer);
    relighter.set_environment(data_gen::two_soft_boxes(256));
    const std::vector<glm::vec3> radiance(13 * 13, glm::vec3(2.0f));
    for (auto _ : state)
        benchmark::DoNotOptimize(
            update_region(relighter, {cubemap::Face::PositiveZ, 100, 60, 113, 73}, radiance));
}
void BM_CubeFromLatLong(benchmark::State& state) {
    cubemap::EnvironmentImage image;
    image.width = resolution_of(4096);
    image.height = image.width / 2;
    image.pixels.assign(std::size_t{image.width} * image.height, glm::vec3(1.0f));
    for (auto _ : state)
        benchmark::DoNotOptimize(
            cubemap::convert(image, {cubemap::Layout::Cube, cubemap::Sampling::TexelCentres,
                                     image.width / 4, image.width / 4 * 6}));
}
BENCHMARK(BM_CubeFromLatLong)->Unit(benchmark::kMillisecond)->UseRealTime();

BENCHMARK(BM_Edit)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 64 lights for a lat-long twice as wide as range(1), by method range(0).
void BM_PlaceLights(benchmark::State& state) {
    const std::uint32_t height = resolution_of(state.range(1));
    const cubemap::EnvironmentImage map = lights::lat_long_of(data_gen::two_soft_boxes(height / 2));
    const auto method = lights::AllMethods.at(static_cast<std::size_t>(state.range(0)));
    for (auto _ : state)
        benchmark::DoNotOptimize(lights::place(method, map, 64));
    state.SetLabel(std::string(lights::name(method)));
}
BENCHMARK(BM_PlaceLights)
    ->ArgsProduct({{0, 1, 2}, {512, 2048}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

/// A soft stroke of 81 points over 80 degrees, as a brush leaves it.
cubemap::Region stroke(double turn = 0.0) {
    cubemap::Stroke stroke{.radius_degrees = 4.0, .softness = 0.5};
    for (int i = 0; i <= 80; ++i) {
        const double angle = (i - 40) * std::numbers::pi / 180.0;
        stroke.points.emplace_back(std::sin(angle + turn), 0.2 * std::sin(5.0 * angle),
                                   std::cos(angle + turn));
    }
    return stroke;
}

/// A soft lasso of 120 points, 30 degrees wide, with a wavy outline.
cubemap::Region lasso(double turn = 0.0) {
    cubemap::Lasso lasso{.softness_degrees = 6.0};
    for (int i = 0; i < 120; ++i) {
        const double angle = i * std::numbers::pi / 60.0;
        const double radius = 0.5 + 0.06 * std::sin(7.0 * angle);
        const double x = radius * std::cos(angle) + 0.3;
        lasso.points.emplace_back(x * std::cos(turn) + std::sin(turn), radius * std::sin(angle),
                                  std::cos(turn) - x * std::sin(turn));
    }
    return lasso;
}

cubemap::LightLayer painted(const cubemap::Region& region) {
    return {.name = "painted", .region = region, .effect = cubemap::Emit{}};
}

/// Compositing alone, where the region lies.
template<cubemap::Region (*Shape)(double)>
void BM_Composite(benchmark::State& state) {
    const cubemap::CubeMap base(resolution_of(state.range(0)), glm::vec3(1.0f));
    const cubemap::LightLayer layer = painted(Shape(0.0));
    const std::vector<cubemap::TexelRectangle> touched =
        cubemap::touched_texels(layer, base.resolution);
    cubemap::CubeMap target = base;
    for (auto _ : state)
        cubemap::composite(base, {&layer, 1}, touched, target);
}
BENCHMARK(BM_Composite<stroke>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_Composite<lasso>)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_Touched(benchmark::State& state) {
    const cubemap::LightLayer layer = painted(stroke());
    for (auto _ : state)
        benchmark::DoNotOptimize(cubemap::touched_texels(layer, resolution_of(1024)));
}
BENCHMARK(BM_Touched)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A whole drag event: two degrees there and back.
template<cubemap::Region (*Shape)(double)>
void BM_Drag(benchmark::State& state) {
    LitScene editor(Fixture::instance().scene, {.clusters_only = true});
    editor.light(cubemap::CubeMap(resolution_of(1024), glm::vec3(1.0f)));
    set_layers(editor, {painted(Shape(0.0))});
    bool there = false;
    for (auto _ : state) {
        there = !there;
        set_layer(editor, 0, painted(Shape(there ? 0.035 : 0.0)));
    }
}
BENCHMARK(BM_Drag<stroke>)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_Drag<lasso>)->Unit(benchmark::kMillisecond)->UseRealTime();

/// A brush that paints on: one more point of the stroke.
void BM_Paint(benchmark::State& state) {
    LitScene editor(Fixture::instance().scene, {.clusters_only = true});
    editor.light(cubemap::CubeMap(resolution_of(1024), glm::vec3(1.0f)));
    const cubemap::LightLayer whole = painted(stroke());
    cubemap::LightLayer shorter = whole;
    std::get<cubemap::Stroke>(shorter.region).points.pop_back();
    set_layers(editor, {whole});
    bool longer = true;
    for (auto _ : state) {
        longer = !longer;
        set_layer(editor, 0, longer ? whole : shorter);
    }
}
BENCHMARK(BM_Paint)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 100 frames of 1,024 samples, a studio that turns, into 512 clusters.
void BM_ClusterLights(benchmark::State& state) {
    const cubemap::CubeMap studio = data_gen::two_soft_boxes(64);
    const lights::FrameSamples samples = lights::sample_frames(
        [&](std::size_t frame) {
            return lights::lat_long_of(cubemap::rotated(studio, 3.6 * static_cast<double>(frame)));
        },
        is_tiny ? 3 : 100);
    std::size_t num_iterations = 0;
    for (auto _ : state)
        num_iterations = lights::cluster_lights(samples).k_means.objective.size();
    state.SetLabel(std::to_string(num_iterations) + " assignments");
}
BENCHMARK(BM_ClusterLights)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace

// As benchmark_main, and --tiny: every benchmark once.
int main(int argc, char** argv) {
    std::vector<char*> arguments(argv, argv + argc);
    char once[] = "--benchmark_min_time=0.000001";
    for (char*& argument : arguments)
        if (argument == std::string("--tiny")) {
            is_tiny = true;
            argument = once;
        }
    int count = argc;
    benchmark::Initialize(&count, arguments.data());
    if (benchmark::ReportUnrecognizedArguments(count, arguments.data()))
        return 2;
    benchmark::RunSpecifiedBenchmarks();
    benchmark::Shutdown();
    return 0;
}
