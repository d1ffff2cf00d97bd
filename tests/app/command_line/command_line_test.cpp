// What all subcommands have in common: help, exit codes, --json, -q.

#include <regex>
#include <string>

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
        succeed("precompute mesh.obj -o scene.prt --face-resolution 16 --refine off");
    }

    /// One command line per subcommand that does its work.
    const std::vector<std::vector<std::string>> all_ = {
        {"precompute", "mesh.obj", "-o", "new.prt", "--face-resolution", "16", "--refine", "off"},
        {"relight", "scene.prt", "env.hdr", "-o", "new.npy"},
        {"edit", "scene.prt", "env.hdr", "-o", "new.npy", "--disc", "0,1,0,10"},
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
    EXPECT_NE(succeed("--help").out.find("precompute"), std::string::npos);
    EXPECT_EQ(succeed("--version").out.rfind("relumine ", 0), 0u);
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
    misuse("--nonsense", "--nonsense");
    misuse("illuminate", "illuminate");
    for (const char* name : {"precompute", "relight", "edit", "verify", "info", "generate"}) {
        misuse({name}, "required");
        misuse({name, "--nonsense"});
        misuse({name, "a", "b", "c", "d"});
    }
    misuse("precompute mesh.obj", "--output");
    misuse("relight scene.prt env.hdr", "--output");
    misuse("edit scene.prt env.hdr -o new.npy", "--disc");
    misuse("generate teapot -o new", "teapot");
    misuse("generate blob", "--output");
    misuse("info mesh.obj --threads -1", "--threads");
    misuse("info mesh.obj --threads two", "--threads");
    misuse("info mesh.obj --threads", "--threads");
}

