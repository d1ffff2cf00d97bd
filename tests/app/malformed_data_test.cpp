// Real malformed files, where the data folder is there.
#include <algorithm>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"
#include "tests/real_data.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;

class MalformedData : public AppTest {
protected:
    static std::vector<fs::path> data_files(const std::string& name) {
        std::vector<fs::path> result;
        const fs::path path = real_data(name);
        if (fs::is_directory(path))
            for (const auto& entry : fs::directory_iterator(path))
                result.push_back(fs::absolute(entry.path()));
        std::sort(result.begin(), result.end());
        return result;
    }
    static std::ptrdiff_t occurrences(const std::string& text, const std::string& part) {
        std::ptrdiff_t count = 0;
        for (std::size_t at = text.find(part); at != std::string::npos;
             at = text.find(part, at + part.size()))
            ++count;
        return count;
    }
    /// Done, or refused in one line that names the file; quickly and in little memory either way.
    bool is_read_or_refused(const std::vector<std::string>& arguments, const fs::path& file) const {
        const std::vector<std::string> before = files();
        const Result result = relumine(arguments);
        EXPECT_LT(result.processor_seconds, AtOnce) << file;
        EXPECT_LT(result.peak_bytes, 200'000'000u * SanitizerFactor) << file;
        EXPECT_EQ(result.signal, 0) << file;
        if (result.exit_code == 0) {
            // What is left out is said, with the file's name.
            EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'),
                      occurrences(result.err, "warning: " + file.string() + ": "))
                << result.described();
            return true;
        }
        EXPECT_EQ(result.exit_code, 1) << file << result.described();
        EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.described();
        EXPECT_NE(result.err.find(file.filename().string()), std::string::npos)
            << result.described();
        EXPECT_EQ(files(), before) << file;
        return false;
    }
};

TEST_F(MalformedData, Meshes) {
    const std::vector<fs::path> meshes = data_files("meshes/malformed");
    if (meshes.empty())
        GTEST_SKIP() << absent_data("meshes/malformed");
    for (const fs::path& mesh : meshes) {
        const bool described = is_read_or_refused({"info", mesh.string()}, mesh);
        const bool precomputed =
            is_read_or_refused({"precompute", mesh.string(), "-o", "new.prt", "--face-resolution",
                                "16", "--tolerance", "0.1"},
                               mesh);
        EXPECT_EQ(described, precomputed) << mesh;
        fs::remove(folder() / "new.prt");
    }
}

TEST_F(MalformedData, Environments) {
    const std::vector<fs::path> environments = data_files("envs/robustness");
    if (environments.empty())
        GTEST_SKIP() << absent_data("envs/robustness");
    write("mesh.obj", octahedron_obj());
    succeed("precompute mesh.obj -o scene.prt --face-resolution 16 -q --refine off");
    for (const fs::path& environment : environments)
        for (const std::vector<std::string>& more : {std::vector<std::string>{},
                                                     {"--layout", "latlong"},
                                                     {"--fix-env"},
                                                     {"--fix-env", "--layout", "latlong"}}) {
            std::vector<std::string> arguments = {"relight", "scene.prt", environment.string(),
                                                  "-o", "new.npy"};
            arguments.insert(arguments.end(), more.begin(), more.end());
            if (is_read_or_refused(arguments, environment)) {
                EXPECT_FALSE(more.empty()) << environment << ": square pictures and damaged files";
                for (const auto& value : npy_values(read("new.npy")))
                    EXPECT_GE(value[0], 0.0f) << environment;
            }
            fs::remove(folder() / "new.npy");
            if (more.empty() || more[0] == "--layout") {
                std::vector<std::string> info = {"info", environment.string()};
                info.insert(info.end(), more.begin(), more.end());
                static_cast<void>(is_read_or_refused(info, environment));
            }
        }
}

} // namespace
} // namespace relumine::app
