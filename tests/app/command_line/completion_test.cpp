// `relumine completion`: what bash offers.
#include <array>
#include <cstdio>
#include <sstream>

#include <gmock/gmock.h>

#include "tests/app/command.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
        lines.push_back(line);
    return lines;
}

class Completion : public AppTest {
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
        return {"precompute", "plan", "join",     "relight", "animate", "edit", "verify",
                "lights",     "info", "generate", "env",     "mesh",    "view", "completion",
                "help",       "fit",  "export",   "coarsen", "move"};
    }
};

TEST_F(Completion, BashCompletesCommands) {
    succeed("completion -o relumine.bash");
    EXPECT_EQ(shell("bash -n relumine.bash"), "");
    EXPECT_THAT(offered({"relumine", "re"}), ElementsAre("relight"));
    EXPECT_THAT(offered({"relumine", ""}), testing::UnorderedElementsAreArray(commands()));
    EXPECT_THAT(offered({"relumine", "env", ""}), ElementsAre("convert"));
    EXPECT_THAT(offered({"relumine", "x"}), IsEmpty());
    EXPECT_THAT(offered({"relumine", "--v"}), ElementsAre("--version"));
}

TEST_F(Completion, BashCompletesOptionsAndValues) {
    succeed("completion -o relumine.bash");
    EXPECT_THAT(offered({"relumine", "animate", "--me"}),
                UnorderedElementsAre("--method", "--measure"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", ""}),
                UnorderedElementsAre("prt", "clusters", "importance"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", "=", "i"}), ElementsAre("importance"));
    EXPECT_THAT(offered({"relumine", "animate", "--method", "="}),
                UnorderedElementsAre("prt", "clusters", "importance"));
    EXPECT_THAT(offered({"relumine", "env", "convert", "--split"}), ElementsAre("--split-sun"));
    EXPECT_THAT(offered({"relumine", "verify", "--samples", ""}), IsEmpty());
    EXPECT_THAT(offered({"relumine", "generate", "colon"}), ElementsAre("colonnade"));
}

TEST_F(Completion, BashCompletesFileNames) {
    succeed("completion -o relumine.bash");
    write("a mesh.ply", "");
    write("other.prt", "");
    fs::create_directory(folder() / "a folder");
    EXPECT_THAT(offered({"relumine", "precompute", "a m"}), ElementsAre("a mesh.ply"));
    EXPECT_THAT(offered({"relumine", "relight", "o"}), ElementsAre("other.prt"));
    EXPECT_THAT(offered({"relumine", "relight", "other.prt", "-o", "o"}), ElementsAre("other.prt"));
    EXPECT_THAT(offered({"relumine", "generate", "-o", "a"}), ElementsAre("a folder"));
}

TEST_F(Completion, WrongUsage) {
    misuse("completion tcsh", "tcsh");
    fail("completion -o missing/relumine", {"missing/relumine"});
}

} // namespace
} // namespace relumine::app
