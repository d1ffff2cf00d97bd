#include "web/wasm/entropy_codes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace relumine::web {

namespace {

constexpr std::uint32_t MostHuffmanBits = 11;
constexpr std::size_t MostSymbols = 256;

void require_code(bool is_right) {
    if (!is_right)
        throw NoFrame{};
}

/// Reads bits from the first byte to the last.
class ForwardBits {
public:
    explicit ForwardBits(Bytes bytes) : bytes_(bytes) {}

    std::uint32_t read(std::uint32_t num_bits) {
        std::uint32_t value = 0;
        for (std::uint32_t i = 0; i < num_bits; ++i, ++at_) {
            require_code(at_ / 8 < bytes_.size());
            value |= (bytes_[at_ / 8] >> (at_ % 8) & 1u) << i;
        }
        return value;
    }
    void step_back() { --at_; }
    [[nodiscard]] std::size_t num_bytes() const { return (at_ + 7) / 8; }

private:
    Bytes bytes_;
    std::size_t at_ = 0;
};

std::uint32_t log_2(std::uint32_t value) {
    return static_cast<std::uint32_t>(std::bit_width(value)) - 1;
}

/// Numbers that cannot be large take a bit less if they are small.
std::uint32_t read_below(ForwardBits& bits, std::uint32_t largest) {
    const std::uint32_t num_bits = log_2(largest) + 1;
    const std::uint32_t value = bits.read(num_bits);
    const std::uint32_t power = 1u << num_bits;
    const std::uint32_t lower_mask = power / 2 - 1;
    const std::uint32_t threshold = power - 1 - largest;
    if ((value & lower_mask) < threshold) {
        bits.step_back();
        return value & lower_mask;
    }
    return value > lower_mask ? value - threshold : value;
}

std::vector<std::int16_t> read_probabilities(ForwardBits& bits, std::uint32_t accuracy) {
    std::vector<std::int16_t> probabilities;
    std::uint32_t left = 1u << accuracy;
    while (left > 0) {
        const int probability = static_cast<int>(read_below(bits, left + 1)) - 1;
        const std::uint32_t size = probability < 0 ? 1 : static_cast<std::uint32_t>(probability);
        require_code(size <= left && probabilities.size() < MostSymbols);
        left -= size;
        probabilities.push_back(static_cast<std::int16_t>(probability));
        for (bool may_go_on = probability == 0; may_go_on;) {
            const std::uint32_t num_zeros = bits.read(2);
            probabilities.insert(probabilities.end(), num_zeros, 0);
            may_go_on = num_zeros == 3;
        }
    }
    require_code(probabilities.size() <= MostSymbols);
    return probabilities;
}

} // namespace

BackwardBits::BackwardBits(Bytes bytes) : bytes_(bytes) {
    require_code(!bytes.empty() && bytes.back() != 0);
    left_ = static_cast<std::int64_t>(8 * (bytes.size() - 1) + log_2(bytes.back()));
}

std::uint64_t BackwardBits::peek(std::uint32_t num_bits) const {
    const std::int64_t first = left_ - static_cast<std::int64_t>(num_bits);
    const std::uint64_t mask = (std::uint64_t{1} << num_bits) - 1;
    if (left_ <= 0)
        return 0;
    const std::size_t byte = first < 0 ? 0 : static_cast<std::size_t>(first) / 8;
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.data() + byte, std::min(sizeof value, bytes_.size() - byte));
    return (first < 0 ? value << -first : value >> first % 8) & mask;
}

FseTable::FseTable(std::span<const std::int16_t> probabilities, std::uint32_t accuracy)
    : accuracy_(accuracy) {
    build(probabilities);
}

FseTable::FseTable(Bytes& bytes, std::uint32_t largest_accuracy) {
    ForwardBits bits(bytes);
    accuracy_ = bits.read(4) + 5;
    require_code(accuracy_ <= largest_accuracy);
    const std::vector<std::int16_t> probabilities = read_probabilities(bits, accuracy_);
    bytes = bytes.subspan(bits.num_bytes());
    build(probabilities);
}

