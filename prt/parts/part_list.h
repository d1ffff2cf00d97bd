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
    /// Text that names the whole: one for all parts that belong together.
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

/// Throws:  std::runtime_error that says what the file is, unless it is a part.
inline void require_part(const SectionReader& reader) {
    if (!reader.has("part"))
        throw std::runtime_error(fmt::format("{}: expected a part, got {}", reader.path().string(),
                                             reader.has("plan") ? "a plan" : "a scene"));
}

/// Reads a head.
///
/// Throws:  as SectionReader.
inline PartHead read_head(const SectionReader& reader, const std::string& section,
                          const std::string& whole_name) {
    if (whole_name == "plan" && reader.has("lit"))
        throw std::runtime_error(fmt::format(
            "{}: expected a part of a scene, got a part of its light, which is joined to a .npy",
            reader.path().string()));
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

/// Which parts of a whole are there. The first one says what the whole is.
class PartList {
public:
    /// Takes a part. `whole_name` is what it is a part of.
    ///
    /// Throws:  std::runtime_error that names a part that is of another whole or number of parts,
    ///          or given twice; nothing has changed then.
    void add(const std::filesystem::path& path, const PartHead& head,
             const std::string& whole_name) {
        if (paths_.empty()) {
            paths_.resize(head.part.count);
            first_ = path;
            whole_ = head.whole;
        }
        const auto refuse = [&](const std::string& expected, const std::string& got) {
            throw std::runtime_error(
                fmt::format("{}: expected {}, got {}", path.string(), expected, got));
        };
        if (head.whole != whole_)
            refuse(fmt::format("a part of the same {} as {}", whole_name, first_.string()),
                   fmt::format("another {}'s", whole_name));
        if (head.part.count != paths_.size())
            refuse(fmt::format("one of {} parts as {}", paths_.size(), first_.string()),
                   fmt::format("one of {}", head.part.count));
        std::filesystem::path& own = paths_[head.part.index];
        if (!own.empty())
            refuse("every part once",
                   fmt::format("part {} of {} again, after {}", head.part.index + 1, paths_.size(),
                               own.string()));
        own = path;
    }

    /// 0 before the first part.
    [[nodiscard]] std::size_t count() const { return paths_.size(); }
    /// Returns the indices of the parts that are not there.
    [[nodiscard]] std::vector<std::uint32_t> missing() const {
        std::vector<std::uint32_t> result;
        for (std::uint32_t i = 0; i < paths_.size(); ++i)
            if (paths_[i].empty())
                result.push_back(i);
        return result;
    }

private:
    /// By index; empty for a part that is not there.
    std::vector<std::filesystem::path> paths_;
    std::filesystem::path first_;
    std::string whole_;
};

/// Reads files by read(path), which returns a value with a `head`. Returns them by index.
/// `whole_name` is what they are parts of.
///
/// Throws:  as PartList::add() and read() do; std::runtime_error that names a part that is missing.
template<typename Read>
auto all_parts_of(const std::string& whole_name, std::span<const std::filesystem::path> paths,
                  const Read& read) {
    std::vector<std::optional<decltype(read(paths[0]))>> parts;
    PartList list;
    for (const std::filesystem::path& path : paths) {
        auto stored = read(path);
        list.add(path, stored.head, whole_name);
        parts.resize(list.count());
        parts[stored.head.part.index] = std::move(stored);
    }
    if (parts.empty())
        throw std::runtime_error("expected parts, got none");
    if (const std::vector<std::uint32_t> missing = list.missing(); !missing.empty())
        throw std::runtime_error(fmt::format("expected all {0} parts, got none that is part {1} of "
                                             "{0}",
                                             parts.size(), missing.front() + 1));
    return parts;
}

} // namespace relumine::prt
