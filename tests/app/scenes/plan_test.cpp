// `relumine plan`, `relumine precompute --part` and `relumine join`.
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
        succeed("generate knot -o . --vertices 4000 -q");
    }
    void plan(const std::string& name = "scene.plan", const std::string& tolerance = "0.05") {
        succeed({"plan", "knot.ply", "-o", name, "--tolerance", tolerance, "--floor", "20",
                 "--bounces", "0", "-q"});
    }
    [[nodiscard]] static std::vector<std::string> part(const std::string& which,
                                                       const std::string& output,
                                                       const std::string& plan = "scene.plan") {
        return {"precompute", plan, "--part", which, "-o", output, "-q"};
    }
};

TEST_F(PlanTest, AnyNumberOfPartsInAnyOrderMakesTheSameScene) {
    plan();
    succeed(part("1/1", "whole"));
    succeed("join whole -o one.prt -q");
    for (const char* which : {"3/4", "1/4", "4/4", "2/4"})
        succeed(part(which, std::string("part.") + which[0]));
    const nlohmann::json report =
        succeed("join part.4 part.1 part.3 part.2 -o four.prt --json").json();
    EXPECT_EQ(report["parts"], 4);
    EXPECT_EQ(read("one.prt"), read("four.prt"));
    std::vector<std::string> by_one_thread = part("2/2", "second");
    by_one_thread.insert(by_one_thread.end(), {"--threads", "1"});
    succeed(by_one_thread);
    succeed(part("1/2", "first"));
    succeed("join first second -o two.prt -q");
    EXPECT_EQ(read("one.prt"), read("two.prt"));
    succeed("info four.prt --check");
}

TEST_F(PlanTest, BouncesAreTheSameFromAnyNumberOfParts) {
    succeed(
        "plan knot.ply -o scene.plan --tolerance 0.06 --floor 20 --bounces 0.03 --two-sided -q");
    for (const int count : {1, 3}) {
        std::vector<std::string> join = {"join"};
        for (int i = 1; i <= count; ++i) {
            const std::string which = std::to_string(i) + "/" + std::to_string(count);
            join.push_back("part." + std::to_string(i));
            succeed(part(which, join.back()));
        }
        join.insert(join.end(), {"-o", std::to_string(count) + ".prt", "-q"});
        succeed(join);
    }
    EXPECT_EQ(read("1.prt"), read("3.prt"));
    succeed("info 3.prt --check");
    write("sky.hdr", lamp_hdr(40));
    succeed("relight 3.prt sky.hdr --bounces only -o bounced.npy -q");
    fail("relight 3.prt sky.hdr --part 1/2 -o part", {"3.prt: expected a scene without bounces"});
}

TEST_F(PlanTest, AJoinedSceneIsAsExactAsAPlainOne) {
    plan("scene.plan", "0.02");
    for (const char* which : {"1/2", "2/2"})
        succeed(part(which, std::string("part.") + which[0]));
    succeed("join part.1 part.2 -o joined.prt -q");
    succeed("precompute knot.ply -o plain.prt --tolerance 0.02 --floor 20 --bounces 0 -q");
    write("sky.hdr", lamp_hdr(40));
    const auto error = [&](const std::string& scene) {
        return succeed({"verify", scene, "sky.hdr", "--samples", "0", "--clusters-only", "--json"})
            .json()["relative_l2"]
            .get<double>();
    };
    EXPECT_LT(error("joined.prt"), 1.1 * error("plain.prt"));
}

TEST_F(PlanTest, PartsKnowTheRefinedAndTheSimplifiedMesh) {
    const std::vector<std::string> work = {
        "knot.ply",   "--floor", "2",           "--simplify", "3000",      "--refine", "0",
        "--vertices", "3500",    "--tolerance", "0.05",       "--bounces", "0"};
    const auto with = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin() + 1, work.begin(), work.end());
        return arguments;
    };
    succeed(with({"plan", "-o", "scene.plan", "-q"}));
    for (const char* which : {"1/2", "2/2"})
        succeed(part(which, std::string("part.") + which[0]));
    succeed("join part.1 part.2 -o joined.prt -q");
    succeed(with({"precompute", "-o", "plain.prt", "-q"}));
    const auto info = [&](const std::string& scene) {
        nlohmann::json facts = succeed({"info", scene, "--check", "--json"}).json();
        return std::vector{facts["vertices"], facts["triangles"], facts["receivers"],
                           facts["floor"]};
    };
    EXPECT_EQ(info("joined.prt"), info("plain.prt"));
    EXPECT_GT(info("joined.prt")[0], 3400);
    write("sky.hdr", lamp_hdr(40));
    const auto error = [&](const std::string& scene) {
        return succeed({"verify", scene, "sky.hdr", "--samples", "200", "--json"})
            .json()["relative_l2"]
            .get<double>();
    };
    // All triangles of the knot throw the shadows, in both.
    EXPECT_LT(error("joined.prt"), 1.2 * error("plain.prt"));
    EXPECT_LT(error("plain.prt"), 0.1);
}