TEST_F(CommandLineTest, EmptyValuesAreWrongUsage) {
    // What a script passes when a variable is not set. An empty tolerance must not mean 0.
    misuse({"precompute", "", "-o", "new.prt"}, "MESH");
    misuse({"precompute", "mesh.obj", "-o", ""}, "--output");
    for (const char* option : {"--tolerance", "--face-resolution", "--threads"})
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

/// A command that a busy machine holds up for seconds shows its progress.
std::string without_progress(const std::string& err) {
    return std::regex_replace(err, std::regex("[^\n]*, about [^\n]* left\n"), "");
}

TEST_F(CommandLineTest, JsonIsOneObjectOnStdoutAndNothingElse) {
    precompute();
    for (const std::vector<std::string>& arguments : all_) {
        const Result result = succeed(with(arguments, {"--json"}));
        EXPECT_FALSE(result.json().empty()) << arguments[0];
        EXPECT_EQ(without_progress(result.err), "") << arguments[0];
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
    const Result result = succeed("relight scene.prt env.hdr -o new.npy -v");
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

TEST_F(CommandLineTest, APipeThatNobodyReadsIsNoFailure) {
    precompute();
    for (const Words& words :
         {Words("info scene.prt"), Words("info scene.prt --json"), Words("--help"),
          Words("completion"), Words("relight scene.prt env.hdr -o unread.npy")}) {
        const Result result = relumine(words, {.is_unread = true});
        EXPECT_EQ(result.exit_code, 0) << result.described();
        EXPECT_EQ(result.err, "") << words.back();
    }
    EXPECT_TRUE(fs::exists(folder() / "unread.npy"));
}

TEST_F(CommandLineTest, OddFileNamesWork) {
    precompute();
    for (const std::string name :
         {"with space", "quote'\"s", "umlaut \xc3\xa4\xc3\xb6", "\xe7\x85\xa7\xe6\x98\x8e",
          "per%cent {0}", "a.b.c", "back\\slash", "star*", "bad utf8 \xff\xfe"}) {
        write(name + ".obj", octahedron_obj());
        write(name + ".hdr", white_hdr());
        const Result made = succeed({"precompute", name + ".obj", "-o", name + ".prt",
                                     "--face-resolution", "16", "--refine", "off", "--json"});
        EXPECT_EQ(made.json().value("vertices", 0), 6) << name;
        succeed({"relight", name + ".prt", name + ".hdr", "-o", name + ".npy"});
        EXPECT_TRUE(fs::exists(folder() / (name + ".npy"))) << name;
        EXPECT_EQ(succeed({"info", name + ".prt", "--json"}).json().value("vertices", 0), 6)
            << name;
        fail({"info", name + " missing.prt"}, {name + " missing.prt"});
    }
}

TEST_F(CommandLineTest, ABadNameIsKeptByEveryCommand) {
    // Bytes that are no UTF-8. In JSON they are replaced, since JSON cannot hold them.
    precompute();
    const std::string name = "bad\xff\xfe";
    fs::copy_file(folder() / "scene.prt", folder() / (name + ".prt"));
    write(name + ".hdr", lamp_hdr(64));
    write(name + ".obj", "o " + name + "\n" + octahedron_obj());
    write(name + ".json", R"({"version": 1, "layers": []})");
    const std::string scene = name + ".prt", environment = name + ".hdr";
    const std::vector<std::vector<std::string>> all = {
        {"relight", scene, environment, "-o", name + ".png", "--size", "8x8"},
        {"relight", scene, environment, "-o", name + ".glb"},
        {"edit", scene, environment, name + ".json", "-o", name + ".exr", "--size", "8x8"},
        {"animate", scene, name + ".h*", "-o", name + ".%d.npy"},
        {"verify", scene, environment},
        {"lights", environment, "-n", "4", "-o", name + ".l.json"},
        {"lights", environment, "-n", "4", "-o", name + ".gltf"},
        {"lights", environment, "-n", "4", "-o", name + ".usda"},
        {"lights", environment, "-n", "4", "-o", name + ".py"},
        {"relight", scene, "--lights", name + ".l.json", "-o", name + ".npy"},
        {"env", "convert", environment, "-o", name + ".c.exr"},
        {"env", "convert", environment, "-o", name + ".s.exr", "--split-sun"},
        {"info", scene},
        {"info", environment},
        {"info", name + ".obj"},
        {"generate", "constant", "-o", name + ".dir", "--face-resolution", "8"},
        {"precompute", name + ".obj", "-o", name + ".2.prt", "--face-resolution", "16"}};
    for (const std::vector<std::string>& arguments : all)
        EXPECT_FALSE(succeed(with(arguments, {"--json"})).json().empty()) << arguments[0];
    for (const char* extension : {".png", ".glb", ".exr", ".npy", ".l.json", ".s.sun.json"})
        EXPECT_TRUE(fs::exists(folder() / (name + extension))) << extension;
}

TEST_F(CommandLineTest, NamesMayBeAsLongAsTheSystemAllows) {
    precompute();
    const std::string name(245, 'n');
    for (const char* extension : {".npy", ".exr", ".png", ".ply"})
        succeed({"relight", "scene.prt", "env.hdr", "-o", name + extension, "--size", "8x8"});
    succeed({"precompute", "mesh.obj", "-o", name + ".prt", "--face-resolution", "16", "--refine",
             "off"});
    succeed({"info", name + ".prt", "--check"});
    fail({"relight", "scene.prt", "env.hdr", "-o", std::string(252, 'n') + ".npy"},
         {"cannot write"});
}

TEST_F(CommandLineTest, AMisspeltNameIsToldTheNearest) {
    misuse("relihgt a b", "expected a command, got 'relihgt'; did you mean relight? (see "
                          "relumine --help)");
    misuse("env conver", "did you mean convert? (see relumine env --help)");
    // Before what else may be wrong: -o is missing, too.
    misuse("relight a.prt b.exr --exposrue 1",
           "--exposrue: no option of `relumine relight`; did you mean --exposure? (see relumine "
           "relight --help)");
    misuse("relight a.prt b.exr --exposrue=1 -o x.png", "relumine: --exposrue: ");
    misuse("precompute a.obj -o b.prt --highlights store",
           "--highlights: expected stored or traced, got 'store'; did you mean stored?");
    // What older versions had.
    for (const char* old : {"precompute a.obj -o b.prt --no-refine", "verify a.prt b.exr --seed 2",
                            "relight a.prt b.exr -o c.png --transparent"})
        misuse(old, ": no option of `relumine ");
    misuse("lights env.hdr --zzz", "--zzz: no option of `relumine lights` (see");
    misuse("generate knto -o x", "did you mean knot?");
    precompute();
    write("layers.json", R"({"version": 1, "layers": [{"name": "key light", "type": "disc",
        "effect": "gain", "direction": [0, 1, 0], "radius_degrees": 30},
        {"name": "fill", "type": "disc", "effect": "gain", "direction": [0, 1, 0],
        "radius_degrees": 30}]})");
    misuse({"edit", "scene.prt", "env.hdr", "layers.json", "-o", "x.npy", "--lit-by", "key ligt"},
           "--lit-by: expected a layer (key light, fill) or X,Y,Z,RADIUS with a RADIUS in degrees, "
           "got 'key ligt'; did you mean key light?");
    write("wrong.json", R"({"version": 1, "layers": [{"name": "key", "type": "disc",
        "effect": "gain", "direction": [0, 1, 0], "radius_degree": 30}]})");
    fail("edit scene.prt env.hdr wrong.json -o x.npy",
         {"wrong.json:2: expected \"radius_degrees\", got \"radius_degree\""});
    write("wrong.json", R"({"version": 1, "layers": [{"name": "key", "type": "disc",
        "effect": "gain", "direction": [0, 1, 0], "radius_degrees": 30, "fctor": 2}]})");
    fail("edit scene.prt env.hdr wrong.json -o x.npy", {"got \"fctor\"; did you mean factor?"});
}

