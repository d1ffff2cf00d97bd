// The same input gives the same file: with any number of threads, in a second run, and, for a scene
// without rays in doubt, on other processors. docs/robustness.md says what is promised.
#include <filesystem>
#include <map>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <tbb/task_arena.h>
#include <unistd.h>
#include <xxhash.h>

#include "files/output_file.h"
#include "files/parallel.h"
#include "prt/glossy/glossy_precompute.h"
#include "prt/precompute.h"
#include "prt/scene/packed_sections.h"
#include "prt/scene/scene_file.h"
#include "prt/scene/section_reader.h"
#include "prt/visibility/beam_scene.h"
#include "prt/visibility/ray_scene.h"
#include "tests/processor/limits.h"
#include "tests/prt/every_target.h"
#include "tests/prt/scenes.h"

namespace relumine::prt {
namespace {

enum class Shine { Diffuse, Glossy };

/// Hard and soft shadows; with highlights of GGX of several widths. Made without sines and powers,
/// which C libraries round in their own way.
Scene precomputed(Shine shine) {
    Scene scene;
    scene.mesh = scenes::sphere_and_box_on_floor();
    scene.receivers = vertex_receivers(scene.mesh);
    const RayScene rays(scene.mesh);
    const BeamScene beams(scene.mesh, rays);
    const PrecomputeOptions options{
        .tolerance = 0.02f, .face_resolution = 64, .bias = automatic_bias(scene.mesh)};
    if (shine == Shine::Glossy) {
        look_from(scene.receivers, {1.5f, 2.5f, 3.0f});
        for (std::size_t i = 0; i < scene.receivers.size(); ++i)
            scene.receivers.surfaces.push_back(
                {.specular = glm::vec3(0.04f, 0.3f, 0.9f),
                 .highlight = i % 3 == 2 ? Highlight::None : Highlight::Ggx,
                 .roughness_or_exponent = i % 3 == 0 ? 0.25f : 0.5f});
    }
    scene.transfer = precompute(scene.receivers, beams, options);
    if (shine == Shine::Glossy) {
        scene.transfer.glossy = precompute_glossy(
            scene.receivers, rays, scene.transfer,
            {.tolerance = 0.1f, .face_resolution = options.face_resolution, .bias = options.bias});
        set_surfaces(scene.transfer, scene.receivers);
    }
    scene.settings = {.tolerance = options.tolerance,
                      .min_level = options.min_level,
                      .face_resolution = options.face_resolution,
                      .bias = options.bias};
    if (shine == Shine::Glossy)
        scene.settings.glossy_tolerance = 0.1f;
    return scene;
}

class Determinism : public testing::TestWithParam<Shine> {
protected:
    ~Determinism() override { std::filesystem::remove(path_); }

    [[nodiscard]] std::vector<std::byte> file() const {
        save_scene(path_, precomputed(GetParam()));
        return files::read(path_);
    }
    /// Of what is in the file, with a byte for each count. How counts are coded may change, and how
    /// zstd packs.
    [[nodiscard]] std::string hash() const {
        save_scene(path_, precomputed(GetParam()));
        Sections sections = read_sections(path_);
        sections.erase("count_codes");
        sections.erase("counts_14");
        sections["counts"] = bytes_of(load_scene(path_).transfer.counts.counts);
        std::string all;
        for (const auto& [name, content] : sections) {
            all += fmt::format("{} {}\n", name, content.size());
            all.append(reinterpret_cast<const char*>(content.data()), content.size());
        }
        return fmt::format("{:016x}", XXH64(all.data(), all.size(), 0));
    }
    /// Sets from AVX2 on fuse products and sums, which shows in the last bits of highlights.
    [[nodiscard]] static bool is_fused(std::int64_t target) {
        return target <= HWY_AVX2; // better sets have lower numbers
    }
    [[nodiscard, maybe_unused]] static std::string expected_hash(std::int64_t target) {
        return GetParam() == Shine::Diffuse ? "820191f3b37ba1c0"
               : is_fused(target)           ? "bbaf977ed07bcf8a"
                                            : "cec0f78af5ee1462";
    }

private:
    std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) /
                                  fmt::format("relumine_determinism_{}.prt", ::getpid());
};

TEST_P(Determinism, TheSameBytesForAnyNumberOfThreadsAndASecondRun) {
    const std::vector<std::byte> first = file();
    for (const int num_threads : {1, 2, 8, 8}) {
        // More than the processor has, if need be.
        const files::ThreadLimit allowed(static_cast<std::size_t>(num_threads));
        tbb::task_arena arena(num_threads);
        EXPECT_TRUE(arena.execute([&] { return file(); }) == first) << num_threads;
    }
}

TEST_P(Determinism, TheSameContentOnEveryInstructionSet) {
#if !HWY_ARCH_X86
    GTEST_SKIP() << "the hashes are of x86 processors";
#endif
    std::map<bool, std::string> hashes;
    scenes::on_every_target([&](std::int64_t target) {
        // Embree's with the kernels'
        processor::set_embree(target < HWY_AVX2    ? nullptr
                              : target == HWY_AVX2 ? "isa=avx2"
                                                   : "isa=sse4.2");
        const std::string got = hash();
        EXPECT_EQ(hashes.try_emplace(is_fused(target), got).first->second, got);
        // Which products the compiler fuses depends on how far it optimises.
#ifdef NDEBUG
        EXPECT_EQ(got, expected_hash(target));
#endif
    });
    processor::set_embree(nullptr);
}

INSTANTIATE_TEST_SUITE_P(Shine, Determinism, testing::Values(Shine::Diffuse, Shine::Glossy),
                         [](const auto& each) {
                             return each.param == Shine::Diffuse ? "Diffuse" : "Glossy";
                         });

} // namespace
} // namespace relumine::prt
