// `relumine completion` and `relumine man`: what shells offer, what the pages say.
#include <algorithm>
#include <array>
#include <cstdio>
#include <regex>
#include <set>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/app/command.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

class Documentation : public AppTest {
protected:
    /// What a shell command prints, errors included, in the test's folder. Expected to succeed.
    [[nodiscard]] std::string shell(const std::string& command) const {
        const std::string whole =
            "cd '" + folder().string() + "' && { " + command + "\n} 2>&1 </dev/null";
        FILE* pipe = ::popen(whole.c_str(), "r");
        EXPECT_NE(pipe, nullptr);
        std::string text;
        std::array<char, 4096> buffer;
        while (const std::size_t size = std::fread(buffer.data(), 1, buffer.size(), pipe))
            text.append(buffer.data(), size);
        EXPECT_EQ(::pclose(pipe), 0) << command << "\n" << text;
        return text;
    }
    [[nodiscard]] bool has(const std::string& program) const {
        return !shell("command -v " + program + " || true").empty();
    }

    /// What bash offers for the last of the words.
    [[nodiscard]] std::vector<std::string> offered(const std::vector<std::string>& words) const {
        std::string script = "bash -c 'set -u; source relumine.bash; COMP_WORDS=(";
        for (const std::string& word : words)
            script += " \"" + word + "\"";
        script += "); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _relumine; "
                  "((${#COMPREPLY[@]} == 0)) || printf \"%s\\n\" \"${COMPREPLY[@]}\"'";
        return lines_of(shell(script));
    }

    [[nodiscard]] std::vector<std::string> commands() const {
        return {"precompute", "plan",  "join",     "relight", "animate", "edit",   "verify",
                "lights",     "info",  "generate", "env",     "mesh",    "view",   "completion",
                "man",        "serve", "help",     "fit",     "export",  "coarsen"};
    }
};

TEST_F(Documentation, BashCompletesCommands) {
    succeed({"completion", "bash", "-o", "relumine.bash"});
    EXPECT_EQ(shell("bash -n relumine.bash"), "");
    EXPECT_THAT(offered({"relumine", "re"}), ElementsAre("relight"));
    EXPECT_THAT(offered({"relumine", ""}), testing::UnorderedElementsAreArray(commands()));
    EXPECT_THAT(offered({"relumine", "env", ""}), ElementsAre("convert"));
    EXPECT_THAT(offered({"relumine", "x"}), IsEmpty());
    EXPECT_THAT(offered({"relumine", "--v"}), ElementsAre("--version"));
}

TEST_F(Documentation, BashCompletesOptionsAndValues) {
    succeed({"completion", "bash", "-o", "relumine.bash"});
    EXPECT_THAT(offered({"relumine", "animate", "--me"}),
                UnorderedElementsAre("--method", "--measure"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", ""}),
                UnorderedElementsAre("prt", "clusters", "importance"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", "=", "i"}), ElementsAre("importance"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", "="}),
                UnorderedElementsAre("prt", "clusters", "importance"));
    EXPECT_THAT(offered({"relumine", "env", "convert", "--to-l"}), ElementsAre("--to-layout"));
    EXPECT_THAT(offered({"relumine", "completion", ""}),
                UnorderedElementsAre("bash", "zsh", "fish"));
    EXPECT_THAT(offered({"relumine", "man", "env"}), UnorderedElementsAre("env", "env-convert"));
    EXPECT_THAT(offered({"relumine", "verify", "--samples", ""}), IsEmpty());
    EXPECT_THAT(offered({"relumine", "generate", "colon"}), ElementsAre("colonnade"));
}

TEST_F(Documentation, BashCompletesFileNames) {
    succeed({"completion", "bash", "-o", "relumine.bash"});
    write("a mesh.ply", "");
    write("other.prt", "");
    fs::create_directory(folder() / "a folder");
    EXPECT_THAT(offered({"relumine", "precompute", "a m"}), ElementsAre("a mesh.ply"));
    EXPECT_THAT(offered({"relumine", "relight", "o"}), ElementsAre("other.prt"));
    EXPECT_THAT(offered({"relumine", "relight", "other.prt", "-o", "o"}), ElementsAre("other.prt"));
    EXPECT_THAT(offered({"relumine", "generate", "-o", "a"}), ElementsAre("a folder"));
}

