#include "prt/receivers/receiver_sample.h"

#include <algorithm>
#include <vector>

#include "prt/receivers/block_size.h"

namespace relumine::prt {

namespace {

constexpr std::size_t MostBlocksForOne = 16;
constexpr std::size_t LeastSampledBlocks = 1024;

} // namespace

ReceiverSample::ReceiverSample(std::size_t num_receivers)
    : num_receivers_(num_receivers), num_all_((num_receivers + BlockSize - 1) / BlockSize),
      step_(std::clamp<std::size_t>(num_all_ / LeastSampledBlocks, 1, MostBlocksForOne)) {}

std::size_t ReceiverSample::num_blocks() const {
    return (num_all_ - step_ / 2 + step_ - 1) / step_;
}

std::size_t ReceiverSample::begin(std::size_t block) const {
    return (step_ / 2 + block * step_) * BlockSize;
}

std::size_t ReceiverSample::end(std::size_t block) const {
    return std::min(begin(block) + BlockSize, num_receivers_);
}

std::size_t ReceiverSample::block_for(std::size_t place) const {
    return std::min(place / BlockSize / step_, num_blocks() - 1);
}

Receivers sample_of(const Receivers& receivers, std::span<const std::uint32_t> order) {
    const ReceiverSample blocks(order.size());
    std::vector<std::uint32_t> chosen;
    for (std::size_t block = 0; block < blocks.num_blocks(); ++block)
        chosen.insert(chosen.end(),
                      order.begin() + static_cast<std::ptrdiff_t>(blocks.begin(block)),
                      order.begin() + static_cast<std::ptrdiff_t>(blocks.end(block)));
    return sampled(receivers, chosen);
}

} // namespace relumine::prt