TEST_F(CommandLineTest, APatternWithoutQuotesIsToldSo) {
    precompute();
    for (const char* name : {"f.1.hdr", "f.2.hdr", "f.3.hdr"})
        write(name, white_hdr());
    misuse("animate scene.prt f.1.hdr f.2.hdr f.3.hdr -o x.%d.npy",
           "FRAMES: expected one name, got 3 files; put a pattern in quotes: 'f.*.hdr' (see "
           "relumine animate --help)");
    misuse("relight scene.prt f.1.hdr f.2.hdr -o x.npy",
           "ENV: expected one name, got 2 files; put a pattern in quotes: 'f.*.hdr'");
    misuse("relight scene.prt f.1.hdr stray -o x.npy",
           "ENV: expected no argument more, got 'stray'");
    // A name with blanks, without quotes; words of other programs; the wrong way round; a picture.
    write("my white sky.hdr", white_hdr());
    misuse("relight scene.prt my white sky.hdr -o x.npy",
           "put a name with blanks in quotes: 'my white sky.hdr'");
    misuse("relight scene.prt f.1.hdr --rotation 9 -o x.npy", "did you mean --rotate?");
    misuse("relight scene.prt f.1.hdr --layout equirectangular -o x.npy", "did you mean latlong?");
    misuse("relight f.1.hdr scene.prt -o x.npy",
           "SCENE: expected a scene, got the environment f.1.hdr: the scene stands first");
    write("sky.jpg", "\xff\xd8\xff\xe0 and more");
    fail("info sky.jpg", {"sky.jpg: expected"});
    write("jpeg.hdr", "\xff\xd8\xff\xe0 and more");
    fail("relight scene.prt jpeg.hdr -o x.npy", {"holds no light above white"});
    fail("relight scene.prt scene.prt -o x.npy", {"the scene stands first"});
}

