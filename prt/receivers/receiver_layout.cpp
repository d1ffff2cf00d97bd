#include "prt/receivers/receiver_layout.h"

#include <stdexcept>

#include <fmt/format.h>

namespace relumine::prt {

namespace {

PlaceGrid grid_of(const ReceiverLayout& layout) {
    return std::visit([](const auto& own) { return own.grid(); }, layout);
}

} // namespace

const ReceiverKind& kind_of(const ReceiverLayout& layout) {
    return *std::visit([]<typename Layout>(const Layout&) { return &Layout::Kind; }, layout);
}

bool on_vertices(const ReceiverLayout& layout) {
    return kind_of(layout).are_vertices;
}

std::string description(const ReceiverLayout& layout) {
    if (const auto* points = std::get_if<PointLayout>(&layout))
        return fmt::format("{} {}", points->Kind.name, points->count);
    if (const auto* box = std::get_if<GridLayout>(&layout))
        return fmt::format("{} {} x {} x {}", box->Kind.name, box->nx, box->ny, box->nz);
    const auto [width, height, n] = grid_of(layout);
    std::string text(kind_of(layout).name);
    if (width != 0 || height != 0)
        text += fmt::format(" {} x {}", width, height);
    return n == 1 ? text : fmt::format("{}, {} x {} samples each", text, n, n);
}

std::size_t num_places(const ReceiverLayout& layout) {
    const auto [width, height, n] = grid_of(layout);
    return std::size_t{width} * height * n * n;
}

std::span<const std::uint32_t> places(const ReceiverLayout& layout) {
    // Only read.
    const std::vector<std::uint32_t>* found =
        std::visit([](auto& own) { return own.places(); }, const_cast<ReceiverLayout&>(layout));
    return found == nullptr ? std::span<const std::uint32_t>() : *found;
}

const Camera* own_camera(const ReceiverLayout& layout) {
    return std::visit([](const auto& own) { return own.own_camera(); }, layout);
}

void check_size(const ReceiverLayout& layout) {
    const auto [width, height, n] = grid_of(layout);
    const Camera* camera = own_camera(layout);
    const Camera any{.eye = {0.0f, 0.0f, 1.0f}, .target = {0.0f, 0.0f, 0.0f}};
    // Throws for sizes out of bounds, and for a camera without a direction.
    static_cast<void>(PictureRays(camera == nullptr ? any : *camera, width, height, n));
    if (num_places(layout) > MaxLayoutPlaces)
        throw std::invalid_argument(
            fmt::format("expected at most {} places, got {}", MaxLayoutPlaces, num_places(layout)));
}

} // namespace relumine::prt
