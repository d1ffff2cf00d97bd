// `relumine serve`: requests over stdin and stdout, and over a Unix socket.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "tests/app/command.h"
#include "tests/app/formats.h"
#include "tests/app/small_files.h"

namespace relumine::app {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A client of a server's socket.
class Client {
public:
    explicit Client(const fs::path& path, int flags = 0)
        : socket_(::socket(AF_UNIX, SOCK_STREAM | flags, 0)) {
        sockaddr_un address{};
        address.sun_family = AF_UNIX;
        std::strncpy(address.sun_path, path.c_str(), sizeof address.sun_path - 1);
        is_open_ =
            ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
    }
    ~Client() { ::close(socket_); }
    Client(const Client&) = delete;
    Client& operator=(const Client&) = delete;

    [[nodiscard]] bool is_open() const { return is_open_; }
    void send(const std::string& text) const {
        EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL),
                  static_cast<ssize_t>(text.size()));
    }
    json receive() {
        while (received_.find('\n') == std::string::npos) {
            std::array<char, 4096> buffer;
            const ssize_t size = ::recv(socket_, buffer.data(), buffer.size(), 0);
            if (size <= 0) {
                ADD_FAILURE() << "no answer";
                return json::object();
            }
            received_.append(buffer.data(), static_cast<std::size_t>(size));
        }
        const std::size_t end = received_.find('\n');
        const std::string line = received_.substr(0, end);
        received_.erase(0, end + 1);
        return json::parse(line);
    }
    json ask(const json& request) {
        send(request.dump() + "\n");
        return receive();
    }

private:
    int socket_;
    bool is_open_ = false;
    std::string received_;
};

class Serve : public AppTest {
protected:
    Serve() {
        write("mesh.obj", octahedron_obj());
        write("studio.hdr", white_hdr());
        succeed({"precompute", "mesh.obj", "-o", "scene.prt", "--face-resolution", "16", "-q",
                 "--no-refine"});
    }

    /// The answers to lines on stdin.
    std::vector<json> answers(const std::string& lines) const {
        write("requests", lines);
        const Result result =
            relumine({"serve", "-"}, {.stdin_path = (folder() / "requests").string()});
        EXPECT_EQ(result.exit_code, 0) << result.described();
        EXPECT_EQ(result.err, "");
        std::vector<json> all;
        std::istringstream out(result.out);
        for (std::string line; std::getline(out, line);)
            all.push_back(json::parse(line));
        return all;
    }

