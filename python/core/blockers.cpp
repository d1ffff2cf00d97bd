#include "blockers.h"

#include <bit>
#include <utility>
#include <vector>

#include "arrays.h"

namespace relumine::python {

namespace {

class FunctionBlockers final : public prt::Blockers {
public:
    explicit FunctionBlockers(py::object function) : function_(std::move(function)) {}
    FunctionBlockers(const FunctionBlockers&) = delete;
    FunctionBlockers& operator=(const FunctionBlockers&) = delete;
    ~FunctionBlockers() override {
        const py::gil_scoped_acquire lock;
        function_ = py::object();
    }

    [[nodiscard]] std::uint32_t occluded(const glm::vec3& origin,
                                         const prt::DirectionPacket& directions,
                                         std::uint32_t active) const override {
        Rays rays;
        for (std::uint32_t bits = active; bits != 0; bits &= bits - 1)
            rays.add(origin,
                     directions.direction(static_cast<std::size_t>(std::countr_zero(bits))));
        const std::vector<bool> blocked = ask(std::move(rays));
        std::uint32_t result = 0;
        auto answer = blocked.begin();
        for (std::uint32_t bits = active; bits != 0; bits &= bits - 1, ++answer)
            if (*answer)
                result |= bits & (~bits + 1);
        return result;
    }

    /// All rays of the receivers in one call: up to 8,192.
    void clear_blocked(const prt::ReceiverGroup& group, const prt::DirectionPatch& patch,
                       std::span<std::uint64_t> rays) const override {
        Rays asked;
        for (std::size_t i = 0; i < rays.size(); ++i)
            for (std::uint64_t bits = rays[i]; bits != 0; bits &= bits - 1)
                asked.add(group.origins[i],
                          patch.direction(static_cast<std::size_t>(std::countr_zero(bits))));
        const std::vector<bool> blocked = ask(std::move(asked));
        auto answer = blocked.begin();
        for (std::uint64_t& of_receiver : rays)
            for (std::uint64_t bits = of_receiver; bits != 0; bits &= bits - 1, ++answer)
                if (*answer)
                    of_receiver &= ~(bits & (~bits + 1));
    }

private:
    struct Rays {
        std::vector<glm::vec3> origins, directions;

        void add(const glm::vec3& origin, const glm::vec3& direction) {
            origins.push_back(origin);
            directions.push_back(direction);
        }
    };

    [[nodiscard]] std::vector<bool> ask(Rays rays) const {
        const std::size_t count = rays.origins.size();
        if (count == 0)
            return {};
        const py::gil_scoped_acquire lock;
        const auto answer =
            function_(owned(std::move(rays.origins)), owned(std::move(rays.directions)))
                .cast<py::buffer>();
        const py::buffer_info info = answer.request();
        if (info.itemsize != 1 || info.size != static_cast<py::ssize_t>(count))
            throw py::value_error("expected a byte for each ray");
        const auto* bytes = static_cast<const std::uint8_t*>(info.ptr);
        return std::vector<bool>(bytes, bytes + count);
    }

    py::object function_;
};

} // namespace

std::shared_ptr<const prt::Blockers> blockers_of(const py::object& function) {
    return function.is_none() ? nullptr : std::make_shared<const FunctionBlockers>(function);
}

} // namespace relumine::python
