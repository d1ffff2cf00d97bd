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
    const auto* pixels = std::get_if<PixelLayout>(&layout);
    const bool at_edges = pixels != nullptr && !pixels->shares.empty();
    return n == 1
               ? text
               : fmt::format("{}, {} x {} samples {}", text, n, n, at_edges ? "at edges" : "each");
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

std::size_t num_places_taken(const ReceiverLayout& layout) {
    const auto* pixels = std::get_if<PixelLayout>(&layout);
    if (pixels == nullptr)
        return places(layout).size();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < pixels->samples.size(); ++i)
        if (i == 0 || pixels->samples[i] != pixels->samples[i - 1]) // the first layer
            sum += pixels->num_shown(i);
    return sum;
}

bool PixelLayout::have_shares_that_fit() const {
    if (shares.empty())
        return true;
    if (samples_per_axis != EdgeSamplesPerAxis || shares.size() != samples.size())
        return false;
    unsigned taken = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const unsigned own = shares[i];
        if (own == 0 ||
            static_cast<std::uint32_t>(std::countr_zero(own)) != samples[i] % EdgeSamples)
            return false;
        const bool same_pixel = i > 0 && samples[i] / EdgeSamples == samples[i - 1] / EdgeSamples;
        if (i > 0 && samples[i] == samples[i - 1]) {
            if (own != shares[i - 1])
                return false;
            continue;
        }
        taken = same_pixel ? taken : 0;
        if ((taken & own) != 0)
            return false;
        taken |= own;
    }
    return true;
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