void FseTable::build(std::span<const std::int16_t> probabilities) {
    const std::uint32_t size = 1u << accuracy_;
    states_.assign(size, {});
    std::array<std::uint32_t, MostSymbols> next{};
    // Symbols below a probability of 1 have one state each, from the end.
    std::uint32_t end = size;
    for (std::size_t symbol = 0; symbol < probabilities.size(); ++symbol) {
        next[symbol] = static_cast<std::uint32_t>(std::max<int>(probabilities[symbol], 0));
        if (probabilities[symbol] < 0) {
            states_[--end].symbol = static_cast<std::uint8_t>(symbol);
            next[symbol] = 1;
        }
    }
    // The others are spread out.
    const std::uint32_t step = (size >> 1) + (size >> 3) + 3;
    std::uint32_t at = 0;
    for (std::size_t symbol = 0; symbol < probabilities.size(); ++symbol)
        for (int i = 0; i < probabilities[symbol]; ++i) {
            states_[at].symbol = static_cast<std::uint8_t>(symbol);
            do
                at = (at + step) & (size - 1);
            while (at >= end);
        }
    require_code(at == 0);
    for (State& state : states_) {
        const std::uint32_t index = next[state.symbol]++;
        state.num_bits = static_cast<std::uint8_t>(accuracy_ - log_2(index));
        state.base = static_cast<std::uint16_t>((index << state.num_bits) - size);
    }
}

std::uint32_t FseTable::largest_symbol() const {
    return std::max_element(states_.begin(), states_.end(),
                            [](State a, State b) { return a.symbol < b.symbol; })
        ->symbol;
}

HuffmanCode::HuffmanCode(Bytes& bytes) {
    require_code(!bytes.empty());
    const std::size_t header = bytes[0];
    bytes = bytes.subspan(1);
    std::vector<std::uint8_t> weights;
    if (header >= 128) {
        // Half a byte each.
        const std::size_t count = header - 127;
        require_code((count + 1) / 2 <= bytes.size());
        for (std::size_t i = 0; i < count; ++i)
            weights.push_back(i % 2 == 0 ? bytes[i / 2] >> 4 : bytes[i / 2] & 15);
        bytes = bytes.subspan((count + 1) / 2);
    } else {
        require_code(header <= bytes.size());
        Bytes own = bytes.first(header);
        bytes = bytes.subspan(header);
        constexpr std::uint32_t LargestAccuracy = 6;
        const FseTable table(own, LargestAccuracy);
        BackwardBits bits(own);
        // Two states take turns, until a step needs bits that are not there.
        std::array<std::uint32_t, 2> states = {table.first_state(bits), 0};
        states[1] = table.first_state(bits);
        require_code(!bits.are_overdrawn());
        for (std::size_t turn = 0; !bits.are_overdrawn(); turn ^= 1) {
            weights.push_back(static_cast<std::uint8_t>(table.symbol(states[turn])));
            require_code(weights.size() < MostSymbols);
            states[turn] = table.next_state(states[turn], bits);
            if (bits.are_overdrawn())
                weights.push_back(static_cast<std::uint8_t>(table.symbol(states[turn ^ 1])));
        }
    }
    build(std::move(weights));
}

void HuffmanCode::build(std::vector<std::uint8_t> weights) {
    std::uint32_t sum = 0;
    for (const std::uint8_t weight : weights) {
        require_code(weight <= MostHuffmanBits);
        sum += weight == 0 ? 0 : 1u << (weight - 1);
    }
    // The last weight fills up to a power of two.
    require_code(sum != 0 && weights.size() < MostSymbols);
    most_bits_ = log_2(sum) + 1;
    const std::uint32_t rest = (1u << most_bits_) - sum;
    require_code(most_bits_ <= MostHuffmanBits && std::has_single_bit(rest));
    weights.push_back(static_cast<std::uint8_t>(log_2(rest) + 1));
    table_.clear();
    for (std::uint32_t weight = 1; weight <= most_bits_; ++weight)
        for (std::size_t symbol = 0; symbol < weights.size(); ++symbol)
            if (weights[symbol] == weight)
                table_.insert(table_.end(), std::size_t{1} << (weight - 1),
                              {static_cast<std::uint8_t>(symbol),
                               static_cast<std::uint8_t>(most_bits_ + 1 - weight)});
    require_code(table_.size() == std::size_t{1} << most_bits_);
}

void HuffmanCode::unpack(Bytes stream, std::span<std::uint8_t> to) const {
    require_code(!table_.empty());
    BackwardBits bits(stream);
    for (std::uint8_t& value : to) {
        const Entry entry = table_[bits.peek(most_bits_)];
        bits.skip(entry.num_bits);
        value = entry.symbol;
    }
    require_code(bits.are_used_up());
}

} // namespace relumine::web
