#include "tests/fuzz/fuzz.h"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "files/parallel.h"
#include "tests/app/small_files.h"
#include "tests/mesh/texture_files.h"

namespace relumine::fuzz {

namespace {

namespace fs = std::filesystem;

/// One thread: libFuzzer counts the code that an input reaches, which must not depend on who is
/// faster.
const files::ThreadLimit one_thread(1);

void write(const fs::path& path, std::string_view content) {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(content.data(), static_cast<std::streamsize>(content.size()));
    require(file.good(), "the folder for temporary files takes files");
}

class Folder {
public:
    Folder() {
        std::string name = (fs::temp_directory_path() / "relumine_fuzz_XXXXXX").string();
        require(::mkdtemp(name.data()) != nullptr, "there is a folder for temporary files");
        path = name;
        write(path / "four_colors.png", mesh::four_colors());
        write(path / "pixel.exr", app::exr_file(2, 1, [](auto x, auto) {
                  return app::Rgb{1.0f, 0.5f, static_cast<float>(x)};
              }));
        write(
            path / "mesh.mtl",
            "newmtl red\nKd 1 0 0\nmap_Kd four_colors.png\nnewmtl shiny\nKs 0.5 0.5 0.5\nNs 20\n");
        write(path / "buffer.bin", std::string(64, '\0'));
    }
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path, ignored);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;

    fs::path path;
};

} // namespace

std::atomic<std::size_t> num_accepted = 0;

std::span<const std::byte> bytes(const std::uint8_t* data, std::size_t size) {
    return std::as_bytes(std::span(data, size));
}

void require(bool condition, std::string_view sentence) {
    if (condition)
        return;
    fmt::print(stderr, "not so: {}\n", sentence);
    std::abort();
}

void require_message(const std::runtime_error& error) {
    const std::string_view message = error.what();
    const bool has_form = message.find("expected ") != std::string_view::npos ||
                          message.find("cannot ") != std::string_view::npos;
    if (!has_form || message.size() > 2000 || message.find('\n') != std::string_view::npos)
        fmt::print(stderr, "the message: {}\n", message);
    require(has_form, "a message says what was expected");
    require(message.size() <= 2000 && message.find('\n') == std::string_view::npos,
            "a message is one line of moderate length");
}

const fs::path& folder() {
    thread_local const Folder instance;
    return instance.path;
}

fs::path file(std::string_view name, std::span<const std::byte> content) {
    fs::path path = folder() / name;
    write(path, {reinterpret_cast<const char*>(content.data()), content.size()});
    return path;
}

} // namespace relumine::fuzz
