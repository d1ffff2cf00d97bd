// Times of the steps that run when an environment changes, on a generated scene. See `./dev bench kernels --help`.
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "cubemap/convert.h"
#include "data_gen/environments.h"
#include "data_gen/scenes.h"
#include "lights/place_lights.h"
#include "prt/precompute.h"
#include "prt/ray_scene.h"
#include "relight/relighter.h"

namespace {

using namespace relumine;

/// A boulder of 20,000 vertices, precomputed once for all benchmarks.
struct Fixture {
    mesh::TriangleMesh mesh = data_gen::blob(20000);
    prt::RayScene rays{mesh};
    prt::Transfer transfer = prt::precompute(prt::vertex_receivers(mesh), rays,
                                             {.tolerance = 0.02f, .bias = prt::automatic_bias(mesh)});

    static const Fixture& instance() {
        static const Fixture Instance;
        return Instance;
    }
};

void BM_Bin(benchmark::State& state) {
    const Fixture& fixture = Fixture::instance();
    const auto resolution = static_cast<std::uint32_t>(state.range(0));
    const cubemap::CubeMap map(resolution, glm::vec3(1.0f));
    const relight::LightBinning binning(resolution);
    for (auto _ : state)
        benchmark::DoNotOptimize(binning.sums(map, fixture.transfer.quadtree.leaves()));
    state.SetBytesProcessed(
        static_cast<std::int64_t>(state.iterations() * map.texels.size() * sizeof(glm::vec3)));
}
BENCHMARK(BM_Bin)->Arg(256)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

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
            relighter.update_region({cubemap::Face::PositiveZ, 100, 60, 113, 73}, radiance));
}
void BM_CubeFromLatLong(benchmark::State& state) {
    cubemap::EnvironmentImage image;
    image.width = 4096;
    image.height = 2048;
    image.pixels.assign(std::size_t{image.width} * image.height, glm::vec3(1.0f));
    for (auto _ : state)
        benchmark::DoNotOptimize(
            cubemap::convert(image, {cubemap::Layout::Cube, cubemap::Sampling::TexelCentres, 1024, 6144}));
}
BENCHMARK(BM_CubeFromLatLong)->Unit(benchmark::kMillisecond)->UseRealTime();

BENCHMARK(BM_Edit)->Unit(benchmark::kMillisecond)->UseRealTime();

/// 64 lights for a lat-long twice as wide as range(1), by method range(0).
void BM_PlaceLights(benchmark::State& state) {
    const auto height = static_cast<std::uint32_t>(state.range(1));
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

} // namespace