TEST_F(CommandLineTest, HelpIsACommandToo) {
    EXPECT_EQ(succeed("help").out, succeed("--help").out);
    EXPECT_EQ(succeed("help relight").out, succeed("relight --help").out);
    EXPECT_EQ(succeed("help env convert").out, succeed("env convert --help").out);
    misuse("help relihgt", "did you mean relight?");
}

TEST_F(CommandLineTest, ANameThatIsNotThereSaysSoFirst) {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"info", "none.xyz"},
          {"info", "none"},
          {"info", "none", "--check"},
          {"info", "none", "--picture", "a.png"},
          {"precompute", "none", "-o", "a.prt"},
          {"relight", "none", "env.hdr", "-o", "a.png"},
          {"lights", "none", "-o", "a.json"},
          {"env", "convert", "none", "-o", "a.exr"},
          {"animate", "none", "env.hdr", "-o", "a%d.png"}})
        fail(arguments, {"relumine: none", ": cannot read: No such file or directory"});
}

TEST_F(CommandLineTest, NumbersThatOverflowAreRefused) {
    precompute();
    for (const char* output : {"new.npy", "new.exr"})
        misuse(
            {"relight", "scene.prt", "env.hdr", "-o", output, "--size", "8x8", "--albedo", "3e38"},
            "--albedo: expected numbers of 0 to 1000000, got '3e38'");
    write("bright.hdr",
          hdr_file(64, 32, [](auto, auto) { return Rgb{0x1p90f, 0x1p90f, 0x1p90f}; }));
    for (const char* output : {"new.npy", "new.exr", "new.ply"})
        fail({"relight", "scene.prt", "bright.hdr", "-o", output, "--size", "8x8", "--exposure",
              "100"},
             {output, ": expected radiance times albedo and exposure within"});
    for (const char* option : {"--eye", "--target"})
        misuse({"relight", "scene.prt", "env.hdr", "-o", "new.png", option, "1e19,0,0"}, option);
    misuse("relight scene.prt env.hdr -o new.png --fov 1e30", "--fov");
    misuse("relight scene.prt env.hdr -o new.png --size 4294967297x1",
           "--size: expected WIDTHxHEIGHT, got '4294967297x1'");
    misuse("relight scene.prt env.hdr -o new.png --size 0x1", "--size");
}

TEST_F(CommandLineTest, JsonCarriesWarningsAndReplacedPixels) {
    precompute();
    write("nan.exr", exr_file(64, 32, [](std::uint32_t x, std::uint32_t y) {
              return Rgb{x + y == 0 ? std::nanf("") : 1.0f, 1.0f, 1.0f};
          }));
    const Result result = succeed("relight scene.prt nan.exr --fix-env -o new.npy --json");
    EXPECT_EQ(result.json()["replaced_pixels"], 1);
    for (const std::vector<std::string>& arguments : all_)
        EXPECT_TRUE(succeed(with(arguments, {"--json"})).json()["warnings"].is_array())
            << arguments[0];
}

TEST_F(CommandLineTest, NamesThatLookLikeOptionsWorkAfterTwoDashes) {
    write("-m.obj", octahedron_obj());
    write("-e.hdr", white_hdr());
    succeed("precompute -o ./-s.prt --face-resolution 16 -- -m.obj");
    succeed("info -- -s.prt");
    succeed("relight -o ./-o.npy -- -s.prt -e.hdr");
    EXPECT_TRUE(fs::exists(folder() / "-o.npy"));
}

TEST_F(CommandLineTest, LinesOfAFileNameWithALineBreakStayOneLine) {
    fail({"info", "two\nlines.prt"}, {"two lines.prt"});
    fail({"info", "carriage\rreturn.prt"});
    misuse({"generate", "two\nlines", "-o", "new"});
}

TEST_F(CommandLineTest, ManyThreadsAreNoMistake) {
    precompute();
    succeed("relight scene.prt env.hdr -o new.npy --threads 64");
}

} // namespace
} // namespace relumine::app
