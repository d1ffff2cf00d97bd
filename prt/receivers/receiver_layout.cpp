#include "prt/receivers/receiver_layout.h"

#include <stdexcept>

#include <fmt/format.h>

namespace relumine::prt {

namespace {

/// Before anything is done with a size: sizes of a file may be any.
void check_size(std::uint32_t width, std::uint32_t height) {
    for (const std::uint32_t size : {width, height})
        if (size < 1 || size > MaxPictureSize)
            throw std::invalid_argument(
                fmt::format("expected 1 to {} places a side, got {}", MaxPictureSize, size));
}

void check_number(std::size_t num_places) {
    if (num_places > MaxLayoutPlaces)
        throw std::invalid_argument(
            fmt::format("expected at most {} places, got {}", MaxLayoutPlaces, num_places));
}

} // namespace

std::string PixelLayout::description() const {
    return samples_per_axis == 1 ? fmt::format("pixels {} x {}", width, height)
                                 : fmt::format("pixels {} x {}, {} x {} samples each", width,
                                               height, samples_per_axis, samples_per_axis);
}

void PixelLayout::check() const {
    check_size(width, height);
    // Throws for a camera without a direction, and for sizes out of bounds.
    static_cast<void>(PictureRays(camera, width, height, samples_per_axis));
    check_number(num_samples());
}

std::string TexelLayout::description() const {
    return fmt::format("texels {} x {}", width, height);
}

void TexelLayout::check() const {
    check_size(width, height);
    check_number(num_texels());
}

const ReceiverKind& kind_of(const ReceiverLayout& layout) {
    return std::visit(
        []<typename Layout>(const Layout&) -> const ReceiverKind& { return Layout::Kind; }, layout);
}

std::string description(const ReceiverLayout& layout) {
    return std::visit([](const auto& own) { return own.description(); }, layout);
}

std::size_t num_places(const ReceiverLayout& layout) {
    return std::visit([](const auto& own) { return own.num_places(); }, layout);
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

} // namespace relumine::prt
