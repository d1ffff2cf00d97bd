// Values that an animation gives to any properties of a glTF file: KHR_animation_pointer.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "files/json.h"

namespace relumine::mesh::gltf {

/// New values of properties in a tree of JSON.
class Changes {
public:
    /// Gives a value to the property at a JSON pointer [RFC 6901]: "/materials/0/alphaCutoff".
    void add(std::string_view pointer, files::Json value);

    [[nodiscard]] bool empty() const { return members_.empty() && lost_.empty(); }

    /// Returns the tree with the new values. Adds the pointers that lead nowhere to `lost`: only
    /// the last member of a pointer may be absent, whose default then counts in the file, and
    /// pbrMetallicRoughness.
    [[nodiscard]] files::Json applied(const files::Json& tree,
                                      std::vector<std::string>& lost) const;

private:
    [[nodiscard]] files::Json changed(const files::Json& tree, const std::string& path,
                                      std::vector<std::string>& lost) const;
    void lose(const std::string& path, std::vector<std::string>& lost) const;

    std::map<std::string, Changes> members_;
    std::optional<files::Json> value_;
    /// Pointers that lead nowhere in any tree.
    std::vector<std::string> lost_;
};

} // namespace relumine::mesh::gltf
