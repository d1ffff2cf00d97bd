#include "mesh/formats/gltf_left_out.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "files/counted.h"
#include "mesh/formats/gltf_materials.h"
#include "mesh/formats/gltf_variants.h"
#include "mesh/formats/polygon_soup.h"
#include "mesh/text_reader.h"

namespace relumine::mesh::gltf {

namespace {

/// Those that are read.
constexpr std::array<std::string_view, 14> ReadExtensions = {"KHR_materials_anisotropy",
                                                             "KHR_materials_clearcoat",
                                                             "KHR_materials_diffuse_transmission",
                                                             "KHR_materials_dispersion",
                                                             "KHR_materials_emissive_strength",
                                                             "KHR_materials_ior",
                                                             "KHR_materials_iridescence",
                                                             "KHR_materials_pbrSpecularGlossiness",
                                                             "KHR_materials_sheen",
                                                             "KHR_materials_specular",
                                                             "KHR_materials_transmission",
                                                             "KHR_materials_unlit",
                                                             "KHR_materials_volume",
                                                             "KHR_materials_volume_scatter"};

/// Everything that glTF 2.0 gives a material and a texture of it.
constexpr std::array<std::string_view, 11> MaterialProperties = {
    "name",           "extras",      "extensions",       "pbrMetallicRoughness",
    "normalTexture",  "alphaCutoff", "occlusionTexture", "emissiveTexture",
    "emissiveFactor", "alphaMode",   "doubleSided"};

class LeftOut {
public:
    LeftOut(const Document& document, const GltfOptions& options)
        : document_(document), options_(options) {}
    std::vector<std::string> lines();

private:
    void material(const Json& description);
    void material_extensions(const Json& extensions);
    void texture(const Json& info);
    void primitives();
    void scenes();
    void count(const std::string& kind, std::string_view loss);

