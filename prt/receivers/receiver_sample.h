// A sample of receivers that stands for all of them where clusters are chosen.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "prt/receivers/receivers.h"

namespace relumine::prt {

/// Every n-th block of 16 neighbours in spatial order: n is 16 for many receivers, less where fewer
/// than 1,024 blocks would remain.
class ReceiverSample {
public:
    explicit ReceiverSample(std::size_t num_receivers);

    [[nodiscard]] std::size_t num_blocks() const;
    /// The place of the first receiver of a block of the sample.
    [[nodiscard]] std::size_t begin(std::size_t block) const;
    [[nodiscard]] std::size_t end(std::size_t block) const;
    /// The block of the sample for a place among all receivers.
    [[nodiscard]] std::size_t block_for(std::size_t place) const;

private:
    std::size_t num_receivers_;
    std::size_t num_all_;
    std::size_t step_;
};

/// Returns the receivers of the sample, as sampled() does. `order` is their spatial_order().
[[nodiscard]] Receivers sample_of(const Receivers& receivers, std::span<const std::uint32_t> order);

} // namespace relumine::prt
