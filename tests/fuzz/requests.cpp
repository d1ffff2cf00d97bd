// Requests of `relumine serve`, one per line of the input, to a service with a small scene. Every
// request has an answer of one line of JSON, whatever it asks for.
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "app/service/service.h"
#include "app/session.h"
#include "relumine/relumine.h"
#include "tests/app/small_files.h"
#include "tests/fuzz/fuzz.h"

namespace {

namespace fs = std::filesystem;
using namespace relumine;

/// A folder with scene.prt, env.hdr and layers.json, which becomes the current one.
const fs::path& request_folder() {
    static const fs::path Path = [] {
        fs::path path = fuzz::folder() / "requests";
        fs::create_directory(path);
        fs::current_path(path);
        std::ofstream("mesh.obj", std::ios::binary) << app::octahedron_obj();
        std::ofstream("env.hdr", std::ios::binary) << app::hdr_file(
            16, 8, [](auto x, auto) { return app::Rgb{static_cast<float>(x), 1.0f, 1.0f}; });
        std::ofstream("layers.json", std::ios::binary) << R"({"version": 1, "layers": []})";
        static_cast<void>(
            precompute(load_mesh("mesh.obj"), {.face_resolution = 8, .output = "scene.prt"}));
        return path;
    }();
    return Path;
}

bool is_input(const fs::path& path) {
    for (const char* name : {"mesh.obj", "env.hdr", "layers.json", "scene.prt"})
        if (path.filename() == name)
            return true;
    return false;
}

} // namespace

RELUMINE_FUZZ_TARGET(requests) {
    std::string_view text(reinterpret_cast<const char*>(data), size);
    // A slash would lead out of the folder; sizes may ask for gigabytes, and get them.
    for (const std::string_view word : {"/", "\\u", "resolution", "size"})
        if (text.find(word) != std::string_view::npos)
            return 0;
    fs::current_path(request_folder());
    static app::Session session;
    session.json = session.quiet = true;
    app::Service service(session);
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string answer = service.answer(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        fuzz::require(answer.starts_with('{') && answer.ends_with('}') &&
                          answer.find('\n') == std::string::npos,
                      "an answer is one line with an object");
        if (answer.find("\"ok\":true") != std::string::npos)
            ++fuzz::num_accepted;
        else
            fuzz::require(answer.find("\"error\":\"") != std::string::npos,
                          "a request that fails is told why");
    }
    for (const auto& entry :
         std::vector<fs::directory_entry>(fs::directory_iterator("."), fs::directory_iterator()))
        if (!is_input(entry.path()))
            fs::remove_all(entry.path());
    return 0;
}
