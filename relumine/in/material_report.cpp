#include "relumine/in/material_report.h"

#include <concepts>
#include <optional>
#include <type_traits>
#include <variant>

#include "mesh/materials/material_members.h"

namespace relumine {

files::Json report_of(const mesh::TriangleMesh& mesh, const mesh::Material& material) {
    using Model = mesh::MaterialModel;
    const Model model = material.model;
    files::Json result = {{"name", material.name},
                          {"model", model == Model::Phong               ? "phong"
                                    : model == Model::MetallicRoughness ? "metallic-roughness"
                                    : model == Model::Unlit             ? "unlit"
                                    : model == Model::Measured          ? "measured"
                                                                        : "specular-glossiness"}};
    for (const mesh::MaterialMember& member : mesh::MaterialMembers)
        if (member.stands(material, member.in_report))
            std::visit(
                [&]<typename Value>(Value mesh::Material::* at) {
                    const Value& value = material.*at;
                    if constexpr (std::same_as<Value, std::optional<mesh::TextureSlot>>)
                        result.set(member.name,
                                   value ? files::Json(mesh.textures[value->texture].name)
                                         : files::Json());
                    else if constexpr (!std::is_enum_v<Value>)
                        result.set(member.name, value);
                },
                member.at);
    return result;
}

} // namespace relumine
