// What all subcommands have in common: help, exit codes, --json, -q.
#include "tests/app/command.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class CommandLineTest : public AppTest {
protected:
    CommandLineTest() {
        write("mesh.obj", octahedron_obj());
        write("env.hdr", white_hdr());
    }
    void precompute() const {
        succeed({"precompute", "mesh.obj", "-o", "scene.prt", "--face-resolution", "16"});
    }

    /// One command line per subcommand that does its work.
    const std::vector<std::vector<std::string>> all_ = {
        {"precompute", "mesh.obj", "-o", "new.prt", "--face-resolution", "16"},
        {"relight", "scene.prt", "env.hdr", "-o", "new.npy"},
        {"edit", "scene.prt", "env.hdr", "-o", "new.npy", "--disc", "0,1,0"},
        {"verify", "scene.prt", "env.hdr"},
        {"info", "scene.prt"},
        {"info", "mesh.obj"},
        {"info", "env.hdr"},
        {"generate", "blob", "-o", "new", "--vertices", "1000"},
        {"generate", "constant", "-o", "new", "--face-resolution", "16"}};
};

std::vector<std::string> with(std::vector<std::string> arguments,
                              const std::vector<std::string>& more) {
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
}

TEST_F(CommandLineTest, HelpOfEverythingIsPrintedAndSucceeds) {
    EXPECT_NE(succeed({"--help"}).out.find("precompute"), std::string::npos);
    EXPECT_EQ(succeed({"--version"}).out.rfind("relumine ", 0), 0u);
    for (const char* name : {"precompute", "relight", "edit", "verify", "info", "generate"}) {
        const Result help = succeed({name, "--help"});
        EXPECT_NE(help.out.find("Usage: relumine " + std::string(name)), std::string::npos)
            << help.described();
        EXPECT_NE(help.out.find("--json"), std::string::npos) << help.described();
        EXPECT_EQ(help.err, "");
        EXPECT_EQ(succeed({name, "-h"}).out, help.out);
    }
}

TEST_F(CommandLineTest, WrongUsageExitsWithTwoAndOneLine) {
    misuse({});
    misuse({"--nonsense"}, "--nonsense");
    misuse({"illuminate"}, "illuminate");
    for (const char* name : {"precompute", "relight", "edit", "verify", "info", "generate"}) {
        misuse({name}, "required");
        misuse({name, "--nonsense"});
        misuse({name, "a", "b", "c", "d"});
    }
    misuse({"precompute", "mesh.obj"}, "--output");
    misuse({"relight", "scene.prt", "env.hdr"}, "--output");
    misuse({"relight", "scene.prt", "-o", "new.npy"}, "ENV");
    misuse({"edit", "scene.prt", "env.hdr", "-o", "new.npy"}, "--disc");
    misuse({"generate", "teapot", "-o", "new"}, "teapot");
    misuse({"generate", "blob"}, "--output");
    misuse({"info", "mesh.obj", "--threads", "-1"}, "--threads");
    misuse({"info", "mesh.obj", "--threads", "two"}, "--threads");
    misuse({"info", "mesh.obj", "--threads"}, "--threads");
}

TEST_F(CommandLineTest, EmptyValuesAreWrongUsage) {
    // What a script passes when a variable is not set. An empty tolerance must not mean 0.
    misuse({"precompute", "", "-o", "new.prt"}, "MESH");
    misuse({"precompute", "mesh.obj", "-o", ""}, "--output");
    for (const char* option :
         {"--tolerance", "--epsilon", "--bias", "--min-depth", "--face-resolution", "--threads"})
        misuse({"precompute", "mesh.obj", "-o", "new.prt", option, ""}, option);
    misuse({"relight", "", "env.hdr", "-o", "new.npy"}, "SCENE");
    misuse({"relight", "scene.prt", "", "-o", "new.npy"}, "ENV");
    for (const char* option :
         {"--rotate", "--exposure", "--albedo", "--eye", "--target", "--fov", "--size", "--layout"})
        misuse({"relight", "scene.prt", "env.hdr", "-o", "new.npy", option, ""}, option);
    misuse({"verify", "scene.prt", "env.hdr", "--samples", ""}, "--samples");
    misuse({"info", ""}, "FILE");
    misuse({"generate", "blob", "-o", ""}, "--output");
}

