// `relumine plan`, `relumine precompute --plan` and `relumine join`.
#include <filesystem>
#include <string>
#include <vector>

#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

class PlanTest : public AppTest {
protected:
    void SetUp() override {
        AppTest::SetUp();
        succeed({"generate", "knot", "-o", ".", "--vertices", "4000", "-q"});
    }
    void plan(const std::string& name = "scene.plan", const std::string& tolerance = "0.05") {
        succeed({"plan", "knot.ply", "-o", name, "--tolerance", tolerance, "--floor", "20", "-q"});
    }
    [[nodiscard]] static std::vector<std::string> part(const std::string& which,
                                                       const std::string& output,
                                                       const std::string& plan = "scene.plan") {
        return {"precompute", "--plan", plan, "--part", which, "-o", output, "-q"};
    }
};

TEST_F(PlanTest, AnyNumberOfPartsInAnyOrderMakesTheSameScene) {
    plan();
    succeed(part("1/1", "whole"));
    succeed({"join", "whole", "-o", "one.prt", "-q"});
    for (const char* which : {"3/4", "1/4", "4/4", "2/4"})
        succeed(part(which, std::string("part.") + which[0]));
    const nlohmann::json report =
        succeed({"join", "part.4", "part.1", "part.3", "part.2", "-o", "four.prt", "--json"})
            .json();
    EXPECT_EQ(report["parts"], 4);
    EXPECT_EQ(read("one.prt"), read("four.prt"));
    std::vector<std::string> other_engine = part("2/2", "second");
    other_engine.insert(other_engine.end(), {"--engine", "embree", "--threads", "1"});
    succeed(other_engine);
    succeed(part("1/2", "first"));
    succeed({"join", "first", "second", "-o", "two.prt", "-q"});
    EXPECT_EQ(read("one.prt"), read("two.prt"));
    succeed({"info", "four.prt", "--check"});
}

TEST_F(PlanTest, AJoinedSceneIsAsExactAsAPlainOne) {
    plan("scene.plan", "0.02");
    for (const char* which : {"1/2", "2/2"})
        succeed(part(which, std::string("part.") + which[0]));
    succeed({"join", "part.1", "part.2", "-o", "joined.prt", "-q"});
    succeed({"precompute", "knot.ply", "-o", "plain.prt", "--tolerance", "0.02", "--floor", "20",
             "-q"});
    write("sky.hdr", lamp_hdr(40));
    const auto error = [&](const std::string& scene) {
        return succeed({"verify", scene, "sky.hdr", "--samples", "0", "--clusters-only", "--json"})
            .json()["relative_l2"]
            .get<double>();
    };
    EXPECT_LT(error("joined.prt"), 1.1 * error("plain.prt"));
}

TEST_F(PlanTest, WrongUsageIsNamed) {
    plan();
    misuse({"precompute", "--plan", "scene.plan", "-o", "part"}, "--part");
    misuse({"precompute", "--part", "1/2", "-o", "part"}, "--plan");
    misuse({"precompute", "-o", "scene.prt"}, "MESH");
    for (const char* which : {"0/4", "5/4", "1", "a/b", "1/", "/2", "1/70000", "1/2/3"})
        misuse(part(which, "part"), "--part");
    std::vector<std::string> twice = part("1/2", "part");
    twice.insert(twice.end(), {"--tolerance", "0.1"});
    misuse(twice, "--tolerance");
    misuse({"precompute", "knot.ply", "--plan", "scene.plan", "--part", "1/2", "-o", "part"},
           "MESH");
    misuse({"plan", "knot.ply", "-o", "scene.prt"}, "--output");
    misuse({"plan", "knot.ply", "-o", "scene.plan", "--bounces"}, "--bounces");
    fail({"plan", "knot.ply", "-o", "glossy.plan", "--view", "auto", "--material",
          "ggx:roughness=0.3,f0=0.04"},
         {"knot.ply: expected a plan without highlights"});
}

TEST_F(PlanTest, APartThatIsMissingDoubledForeignOrDamagedIsNamed) {
    plan();
    plan("other.plan", "0.06");
    succeed(part("1/2", "first"));
    succeed(part("2/2", "second"));
    succeed(part("2/2", "foreign", "other.plan"));
    succeed(part("1/3", "third"));
    const auto join = [](std::vector<std::string> parts) {
        parts.insert(parts.begin(), "join");
        parts.insert(parts.end(), {"-o", "scene.prt"});
        return parts;
    };
    fail(join({"first"}), {"expected all 2 parts, got none that is part 2 of 2"});
    fail(join({"first", "first", "second"}), {"first: expected every part once"});
    fail(join({"first", "foreign"}), {"foreign: expected a part of the same plan as first"});
    fail(join({"first", "third"}), {"third: expected one of 2 parts"});
    fail(join({"first", "scene.plan"}), {"scene.plan: expected a part, got a plan"});
    fail(join({"first", "none"}), {"none"});
    std::string bytes = read("second");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write("second", bytes);
    fail(join({"first", "second"}), {"second: expected"});
    fail(part("1/2", "part", "first"), {"first: expected a plan, got a part"});
    std::filesystem::copy(folder() / "first", folder() / "first.prt");
    fail({"info", "first.prt"}, {"first.prt: expected a scene, got a part"});
}

} // namespace
} // namespace relumine::app
