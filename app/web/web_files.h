// The files of an exported page: a folder of them, or one file with all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace relumine::app {

struct WebFile {
    /// With '/' between folders
    std::string name;
    std::vector<std::byte> bytes;
};

using WebFiles = std::vector<WebFile>;

[[nodiscard]] std::uint64_t size_of(const WebFiles& files);
[[nodiscard]] std::vector<std::byte> bytes_of(std::string_view text);

/// Returns what `write` puts into the file whose path it gets: one of its own in the system's
/// folder for such, gone afterwards.
[[nodiscard]] std::vector<std::byte>
bytes_written(std::string_view name,
              const std::function<void(const std::filesystem::path& path)>& write);

/// Returns the page with the places of its template filled: {{title}}, {{assets}}, {{script}}.
///
/// A folder's page loads its script and its files; a single file has them within. `parts` are those
/// of find_page_parts().
[[nodiscard]] std::string folder_page(const WebFiles& parts, const std::string& title);
[[nodiscard]] std::string single_page(const WebFiles& parts, const WebFiles& scene,
                                      const std::string& title);

/// Writes files into a folder, each whole or not at all.
///
/// Throws:  std::runtime_error naming the path.
void write_folder(const std::filesystem::path& folder, const WebFiles& files);

/// Throws std::runtime_error unless the folder may be written to: it is absent, empty, or has a
/// page already.
void check_folder(const std::filesystem::path& folder);

} // namespace relumine::app
