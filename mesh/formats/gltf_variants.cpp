#include "mesh/formats/gltf_variants.h"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "files/joined.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

std::vector<std::string> variants(const Document& document) {
    std::vector<std::string> names;
    for (const Json& variant :
         items(child(child(document.root(), "extensions"), "KHR_materials_variants"), "variants"))
        names.push_back(text(variant, "name"));
    return names;
}

std::uint64_t variant(const Document& document, const std::string& name) {
    const std::vector<std::string> names = variants(document);
    const auto found = std::find(names.begin(), names.end(), name);
    if (found != names.end())
        return static_cast<std::uint64_t>(found - names.begin());
    constexpr std::size_t MostNames = 32;
    std::vector<std::string> excerpts;
    for (std::size_t i = 0; i < std::min(names.size(), MostNames); ++i)
        excerpts.push_back(excerpt(names[i]));
    if (names.size() > MostNames)
        excerpts.emplace_back("...");
    throw std::runtime_error(fmt::format(
        "expected a variant of the file ({}), got {}",
        names.empty() ? "which has none" : files::joined(excerpts, ", "), excerpt(name)));
}

} // namespace relumine::mesh::gltf