    /// Waits until the server has made its socket.
    static void wait_for(const fs::path& path) {
        for (int i = 0; i < 2000 && !fs::exists(path); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        ASSERT_TRUE(fs::is_socket(path));
    }

    [[nodiscard]] fs::path socket() const { return folder() / "socket"; }
    const std::string scene_ = R"({"do": "scene", "scene": "scene.prt"})";
    const std::string environment_ = R"({"do": "environment", "env": "studio.hdr"})";
};

TEST_F(Serve, AnEyeHasItsHighlights) {
    succeed({"precompute", "mesh.obj", "-o", "shiny.prt", "--face-resolution", "16", "-q",
             "--no-refine", "--material", "ggx:roughness=0.4,albedo=0.3,f0=0.5"});
    const std::string scene = R"({"do": "scene", "scene": "shiny.prt"})";
    const auto edit = [](int degrees) {
        return fmt::format(R"({{"do": "edit", "layers": [{{"name": "key", "type": "disc", )"
                           R"("effect": "emit", "radiance": [9, 9, 9], "direction": [0, 1, 0.{}], )"
                           R"("radius_degrees": 20}}]}})",
                           degrees);
    };
    const std::string eye = R"({"do": "radiance", "eye": [1, 2, 4], "output": ")";
    const std::vector<json> all =
        answers(scene + "\n" + environment_ + "\n" + R"({"do": "radiance", "output": "matt.npy"})" +
                "\n" + eye + "first.npy\"}\n" + edit(1) + "\n" + eye + "1.npy\"}\n" + edit(2) +
                "\n" + eye + "2.npy\"}\n" + edit(3) + "\n" + eye + "kept.npy\"}\n" + scene_ + "\n" +
                environment_ + "\n" + eye + "none.npy\"}");
    ASSERT_EQ(all.size(), 13u);
    for (std::size_t i = 0; i < 12; ++i)
        EXPECT_EQ(all[i]["ok"], true) << all[i];
    EXPECT_NE(all[12]["error"].get<std::string>().find("expected vertices with glossy materials"),
              std::string::npos)
        << all[12];
    const auto fresh =
        answers(scene + "\n" + environment_ + "\n" + edit(3) + "\n" + eye + "fresh.npy\"}");
    EXPECT_EQ(fresh.back()["ok"], true) << fresh.back();
    const auto kept = npy_values(read("kept.npy")), expected = npy_values(read("fresh.npy")),
               matt = npy_values(read("matt.npy")), first = npy_values(read("first.npy"));
    ASSERT_EQ(kept.size(), expected.size());
    bool is_shiny = false;
    for (std::size_t i = 0; i < kept.size(); ++i) {
        is_shiny = is_shiny || std::abs(first[i][0] - matt[i][0]) > 0.05f;
        for (std::size_t channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(kept[i][channel], expected[i][channel], 1e-4f) << i;
    }
    EXPECT_TRUE(is_shiny);
}

TEST_F(Serve, GivesWhatTheCommandsGive) {
    write("layers.json", R"({"version": 1, "layers": [{"name": "key", "type": "disc", "effect":
        "gain", "factor": 4, "direction": [0, 1, 0], "radius_degrees": 30}]})");
    const std::vector<json> all =
        answers(scene_ + "\n" + environment_ + "\n" +
                R"({"do": "radiance", "output": "white.npy", "id": 7}
{"do": "edit", "layers": [{"name": "key", "type": "disc", "effect": "gain", "factor": 4,)"
                R"( "direction": [0, 1, 0], "radius_degrees": 30}], "id": "two"}
{"do": "radiance", "output": "key.npy"}
{"do": "edit", "layers": "layers.json"}
{"do": "radiance", "output": "file.npy"}
{"do": "picture", "output": "key.exr", "size": "32x24", "eye": [0, 1, 4], "albedo": 0.5}
)" + R"({"do": "edit", "layers": []}
{"do": "radiance", "output": "again.npy"}
)" + environment_);
    ASSERT_EQ(all.size(), 11u);
    for (const json& answer : all)
        EXPECT_EQ(answer["ok"], true) << answer;
    EXPECT_EQ(all[0]["receivers"], 6);
    EXPECT_EQ(all[1]["was_kept"], false);
    EXPECT_EQ(all[2]["id"], 7);
    EXPECT_EQ(all[2]["bytes"], 72);
    EXPECT_EQ(all[3]["id"], "two");
    EXPECT_EQ(all[3]["layers"], 1);
    EXPECT_EQ(all[5]["receivers"], 0) << "the same layer again";
    EXPECT_EQ(all[10]["was_kept"], true);

    succeed({"relight", "scene.prt", "studio.hdr", "-o", "plain.npy"});
    succeed({"edit", "scene.prt", "studio.hdr", "layers.json", "-o", "edited.npy"});
    succeed({"edit", "scene.prt", "studio.hdr", "layers.json", "-o", "edited.exr", "--size",
             "32x24", "--eye", "0,1,4", "--albedo", "0.5"});
    EXPECT_EQ(read("white.npy"), read("plain.npy"));
    EXPECT_EQ(read("key.npy"), read("edited.npy"));
    EXPECT_EQ(read("file.npy"), read("key.npy"));
    EXPECT_EQ(read("key.exr"), read("edited.exr"));
    EXPECT_NE(read("white.npy"), read("key.npy"));
}

TEST_F(Serve, AFailedRequestIsOneLineAndTheSceneGoesOn) {
    const std::vector<json> all =
        answers(environment_ + "\n" + scene_ + "\n" + environment_ + "\n" +
                R"(no JSON
[1]
{"scene": "scene.prt"}
{"do": "enviroment"}
{"do": "environment", "env": "missing.hdr"}
{"do": "environment", "env": "studio.hdr", "rotat": 1}
{"do": "environment", "env": "studio.hdr", "rotate": "much"}
{"do": "environment", "env": ""}
{"do": "environment"}
{"do": "picture", "output": "a.png", "size": {}}
{"do": "picture", "output": "scene.prt"}
{"do": "picture", "output": "a.png", "transparent": 1}
{"do": "radiance"}
{"do": "radiance", "output": "a.txt"}
{"do": "radiance", "shared-memory": "/relumine-is-not-there"}
{"do": "edit", "layers": [{"name": "key", "tipe": "disc"}]}
{"do": "edit", "layers": "missing.json"}
{"do": "scene", "scene": "studio.hdr"}

{"do": "radiance", "output": "after.npy"})");
    const std::vector<std::string> parts = {
        "request scene first",
        "",
        "",
        "request:1: expected",
        "a request to be an object",
        "\"do\"",
        "did you mean environment?",
        "missing.hdr: cannot read",
        "did you mean rotate?",
        "--rotate: expected a number, got 'much'",
        "ENV: expected a value, got ''",
        "ENV is required",
        "size: expected text",
        "expected a name that ends in .png",
        "\"transparent\" to be true or false",
        "output or shared-memory",
        "ends in .npy",
        "relumine-is-not-there: cannot write shared memory: No such file",
        "request:1: expected \"type\"",
        "missing.json: cannot read",
        "expected a scene, got the environment studio.hdr",
        ""};
    ASSERT_EQ(all.size(), parts.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        EXPECT_EQ(all[i]["ok"], parts[i].empty()) << all[i];
        EXPECT_NE(all[i].value("error", "").find(parts[i]), std::string::npos) << all[i];
        EXPECT_GE(all[i].value("seconds", -1.0), 0.0) << all[i];
    }
    EXPECT_TRUE(fs::exists(folder() / "after.npy"));
    EXPECT_FALSE(fs::exists(folder() / "a.png"));
}

TEST_F(Serve, WarningsAreInTheAnswer) {
    write("bad.exr", exr_file(64, 32, [](std::uint32_t x, std::uint32_t y) {
              return Rgb{x + y == 0 ? std::nanf("") : 1.0f, 1.0f, 1.0f};
          }));
    const std::vector<json> all =
        answers(scene_ + "\n" + R"({"do": "environment", "env": "bad.exr", "fix_env": true})" +
                "\n" + R"({"do": "help"})");
    ASSERT_EQ(all.size(), 3u);
    EXPECT_EQ(all[1]["replaced_pixels"], 1) << all[1];
    EXPECT_TRUE(all[1]["warnings"].is_array());
    EXPECT_FALSE(all[2].contains("replaced_pixels"));
    EXPECT_EQ(all[2]["requests"].size(), 6u);
}

TEST_F(Serve, AnEnvironmentThatWasSavedIsReadAgain) {
    Process server(folder(), {"serve", "socket"});
    wait_for(socket());
    Client client(socket());
    EXPECT_EQ(client.ask(json::parse(scene_))["ok"], true);
    EXPECT_EQ(client.ask(json::parse(environment_))["was_kept"], false);
    EXPECT_EQ(client.ask(json::parse(environment_))["was_kept"], true);
    write("studio.hdr", hdr_file(128, 64, [](auto, auto) { return Rgb{2.0f, 2.0f, 2.0f}; }));
    EXPECT_EQ(client.ask(json::parse(environment_))["was_kept"], false);
}

TEST_F(Serve, RadianceGoesToSharedMemory) {
    Process server(folder(), {"serve", "socket"});
    wait_for(socket());
    Client client(socket());
    client.ask(json::parse(scene_));
    client.ask(json::parse(environment_));
    const std::string name = fmt::format("/relumine_test_{}", ::getpid());
    const int object = ::shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR, 0600);
    ASSERT_GE(object, 0);
    ASSERT_EQ(::ftruncate(object, 71), 0);
    const json request = {{"do", "radiance"}, {"shared-memory", name}};
    EXPECT_NE(client.ask(request)["error"].dump().find("72 bytes or more, got 71"),
              std::string::npos);
    ASSERT_EQ(::ftruncate(object, 100), 0);
    EXPECT_EQ(client.ask(request)["bytes"], 72);
    std::array<float, 18> radiance{};
    EXPECT_EQ(::pread(object, radiance.data(), sizeof radiance, 0),
              static_cast<ssize_t>(sizeof radiance));
    for (const float value : radiance)
        EXPECT_NEAR(value, 1.0f, 0.01f);
    ::close(object);
    ::shm_unlink(name.c_str());
}

