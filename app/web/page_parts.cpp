#include "app/web/page_parts.h"

#include <cstdlib>
#include <stdexcept>
#include <system_error>

#include "files/output_file.h"

namespace relumine::app {

std::vector<std::filesystem::path> page_part_folders() {
    std::vector<std::filesystem::path> folders;
    if (const char* const named = std::getenv("RELUMINE_WEB"))
        return {named};
    std::error_code error;
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
    if (!error) {
        const std::filesystem::path above = program.parent_path().parent_path();
        // Of an install, a build folder, and a wheel.
        folders = {above / "share/relumine/web/page", above / "web/page",
                   above / "relumine/web/page"};
    }
    return folders;
}

WebFiles find_page_parts() {
    for (const std::filesystem::path& folder : page_part_folders()) {
        if (!std::filesystem::exists(folder / PageScript))
            continue;
        WebFiles parts;
        for (const std::string_view name : {PageTemplate, PageScript, PageRuntime, PageLicense})
            parts.push_back({std::string(name), files::read(folder / name)});
        return parts;
    }
    throw std::runtime_error("export web: the page's parts are not installed; `./dev web` builds "
                             "them, RELUMINE_WEB names their folder");
}

} // namespace relumine::app