TEST_F(PlanTest, LightOfPartsIsTheLightOfTheScene) {
    succeed("precompute knot.ply -o scene.prt --tolerance 0.06 --floor 40 --bounces 0 -q");
    write("sky.hdr", lamp_hdr(40));
    succeed("generate sun_sky -o . --face-resolution 32 -q");
    for (const std::string sky : {"sky.hdr", "sun_sky.exr"}) {
        succeed({"relight", "scene.prt", sky, "-o", "whole.npy", "--rotate", "20", "--bounces", "0",
                 "-q"});
        for (const int count : {1, 3, 8}) {
            std::vector<std::string> join = {"join", "-o", "joined.npy", "-q"};
            for (int i = count; i >= 1; --i) {
                join.push_back("lit." + std::to_string(i));
                succeed({"relight", "scene.prt", sky, "--part",
                         std::to_string(i) + "/" + std::to_string(count), "-o", join.back(),
                         "--rotate", "20", "--bounces", "0", "-q"});
            }
            succeed(join);
            EXPECT_EQ(read("whole.npy"), read("joined.npy")) << sky << " in " << count;
        }
    }
    succeed("relight scene.prt sky.hdr --part 1/2 -o first --bounces 0 -q");
    succeed("relight scene.prt sun_sky.exr --part 2/2 -o other --bounces 0 -q");
    const auto join = [](std::vector<std::string> parts) {
        parts.insert(parts.begin(), "join");
        parts.insert(parts.end(), {"-o", "out.npy"});
        return parts;
    };
    fail(join({"first"}), {"got none that is part 2 of 2"});
    fail(join({"first", "other"}), {"other: expected a part of the same light as first"});
    fail(join({"first", "first"}), {"first: expected every part once"});
    fail(join({"scene.prt"}), {"scene.prt: expected a part that `relumine relight --part` wrote"});
    fail("join first -o out.prt", {"first: expected"});
    fail("relight first sky.hdr -o out.npy", {"first: expected a scene, got a part"});
    fail("relight first sky.hdr --part 1/2 -o out",
         {"first: expected a scene, got a plan or a part"});
    misuse("relight scene.prt sky.hdr --part 3/2 -o out", "--part");
    misuse("relight scene.prt sky.hdr --part 1/2 -o out --exposure 1", "--exposure");
    misuse("relight scene.prt --part 1/2 -o out", "ENV");
}

TEST_F(PlanTest, WrongUsageIsNamed) {
    plan();
    misuse("precompute scene.plan -o part", "--part");
    misuse("precompute --part 1/2 -o part", "MESH");
    misuse("precompute -o scene.prt", "MESH");
    for (const char* which : {"0/4", "5/4", "1", "a/b", "1/", "/2", "1/70000", "1/2/3"})
        misuse(part(which, "part"), "--part");
    std::vector<std::string> twice = part("1/2", "part");
    twice.insert(twice.end(), {"--tolerance", "0.1"});
    misuse(twice, "--tolerance");
    misuse("precompute knot.ply scene.plan --part 1/2 -o part", "expected no argument more");
    misuse("plan knot.ply -o scene.prt", "--output");
    misuse("plan knot.ply -o scene.plan --bounces 7", "--bounces");
    misuse("plan knot.ply -o scene.plan --two-sided", "--two-sided");
}

