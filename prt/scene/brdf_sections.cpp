#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "prt/scene/brdf_tables.h"
#include "prt/scene/section_group.h"

namespace relumine::prt {

namespace {

const std::string TablesSection = "brdf_tables";

void add_brdf_tables(NewSections& sections, const Scene& scene) {
    std::vector<float> values;
    for (const auto& table : brdf_tables(scene)) {
        const std::vector<float> own = table->values();
        values.insert(values.end(), own.begin(), own.end());
    }
    if (!values.empty())
        sections[TablesSection] = bytes_of(values);
}

void read_brdf_tables(const SectionReader& reader, Scene& scene) {
    if (!reader.has(TablesSection))
        return;
    constexpr std::size_t Size = 3 * mesh::BrdfTable::NumPlaces;
    const std::vector<float> values = reader.elements<float>(TablesSection);
    if (values.size() % Size != 0)
        reader.fail(TablesSection, fmt::format("tables of {} numbers", Size));
    try {
        for (std::size_t i = 0; i < values.size(); i += Size)
            scene.brdfs.push_back(std::make_shared<const mesh::BrdfTable>(
                std::vector<float>(values.data() + i, values.data() + i + Size)));
    } catch (const std::invalid_argument&) {
        reader.fail(TablesSection, "BRDFs that reflect at most what arrives");
    }
}

} // namespace

const SectionGroup BrdfSections = {.add = add_brdf_tables, .read = read_brdf_tables};

BrdfTables brdf_tables(const Scene& scene) {
    BrdfTables tables;
    const auto add = [&tables](const std::shared_ptr<const mesh::BrdfTable>& table) {
        if (table && std::find(tables.begin(), tables.end(), table) == tables.end())
            tables.push_back(table);
    };
    for (const mesh::Material& material : scene.mesh.materials)
        add(material.measured);
    for (const Surface& surface : scene.receivers.surfaces)
        add(surface.table);
    return tables;
}

} // namespace relumine::prt