TEST_F(Serve, SocketIsItsOwnersAloneAndGoesAtTheEnd) {
    for (const int signal : {SIGINT, SIGTERM}) {
        Process server(folder(), {"serve", "socket"});
        wait_for(socket());
        struct stat status{};
        ASSERT_EQ(::lstat(socket().c_str(), &status), 0);
        EXPECT_EQ(status.st_mode & 07777, 0600u);
        EXPECT_EQ(status.st_nlink, 1u);
        Client idle(socket());
        server.send(signal);
        const Result result = server.wait();
        EXPECT_EQ(result.exit_code, 0) << result.described();
        EXPECT_EQ(result.err, "");
        EXPECT_LT(result.processor_seconds, AtOnce);
        EXPECT_FALSE(fs::exists(socket()));
    }
}

TEST_F(Serve, AStaleSocketIsReplacedAndOneInUseIsNot) {
    {
        Process killed(folder(), {"serve", "socket"});
        wait_for(socket());
        killed.send(SIGKILL);
        EXPECT_EQ(killed.wait().signal, SIGKILL);
    }
    EXPECT_TRUE(fs::is_socket(socket()));
    Process server(folder(), {"serve", "socket"});
    while (!Client(socket()).is_open())
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    fail({"serve", "socket"}, {"socket: expected a socket that nobody serves, got one in use"});
    Client client(socket());
    EXPECT_EQ(client.ask(json::parse(scene_))["ok"], true) << "the first goes on";
    fail({"serve", "mesh.obj"}, {"mesh.obj: expected a new name, or a socket"});
    fail({"serve", "missing/socket"}, {"missing/socket: cannot serve: No such file"});
    fail({"serve", std::string(120, 'a')}, {"expected a name of at most"});
    misuse({"serve"}, "SOCKET");
}