TEST_F(PlanTest, InfoSaysWhatAPlanAndItsPartsAre) {
    plan();
    succeed(part("1/2", "first"));
    succeed(part("2/2", "second.part"));
    const nlohmann::json planned = succeed("info scene.plan --json").json();
    EXPECT_EQ(planned["kind"], "plan");
    EXPECT_EQ(planned["source"], "knot.ply");
    std::size_t num_receivers = 0;
    for (const char* name : {"first", "second.part"}) {
        const nlohmann::json info = succeed({"info", name, "--json"}).json();
        EXPECT_EQ(info["kind"], "part");
        EXPECT_EQ(info["parts"], 2);
        EXPECT_EQ(info["plan"], planned["plan"]);
        num_receivers += info["receivers"].get<std::size_t>();
    }
    EXPECT_EQ(num_receivers, planned["receivers"].get<std::size_t>());
    const auto said = [&](const std::string& name, const std::string& text) {
        const std::string out = succeed({"info", name, "--check"}).out;
        EXPECT_NE(out.find(text), std::string::npos) << out;
    };
    said("scene.plan", "plan                of a precompute of knot.ply, complete; its name is " +
                           planned["plan"].get<std::string>());
    said("scene.plan", "parts               as many as you like");
    said("first", "part                1 of 2 of a planned precompute");
    said("first", ", which this part carries");
    said("second.part", "part                2 of 2 of a planned precompute");
    misuse("info scene.plan --picture a.png", "--picture");
    succeed("join first second.part -o scene.prt -q");
    succeed("generate sun_sky -o . --face-resolution 16 -q");
    succeed("relight scene.prt sun_sky.exr --part 1/3 --bounces 0 -o sky.part.1 -q");
    EXPECT_EQ(succeed("info sky.part.1 --json").json()["kind"], "part of light");
    said("sky.part.1", "part                1 of 3 of a scene's light");
    // Cut short, as by a full disk elsewhere.
    write("second.part", read("second.part").substr(0, 1000));
    fail("info second.part", {"second.part: expected", "truncated"});
}

TEST_F(PlanTest, HighlightsJoinToTheSameFileFromAnyNumberOfParts) {
    const std::vector<std::string> shine = {
        "--view",      "auto", "--material",         "ggx:roughness=0.4,f0=0.04",
        "--tolerance", "0.06", "--glossy-tolerance", "0.3",
        "--bounces",   "0"};
    std::vector<std::string> plan = {"plan", "knot.ply", "-o", "scene.plan"};
    plan.insert(plan.end(), shine.begin(), shine.end());
    succeed(plan);
    succeed(part("1/1", "one"));
    succeed("join one -o one.prt");
    for (const char* i : {"1", "2", "3"})
        succeed(part(std::string(i) + "/3", std::string("three.") + i));
    succeed("join three.3 three.1 three.2 -o three.prt");
    EXPECT_EQ(read("one.prt"), read("three.prt"));
    EXPECT_NE(read("one.prt").find("g_specular_b"), std::string::npos);
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
    const auto check = [](std::vector<std::string> parts) {
        parts.insert(parts.begin(), {"join", "--check"});
        return parts;
    };
    EXPECT_NE(succeed(check({"second", "first"})).out.find("all 2 parts"), std::string::npos);
    fail(check({"third"}), {"expected all 3 parts, got none that is part 2-3"});
    // What was found is on stdout, in a line each.
    const Result foreign = relumine(check({"second", "foreign"})),
                 none = relumine(check({"scene.plan"}));
    EXPECT_EQ(foreign.exit_code, 1);
    EXPECT_EQ(foreign.out.find("foreign: expected a part of the same plan as second"), 0u);
    EXPECT_EQ(foreign.err, "relumine: expected all 2 parts, got none that is part 1\n");
    EXPECT_EQ(none.exit_code, 1);
    EXPECT_EQ(none.err, "relumine: expected parts that can be joined, got 1 that cannot\n");
    misuse("join first second", "--output");
    std::string bytes = read("second");
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    write("second", bytes);
    fail(join({"first", "second"}), {"second: expected"});
    const nlohmann::json checked = relumine(check({"first", "second", "first", "--json"})).json();
    EXPECT_EQ(checked["missing"], (std::vector<int>{2}));
    EXPECT_EQ(checked["faults"].size(), 2u);
    fail(part("1/2", "part", "first"), {"first: expected a plan, got a part"});
    std::filesystem::copy(folder() / "first", folder() / "first.prt");
    fail("info first.prt", {"first.prt: expected a scene, got a part"});
}

} // namespace
} // namespace relumine::app
