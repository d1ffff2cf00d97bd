#include "prt/parts/part_check.h"

#include <stdexcept>

#include "prt/parts/part_list.h"
#include "prt/scene/section_reader.h"

namespace relumine::prt {

PartCheck check_parts(std::span<const std::filesystem::path> paths) {
    PartCheck check;
    PartList list;
    for (const std::filesystem::path& path : paths)
        try {
            const SectionReader reader(path);
            require_part(reader);
            const std::string whole_name = reader.has("lit") ? "light" : "plan";
            list.add(path, read_head(reader, "part", whole_name), whole_name);
        } catch (const std::runtime_error& error) {
            check.faults.emplace_back(error.what());
        }
    check.num_parts = list.count();
    check.missing = list.missing();
    return check;
}

} // namespace relumine::prt