TEST_F(Serve, ManyServersThatStartTogetherAreOne) {
    {
        Process killed(folder(), {"serve", "socket"});
        wait_for(socket());
        killed.send(SIGKILL);
        static_cast<void>(killed.wait());
    }
    std::vector<std::unique_ptr<Process>> servers;
    for (int i = 0; i < 6; ++i)
        servers.push_back(
            std::make_unique<Process>(folder(), std::vector<std::string>{"serve", "socket", "-q"}));
    const auto num_running = [&] {
        return std::count_if(servers.begin(), servers.end(),
                             [](const auto& server) { return server->is_running(); });
    };
    for (int i = 0; i < 2000 && num_running() > 1; ++i)
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    EXPECT_EQ(num_running(), 1);
    EXPECT_EQ(Client(socket()).ask(json::parse(scene_))["ok"], true);
    for (const auto& server : servers) {
        if (server->is_running())
            server->send(SIGTERM);
        static_cast<void>(server->wait());
    }
    EXPECT_FALSE(fs::exists(socket()));
}

TEST_F(Serve, ClientsThatGoAwayOrDoNotReadDoNoHarm) {
    Process server(folder(), {"serve", "socket"});
    wait_for(socket());
    {
        Client(socket()).send(scene_);
    } // no line break, gone
    {
        Client(socket()).send(scene_ + "\n" + environment_ + "\n" + "{\"do\": \"radi");
    }
    Client silent(socket());
    for (int i = 0; i < 200; ++i)
        silent.send("{\"do\": \"help\"}\n"); // answers pile up unread
    Client client(socket());
    EXPECT_EQ(client.ask(json::parse(scene_))["ok"], true);
    client.send("{\"do\": \"help\", \"id\":");
    Client other(socket());
    EXPECT_EQ(other.ask(json::parse(environment_))["ok"], true);
    client.send(" 1}\r\n");
    EXPECT_EQ(client.receive()["id"], 1);
    for (int i = 0; i < 200; ++i)
        EXPECT_EQ(silent.receive()["ok"], true);
    EXPECT_TRUE(server.is_running());
}

TEST_F(Serve, SixtyFourClientsMayConnectWhileARequestIsAnswered) {
    Process server(folder(), {"serve", "socket"});
    wait_for(socket());
    server.send(SIGSTOP);
    std::vector<std::unique_ptr<Client>> clients;
    for (int i = 0; i < 64; ++i)
        clients.push_back(std::make_unique<Client>(socket(), SOCK_NONBLOCK));
    for (const auto& client : clients)
        EXPECT_TRUE(client->is_open());
    server.send(SIGCONT);
}

TEST_F(Serve, LinesHaveABound) {
    Process server(folder(), {"serve", "socket"});
    wait_for(socket());
    Client client(socket());
    const std::string part(1 << 20, ' ');
    for (int i = 0; i < 17; ++i)
        client.send(part);
    // Refused before it ends.
    const json refused = client.receive();
    EXPECT_NE(refused["error"].dump().find("at most 16777216 bytes"), std::string::npos);
    EXPECT_GE(refused.value("seconds", -1.0), 0.0);
    for (int i = 0; i < 23; ++i)
        client.send(part);
    client.send("\n" + scene_ + "\n");
    EXPECT_EQ(client.receive()["ok"], true);
    server.send(SIGTERM);
    EXPECT_LT(server.wait().peak_bytes, SanitizerFactor * (std::uint64_t{200} << 20));
}

/// The program in docs/serve.md, as it stands there.
TEST_F(Serve, ThePageHasAnExampleThatWorks) {
    if (std::system("python3 -c 'import multiprocessing.shared_memory' 2>/dev/null") != 0)
        GTEST_SKIP() << "no python3 here";
    std::ifstream page(RELUMINE_SOURCE_DIR "/docs/serve.md");
    const std::string text(std::istreambuf_iterator<char>(page), {});
    const std::size_t start = text.find("```python\n") + 10;
    write("example.py", text.substr(start, text.find("```", start) - start));
    Process server(folder(), {"serve", "relumine.sock"});
    wait_for(folder() / "relumine.sock");
    const std::string command =
        fmt::format("cd '{}' && python3 example.py >example.out 2>&1", folder().string());
    EXPECT_EQ(std::system(command.c_str()), 0) << read("example.out");
    EXPECT_NE(read("example.out").find("brightest "), std::string::npos);
    EXPECT_TRUE(fs::exists(folder() / "lit.png"));
}

} // namespace
} // namespace relumine::app