TEST_F(CommandLineTest, JsonIsOneObjectOnStdoutAndNothingElse) {
    precompute();
    for (const std::vector<std::string>& arguments : all_) {
        const Result result = succeed(with(arguments, {"--json"}));
        EXPECT_FALSE(result.json().empty()) << arguments[0];
        EXPECT_EQ(result.err, "") << arguments[0];
    }
}

TEST_F(CommandLineTest, JsonStaysJsonWithQuietAndVerbose) {
    precompute();
    for (const std::vector<std::string>& arguments : all_) {
        EXPECT_FALSE(succeed(with(arguments, {"--json", "-q"})).json().empty()) << arguments[0];
        EXPECT_FALSE(succeed(with(arguments, {"--json", "-v"})).json().empty()) << arguments[0];
    }
}

TEST_F(CommandLineTest, QuietPrintsNothingOnSuccess) {
    precompute();
    for (const std::vector<std::string>& arguments : all_)
        for (const char* quiet : {"-q", "--quiet"}) {
            const Result result = succeed(with(arguments, {quiet}));
            EXPECT_EQ(result.out, "") << arguments[0];
            EXPECT_EQ(result.err, "") << arguments[0];
        }
}

TEST_F(CommandLineTest, VerboseSaysWhatWasAssumedOfTheEnvironment) {
    precompute();
    const Result result = succeed({"relight", "scene.prt", "env.hdr", "-o", "new.npy", "-v"});
    EXPECT_NE(result.out.find("2:1"), std::string::npos) << result.described();
}

TEST_F(CommandLineTest, MistakesAreStillReportedWithQuietAndJson) {
    for (const char* option : {"-q", "--json"}) {
        fail({"info", "missing.prt", option}, {"missing.prt"});
        misuse({"info", option});
    }
}

TEST_F(CommandLineTest, OutputThatCannotBePrintedIsAFailure) {
    if (!fs::exists("/dev/full"))
        GTEST_SKIP() << "this system has no /dev/full";
    precompute();
    for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--json"}})
        fail(with({"info", "scene.prt"}, more), {"standard output"}, {.stdout_path = "/dev/full"});
}

TEST_F(CommandLineTest, OddFileNamesWork) {
    precompute();
    for (const std::string name :
         {"with space", "quote'\"s", "umlaut \xc3\xa4\xc3\xb6", "\xe7\x85\xa7\xe6\x98\x8e",
          "per%cent {0}", "a.b.c", "back\\slash", "star*", "bad utf8 \xff\xfe"}) {
        write(name + ".obj", octahedron_obj());
        write(name + ".hdr", white_hdr());
        const Result made = succeed({"precompute", name + ".obj", "-o", name + ".prt",
                                     "--face-resolution", "16", "--json"});
        EXPECT_EQ(made.json().value("vertices", 0), 6) << name;
        succeed({"relight", name + ".prt", name + ".hdr", "-o", name + ".npy"});
        EXPECT_TRUE(fs::exists(folder() / (name + ".npy"))) << name;
        EXPECT_EQ(succeed({"info", name + ".prt", "--json"}).json().value("vertices", 0), 6)
            << name;
        fail({"info", name + " missing.prt"}, {name + " missing.prt"});
    }
}

TEST_F(CommandLineTest, NamesThatLookLikeOptionsWorkAfterTwoDashes) {
    write("-m.obj", octahedron_obj());
    write("-e.hdr", white_hdr());
    succeed({"precompute", "-o", "./-s.prt", "--face-resolution", "16", "--", "-m.obj"});
    succeed({"info", "--", "-s.prt"});
    succeed({"relight", "-o", "./-o.npy", "--", "-s.prt", "-e.hdr"});
    EXPECT_TRUE(fs::exists(folder() / "-o.npy"));
}

TEST_F(CommandLineTest, LinesOfAFileNameWithALineBreakStayOneLine) {
    fail({"info", "two\nlines.prt"}, {"two lines.prt"});
    fail({"info", "carriage\rreturn.prt"});
    misuse({"generate", "two\nlines", "-o", "new"});
}

TEST_F(CommandLineTest, ManyThreadsAreNoMistake) {
    precompute();
    succeed({"relight", "scene.prt", "env.hdr", "-o", "new.npy", "--threads", "64"});
}

} // namespace
} // namespace relumine::app
