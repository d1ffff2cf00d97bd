#include "app/web/web_files.h"

#include <stdexcept>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "app/web/page_parts.h"
#include "files/output_file.h"

namespace relumine::app {

namespace {

std::string base64(const std::vector<std::byte>& bytes) {
    static constexpr std::string_view Letters =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k)
            three = three << 8u |
                    (i + k < bytes.size() ? std::to_integer<std::uint32_t>(bytes[i + k]) : 0u);
        const std::size_t num = std::min<std::size_t>(bytes.size() - i, 3);
        for (std::size_t k = 0; k < 4; ++k)
            text += k <= num ? Letters[three >> (18 - 6 * k) & 63u] : '=';
    }
    return text;
}

std::string text_of(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

void replace(std::string& text, std::string_view place, std::string_view with) {
    const std::size_t at = text.find(place);
    if (at == std::string::npos)
        throw std::runtime_error(fmt::format("index.html: expected {} in the page", place));
    text.replace(at, place.size(), with);
}

std::string escaped(std::string_view text) {
    std::string result;
    for (const char letter : text)
        switch (letter) {
        case '&':
            result += "&amp;";
            break;
        case '<':
            result += "&lt;";
            break;
        default:
            result += letter;
        }
    return result;
}

const WebFile& part(const WebFiles& parts, std::string_view name) {
    for (const WebFile& file : parts)
        if (file.name == name)
            return file;
    throw std::runtime_error(fmt::format("the page's parts have no {}", name));
}

} // namespace

std::uint64_t size_of(const WebFiles& files) {
    std::uint64_t size = 0;
    for (const WebFile& file : files)
        size += file.bytes.size();
    return size;
}

std::vector<std::byte> bytes_of(std::string_view text) {
    const auto* const first = reinterpret_cast<const std::byte*>(text.data());
    return {first, first + text.size()};
}

std::vector<std::byte>
bytes_written(std::string_view name,
              const std::function<void(const std::filesystem::path& path)>& write) {
    struct Scratch {
        std::filesystem::path path;
        ~Scratch() {
            std::error_code error;
            std::filesystem::remove(path, error);
        }
    };
    const Scratch file{std::filesystem::temp_directory_path() /
                       fmt::format("relumine_web_{}_{}", ::getpid(), name)};
    write(file.path);
    return files::read(file.path);
}

std::string folder_page(const WebFiles& parts, const std::string& title) {
    std::string page = text_of(part(parts, PageTemplate).bytes);
    replace(page, "{{title}}", escaped(title));
    replace(page, "{{assets}}\n", "");
    replace(page, "{{script}}",
            fmt::format("<script type=\"module\" src=\"{}\"></script>", PageScript));
    return page;
}

std::string single_page(const WebFiles& parts, const WebFiles& scene, const std::string& title) {
    std::string page = text_of(part(parts, PageTemplate).bytes);
    std::string assets;
    const auto add = [&assets](const WebFile& file) {
        assets += fmt::format("<script type=\"text/plain\" data-relumine-file=\"{}\">{}</script>\n",
                              file.name, base64(file.bytes));
    };
    add(part(parts, PageRuntime));
    for (const WebFile& file : scene)
        add(file);
    std::string script = text_of(part(parts, PageScript).bytes);
    for (std::size_t at = 0; (at = script.find("</script", at)) != std::string::npos; at += 2)
        script.insert(at + 1, "\\");
    replace(page, "{{title}}", escaped(title));
    replace(page, "{{script}}", "<script type=\"module\">\n" + script + "\n</script>");
    replace(page, "{{assets}}\n", assets);
    return page;
}

void check_folder(const std::filesystem::path& folder) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(folder, error);
    if (!std::filesystem::exists(status))
        return;
    if (!std::filesystem::is_directory(status))
        throw std::runtime_error(fmt::format("{}: expected a folder", folder.string()));
    const bool has_page = std::filesystem::exists(folder / "index.html") &&
                          std::filesystem::exists(folder / "scene.json");
    if (!has_page && !std::filesystem::is_empty(folder))
        throw std::runtime_error(fmt::format(
            "{}: expected an empty folder, or one with a page, got other files", folder.string()));
}

void write_folder(const std::filesystem::path& folder, const WebFiles& files) {
    for (const WebFile& file : files) {
        const std::filesystem::path path = folder / file.name;
        files::make_folder(path.parent_path());
        files::OutputFile output(path);
        output.write(file.bytes);
        output.commit();
    }
}

} // namespace relumine::app
