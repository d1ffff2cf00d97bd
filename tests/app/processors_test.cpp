// One precompute on several instruction sets: the scene is the same, byte by byte.
// docs/robustness.md says which processors that is promised for.
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/app/command.h"

namespace relumine::app {
namespace {

/// Runs the program as on a processor with less, while it lives.
class Limit {
public:
    explicit Limit(const char* processor) {
        ::setenv("RELUMINE_PROCESSOR", processor, 1);
        ::setenv("LD_PRELOAD", RELUMINE_PROCESSOR_LIBRARY, 1);
    }
    ~Limit() {
        ::unsetenv("RELUMINE_PROCESSOR");
        ::unsetenv("LD_PRELOAD");
    }
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;
};

class ProcessorsTest : public AppTest {
protected:
    void SetUp() override {
        if (SanitizerFactor > 1)
            GTEST_SKIP() << "sanitizers must be loaded first";
        if (std::getenv("LD_PRELOAD") != nullptr)
            GTEST_SKIP() << "the processor is limited already";
#ifdef __x86_64__
        if (__builtin_cpu_supports("avx2") == 0)
#endif
            GTEST_SKIP() << "the processor has no AVX2";
        AppTest::SetUp();
        succeed("generate painted_room -o . --vertices 2000 -q");
        succeed("generate colonnade -o . --vertices 2000 -q");
    }

    /// Walls are parallel to axes, so many rays lie in planes of triangles and on their edges.
    void expect_the_same(const std::vector<std::string>& arguments) {
        std::vector<std::string> command = {"precompute"};
        command.insert(command.end(), arguments.begin(), arguments.end());
        command.insert(command.end(),
                       {"--tolerance", "0.06", "--refine", "off", "-q", "-o", "scene.prt"});
        succeed(command);
        const std::string best = read("scene.prt");
        const Limit limit("avx2");
        succeed(command);
        EXPECT_TRUE(read("scene.prt") == best);
    }
};

TEST_F(ProcessorsTest, BouncesOfVertices) {
    expect_the_same({"painted_room.ply", "--bounces", "0.05"});
}

TEST_F(ProcessorsTest, BouncesToPixels) {
    expect_the_same(
        {"painted_room.ply", "--receivers", "pixels:60x40", "--view", "auto", "--bounces", "0.05"});
}

TEST_F(ProcessorsTest, Highlights) {
    expect_the_same(
        {"colonnade.ply", "--view", "auto", "--material", "ggx:roughness=0.4", "--bounces", "0"});
}

TEST_F(ProcessorsTest, OfOtherKindsShareNoWork) {
    succeed("plan colonnade.ply -o scene.plan --tolerance 0.06 --refine off --bounces 0 -q");
    const std::vector<std::string> part = {"precompute", "scene.plan", "--part", "1/2",
                                           "-o",         "part",       "-q"};
    succeed(part);
    {
        const Limit limit("avx2");
        succeed(part);
    }
    const Limit limit("sse4");
    fail(part, {"scene.plan: expected the plan of a processor and an Embree that compute as here"});
}

TEST_F(ProcessorsTest, AnEmbreeThatLacksSomethingIsRefused) {
    for (const auto& [lack, sentence] :
         {std::pair{"packets",
                    "expected an Embree built with packets of rays (EMBREE_RAY_PACKETS)"},
          {"filters", "expected an Embree built with filter functions (EMBREE_FILTER_FUNCTION)"},
          {"backs", "expected an Embree built without culling of back faces"}}) {
        ::setenv("RELUMINE_EMBREE_LACKS", lack, 1);
        {
            const Limit limit("avx2");
            fail("precompute colonnade.ply -o scene.prt -q", {sentence, "got another"});
            EXPECT_EQ(succeed("--version").out.rfind("relumine ", 0), 0u);
        }
        ::unsetenv("RELUMINE_EMBREE_LACKS");
    }
}

} // namespace
} // namespace relumine::app
