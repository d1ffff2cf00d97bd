#include "relumine/light/gathered.h"

#include <cstring>
#include <stdexcept>

#include "prt/clusters/dealt_tiles.h"

namespace relumine {

std::vector<glm::vec3> gathered(prt::Team& team, std::span<const std::uint32_t> order,
                                std::span<const glm::vec3> own, std::size_t width) {
    const std::vector<std::vector<std::byte>> of_all = team.gather(prt::to_send(own));
    const std::size_t bytes = width * sizeof(glm::vec3);
    std::vector<glm::vec3> values(of_all.empty() ? 0 : order.size() * width);
    for (std::uint32_t process = 0; process < of_all.size(); ++process) {
        const std::vector<std::uint32_t> places =
            prt::places_of({process, team.part().count}, order.size());
        if (of_all[process].size() != places.size() * bytes)
            throw std::runtime_error("expected the light of all receivers");
        for (std::size_t i = 0; i < places.size(); ++i)
            std::memcpy(&values[order[places[i]] * width], of_all[process].data() + i * bytes,
                        bytes);
    }
    return values;
}

} // namespace relumine
