#include "mesh/formats/gltf_pointers.h"

#include <algorithm>
#include <utility>

namespace relumine::mesh::gltf {

namespace {

using files::Json;

/// Returns the names between the strokes of a pointer, "~1" as "/" and "~0" as "~".
std::vector<std::string> parts_of(std::string_view pointer) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < pointer.size(); ++i) {
        const bool is_escaped = pointer[i] == '~' && i + 1 < pointer.size();
        if (pointer[i] == '/')
            parts.emplace_back();
        else if (parts.empty())
            return {}; // it begins with no stroke
        else
            parts.back() += !is_escaped ? pointer[i] : pointer[++i] == '1' ? '/' : '~';
    }
    return parts;
}

} // namespace

void Changes::add(std::string_view pointer, Json value) {
    const std::vector<std::string> parts = parts_of(pointer);
    // No file nests deeper (files::parse_json()).
    constexpr std::size_t Deepest = 100;
    if (parts.empty() || parts.size() > Deepest) {
        lost_.emplace_back(pointer);
        return;
    }
    Changes* place = this;
    for (const std::string& part : parts)
        place = &place->members_[part];
    place->value_ = std::move(value);
}

Json Changes::applied(const Json& tree, std::vector<std::string>& lost) const {
    lost.insert(lost.end(), lost_.begin(), lost_.end());
    return changed(tree, "", lost);
}

Json Changes::changed(const Json& tree, const std::string& path,
                      std::vector<std::string>& lost) const {
    if (value_)
        return *value_;
    if (tree.type() == Json::Type::Array) {
        Json::Array values;
        for (std::size_t i = 0; i < tree.size(); ++i) {
            const auto found = members_.find(std::to_string(i));
            values.push_back(
                found == members_.end()
                    ? tree.values()[i]
                    : found->second.changed(tree.values()[i], path + "/" + found->first, lost));
        }
        for (const auto& [name, change] : members_) {
            const bool is_there = !name.empty() && name.size() < 10 &&
                                  (name == "0" || name.front() != '0') &&
                                  name.find_first_not_of("0123456789") == std::string::npos &&
                                  std::stoull(name) < values.size();
            if (!is_there)
                change.lose(path + "/" + name, lost);
        }
        return values;
    }
    if (tree.type() != Json::Type::Object) {
        lose(path, lost);
        return tree;
    }
    Json::Object members;
    for (const auto& [name, member] : tree.members()) {
        const auto found = members_.find(name);
        members.emplace_back(name, found == members_.end()
                                       ? member
                                       : found->second.changed(member, path + "/" + name, lost));
    }
    for (const auto& [name, change] : members_) {
        if (tree.find(name) != nullptr)
            continue;
        if (change.value_ || name == "pbrMetallicRoughness")
            members.emplace_back(name, change.changed(Json::Object{}, path + "/" + name, lost));
        else
            change.lose(path + "/" + name, lost);
    }
    return members;
}

void Changes::lose(const std::string& path, std::vector<std::string>& lost) const {
    if (value_)
        lost.push_back(path);
    for (const auto& [name, change] : members_)
        change.lose(path + "/" + name, lost);
}

} // namespace relumine::mesh::gltf