TEST_F(Documentation, OtherShellsReadTheirScripts) {
    succeed({"completion", "zsh", "-o", "_relumine"});
    succeed({"completion", "fish", "-o", "relumine.fish"});
    EXPECT_EQ(read("_relumine").rfind("#compdef relumine\n", 0), 0u);
    EXPECT_EQ(succeed({"completion", "zsh"}).out, read("_relumine"));
    EXPECT_EQ(succeed({"completion", "fish"}).out, read("relumine.fish"));
    for (const std::string& command : commands()) {
        EXPECT_THAT(read("_relumine"), HasSubstr("_relumine_" + command + "()"));
        EXPECT_THAT(read("relumine.fish"), HasSubstr(" -a " + command + " "));
    }
    if (!has("zsh") || !has("fish"))
        GTEST_SKIP() << "without zsh or fish the scripts cannot be read";
    EXPECT_EQ(shell("zsh -n _relumine"), "");
    EXPECT_EQ(shell("fish --no-execute relumine.fish"), "");
    // Without the descriptions behind the words.
    const auto fish = [this](const std::string& line) {
        std::vector<std::string> words = lines_of(shell(
            "HOME=. fish --no-config -c 'source relumine.fish; complete -C \"" + line + "\"'"));
        for (std::string& word : words)
            word = word.substr(0, word.find('\t'));
        return words;
    };
    EXPECT_THAT(fish("relumine re"), ElementsAre("relight"));
    EXPECT_THAT(fish("relumine animate --method "),
                UnorderedElementsAre("prt", "clusters", "importance"));
    EXPECT_THAT(fish("relumine env "), ElementsAre("convert"));
    write("mesh.ply", "");
    EXPECT_THAT(fish("relumine precompute me"), ElementsAre("mesh.ply"));
    EXPECT_THAT(fish("relumine verify --samples "), IsEmpty());
}

TEST_F(Documentation, EveryCommandHasAPageWithAllItsOptions) {
    succeed({"man", "-o", "pages/man1"});
    std::vector<std::string> all = commands();
    all.insert(all.end(), {"relumine", "env-convert", "export-runtime", "export-web", "mesh-repair",
                           "mesh-refine", "mesh-simplify"});
    EXPECT_EQ(std::distance(fs::directory_iterator(folder() / "pages/man1"), {}),
              static_cast<std::ptrdiff_t>(all.size()));
    EXPECT_EQ(succeed({"man"}).out, read("pages/man1/relumine.1"));
    for (const std::string& command : all) {
        const std::string name = command == "relumine" ? command : "relumine-" + command;
        const std::string page = read("pages/man1/" + name + ".1");
        EXPECT_EQ(succeed({"man", command}).out, page);
        const std::string plain = std::regex_replace(page, std::regex("\\\\-"), "-");
        EXPECT_THAT(plain, HasSubstr(".SH NAME\n" + name + " - ")) << name;
    }
}

TEST_F(Documentation, PagesSayWhatTheHelpSays) {
    const std::string page =
        std::regex_replace(succeed({"man", "animate"}).out, std::regex("\\\\-"), "-");
    const std::string help = succeed({"animate", "--help"}).out;
    std::set<std::string> options;
    const std::regex option("\n  (?:-.,)?(--[a-z0-9-]+)");
    for (std::sregex_iterator each(help.begin(), help.end(), option), end; each != end; ++each)
        options.insert((*each)[1]);
    EXPECT_GT(options.size(), 30u);
    for (const std::string& name : options)
        EXPECT_THAT(page, HasSubstr("\\fB" + name + "\\fR")) << name;
    EXPECT_THAT(page, HasSubstr("One of: prt, clusters, importance. Default: prt."));
    EXPECT_THAT(page, HasSubstr("[\\fIOPTION\\fR]... \\fISCENE\\fR \\fIFRAMES\\fR"));
}

TEST_F(Documentation, PagesAreSoundRoff) {
    if (!has("groff"))
        GTEST_SKIP() << "without groff the pages cannot be set";
    succeed({"man", "-o", "pages"});
    for (const auto& entry : fs::directory_iterator(folder() / "pages"))
        EXPECT_EQ(
            shell("groff -man -ww -Tutf8 -z 'pages/" + entry.path().filename().string() + "'"), "")
            << entry.path();
}

TEST_F(Documentation, WrongUsage) {
    misuse({"completion"}, "SHELL");
    misuse({"completion", "tcsh"}, "tcsh");
    misuse({"man", "walk"}, "walk");
    misuse({"man", "edit", "relight"}, "relight");
    fail({"completion", "bash", "-o", "missing/relumine"}, {"missing/relumine"});
    write("file", "");
    fail({"man", "-o", "file/pages"}, {"file/pages"});
}

} // namespace
} // namespace relumine::app
