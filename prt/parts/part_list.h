// All parts of a whole, each once.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "files/json.h"
#include "prt/scene/json_members.h"
#include "prt/scene/section_reader.h"
#include "prt/team.h"

namespace relumine::prt {

/// What the file of a part says of itself.
struct PartHead {
    Part part = {};
    /// The same in all parts that belong together.
    std::string whole = {};
    std::uint32_t num_receivers = 0;
};

/// Returns the JSON of a head. `whole_name` is what it is a part of.
inline files::Json json_of(const PartHead& head, const std::string& whole_name) {
    return {{"index", head.part.index},
            {"count", head.part.count},
            {"receivers", head.num_receivers},
            {whole_name, head.whole}};
}

/// Reads a head.
///
/// Throws:  as SectionReader.
inline PartHead read_head(const SectionReader& reader, const std::string& section,
                          const std::string& whole_name) {
    const files::Json json = reader.json(section);
    PartHead head;
    try {
        head = {.part = {.index = natural(json.at("index")), .count = natural(json.at("count"))},
                .whole = json.at(whole_name).string(),
                .num_receivers = natural(json.at("receivers"))};
        if (head.part.index >= head.part.count || head.part.count > MaxParts)
            throw std::out_of_range("expected an index below the count");
    } catch (const std::exception&) {
        reader.fail(section, "JSON with the place of the part");
    }
    return head;
}

/// Reads files by read(path), which returns a value with a `head`. Returns them by index.
/// `whole_name` is what they are parts of.
///
/// Throws:  std::runtime_error that names a part that is of another whole or number of parts, given
///          twice or missing; as read() does.
template<typename Read>
auto all_parts_of(const std::string& whole_name, std::span<const std::filesystem::path> paths,
                  const Read& read) {
    using Stored = decltype(read(paths[0]));
    std::vector<std::optional<Stored>> parts;
    std::vector<std::filesystem::path> path_of;
    std::string whole;
    const auto refuse = [](const std::filesystem::path& path, const std::string& expected,
                           const std::string& got) {
        throw std::runtime_error(
            fmt::format("{}: expected {}, got {}", path.string(), expected, got));
    };
    for (const std::filesystem::path& path : paths) {
        Stored stored = read(path);
        const Part part = stored.head.part;
        if (parts.empty()) {
            parts.resize(part.count);
            path_of.resize(part.count);
            whole = stored.head.whole;
        }
        if (stored.head.whole != whole)
            refuse(path, fmt::format("a part of the same {} as {}", whole_name, paths[0].string()),
                   fmt::format("another {}'s", whole_name));
        if (part.count != parts.size())
            refuse(path, fmt::format("one of {} parts as {}", parts.size(), paths[0].string()),
                   fmt::format("one of {}", part.count));
        if (parts[part.index])
            refuse(path, "every part once",
                   fmt::format("part {} of {} again, after {}", part.index + 1, part.count,
                               path_of[part.index].string()));
        parts[part.index] = std::move(stored);
        path_of[part.index] = path;
    }
    if (parts.empty())
        throw std::runtime_error("expected parts, got none");
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (!parts[i])
            throw std::runtime_error(fmt::format("expected all {0} parts, got none that is part "
                                                 "{1} of {0}",
                                                 parts.size(), i + 1));
    return parts;
}

} // namespace relumine::prt