    const Document& document_;
    const GltfOptions& options_;
    /// How many materials have each kind, what is lost, in the order they were met.
    std::vector<std::string> order_;
    std::map<std::string, std::pair<std::size_t, std::string>> kinds_;
    std::set<std::string> of_this_material_;
    std::vector<std::string> lines_;
};

void LeftOut::count(const std::string& kind, std::string_view loss) {
    if (!of_this_material_.insert(kind).second)
        return;
    const auto [place, is_new] = kinds_.try_emplace(kind, 0, loss);
    if (is_new)
        order_.push_back(kind);
    ++place->second.first;
}

void LeftOut::texture(const Json& info) {
    for (const auto& [name, value] : child(info, "extensions").members())
        if (name != "KHR_texture_transform")
            count("with " + excerpt(name) + " of a texture, which is not read",
                  "what it describes is left out");
    if (!info.find("index"))
        return;
    const Json& texture = document_.element("textures", whole(info, "index"));
    constexpr std::uint64_t Nearest = 9728;
    if (texture.find("sampler") &&
        whole(document_.element("samplers", whole(texture, "sampler")), "magFilter", 0) == Nearest)
        count("with textures of hard pixels (NEAREST), which are not kept",
              "they are sampled bilinearly");
}

void LeftOut::material_extensions(const Json& extensions) {
    for (const auto& [name, value] : extensions.members()) {
        if (std::find(ReadExtensions.begin(), ReadExtensions.end(), name) == ReadExtensions.end())
            count("with " + excerpt(name) + ", which is not read", "what it describes is left out");
    }
}

void LeftOut::material(const Json& description) {
    of_this_material_.clear();
    const Json& extensions = child(description, "extensions");
    const Json& volume = child(extensions, "KHR_materials_volume");
    const bool milky = is_milky(description);
    if (extensions.find("KHR_materials_volume_scatter"))
        count("with KHR_materials_volume_scatter, a draft",
              milky ? "light comes out where it goes in" : "bodies are clear inside, not milky");
    if (!milky &&
        number(child(extensions, "KHR_materials_transmission"), "transmissionFactor", 0.0) > 0.0)
        count("of glass (KHR_materials_transmission)",
              "light goes straight on and its shadows are grey; pictures of vertices refract");
    if (volume.find("thicknessTexture"))
        count("with a texture of thickness, which is not read", "the factor counts everywhere");
    if (description.find("occlusionTexture"))
        count("with an occlusion map, which is not read", "rays find what blocks the light");
    for (const auto& [name, value] : description.members())
        if (std::find(MaterialProperties.begin(), MaterialProperties.end(), name) ==
            MaterialProperties.end())
            count("with the property " + excerpt(name) + ", which glTF does not have",
                  "it is left out");
    material_extensions(child(description, "extensions"));
    const Json& pbr = child(description, "pbrMetallicRoughness");
    const Json& old = child(extensions, "KHR_materials_pbrSpecularGlossiness");
    const Json& specular = child(extensions, "KHR_materials_specular");
    const Json& coat = child(extensions, "KHR_materials_clearcoat");
    const Json& sheen = child(extensions, "KHR_materials_sheen");
    const Json& film = child(extensions, "KHR_materials_iridescence");
    const Json& stretched = child(extensions, "KHR_materials_anisotropy");
    const Json& diffuse = child(extensions, "KHR_materials_diffuse_transmission");
    const Json& milk = child(extensions, "KHR_materials_volume_scatter");
    for (const auto& [parent, key] : {std::pair{&pbr, "baseColorTexture"},
                                      {&pbr, "metallicRoughnessTexture"},
                                      {&old, "diffuseTexture"},
                                      {&old, "specularGlossinessTexture"},
                                      {&description, "emissiveTexture"},
                                      {&description, "normalTexture"},
                                      {&specular, "specularTexture"},
                                      {&specular, "specularColorTexture"},
                                      {&coat, "clearcoatTexture"},
                                      {&coat, "clearcoatRoughnessTexture"},
                                      {&coat, "clearcoatNormalTexture"},
                                      {&sheen, "sheenColorTexture"},
                                      {&sheen, "sheenRoughnessTexture"},
                                      {&film, "iridescenceTexture"},
                                      {&film, "iridescenceThicknessTexture"},
                                      {&stretched, "anisotropyTexture"},
                                      {&diffuse, "diffuseTransmissionTexture"},
                                      {&diffuse, "diffuseTransmissionColorTexture"},
                                      {&milk, "multiscatterColorTexture"}})
        texture(child(*parent, key));
}

void LeftOut::primitives() {
    std::size_t num_others = 0, num_colored = 0, num_targets = 0;
    for (std::size_t i = 0; i < document_.count("meshes"); ++i)
        for (const Json& primitive : items(document_.element("meshes", i), "primitives")) {
            num_others += whole(primitive, "mode", 4) < 4 ? 1 : 0;
            num_colored += child(primitive, "attributes").find("COLOR_1") != nullptr ? 1 : 0;
            for (const Json& target : items(primitive, "targets"))
                for (const auto& [name, accessor] : target.members())
                    num_targets += name.starts_with("TEXCOORD_") || name.starts_with("COLOR_");
        }
    if (num_others > 0)
        lines_.push_back(fmt::format("{} of points or lines: only triangles are read",
                                     files::counted(num_others, "primitive")));
    if (num_colored > 0)
        lines_.push_back(fmt::format("{} with a second set of colours: the first is read",
                                     files::counted(num_colored, "primitive")));
    if (num_targets > 0)
        lines_.push_back("morph targets of colours and uvs: only shapes are read");
}

void LeftOut::scenes() {
    if (const std::size_t count = document_.count("scenes"); count > 1)
        lines_.push_back(fmt::format("{} of {} scenes: the default one is read", count - 1, count));
    if (const std::size_t count = document_.count("animations"); count > 0 && !options_.pose)
        lines_.push_back(fmt::format("{}: nodes stand as they are; --pose ANIMATION@SECONDS "
                                     "chooses a moment",
                                     files::counted(count, "animation")));
    if (const std::size_t count = variants(document_).size(); count > 0 && !options_.variant)
        lines_.push_back(fmt::format("{} of materials: surfaces have their own; --variant NAME "
                                     "chooses one, info lists them",
                                     files::counted(count, "variant")));
}

std::vector<std::string> LeftOut::lines() {
    for (std::size_t i = 0; i < document_.count("materials"); ++i)
        try {
            material(document_.element("materials", i));
        } catch (const std::runtime_error&) { // read_materials() names it
        }
    for (const std::string& kind : order_) {
        const auto& [number, loss] = kinds_.at(kind);
        lines_.push_back(fmt::format("{} {}: {}", files::counted(number, "material"), kind, loss));
    }
    primitives();
    scenes();
    return std::move(lines_);
}

} // namespace

std::vector<std::string> left_out(const Document& document, const GltfOptions& options) {
    return LeftOut(document, options).lines();
}

bool is_of_materials(std::string_view extension) {
    return (extension.starts_with("KHR_materials_") || extension.starts_with("EXT_materials_")) &&
           extension != "KHR_materials_variants";
}

} // namespace relumine::mesh::gltf
