// The two codes of zstd's blocks (RFC 8878, Section 4): finite states and Huffman's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "web/wasm/zstd_frames.h"

namespace relumine::web {

/// Reads bits from the last byte to the first. The highest bit that is set in the last byte marks
/// where they begin. Bits before the first byte are 0.
class BackwardBits {
public:
    /// Throws:  NoFrame where there is no mark.
    explicit BackwardBits(Bytes bytes);

    /// Returns the next bits, 56 at most, and stays where it is.
    [[nodiscard]] std::uint64_t peek(std::uint32_t num_bits) const;
    void skip(std::uint32_t num_bits) { left_ -= num_bits; }
    std::uint64_t read(std::uint32_t num_bits) {
        const std::uint64_t value = peek(num_bits);
        skip(num_bits);
        return value;
    }
    /// Exactly so.
    [[nodiscard]] bool are_used_up() const { return left_ == 0; }
    [[nodiscard]] bool are_overdrawn() const { return left_ < 0; }

private:
    Bytes bytes_;
    std::int64_t left_;
};

/// Finite states, each of which stands for a symbol.
class FseTable {
public:
    FseTable() = default;
    /// A symbol that is always the same.
    explicit FseTable(std::uint8_t symbol) : states_{{symbol, 0, 0}} {}
    /// Probabilities in 2^accuracy; -1 for one below 1.
    FseTable(std::span<const std::int16_t> probabilities, std::uint32_t accuracy);
    /// Takes a description off the bytes.
    ///
    /// Throws:  NoFrame.
    FseTable(Bytes& bytes, std::uint32_t largest_accuracy);

    [[nodiscard]] bool is_empty() const { return states_.empty(); }
    [[nodiscard]] std::uint32_t largest_symbol() const;
    [[nodiscard]] std::uint32_t first_state(BackwardBits& bits) const {
        return static_cast<std::uint32_t>(bits.read(accuracy_));
    }
    [[nodiscard]] std::uint32_t symbol(std::uint32_t state) const { return states_[state].symbol; }
    [[nodiscard]] std::uint32_t next_state(std::uint32_t state, BackwardBits& bits) const {
        const State& own = states_[state];
        return own.base + static_cast<std::uint32_t>(bits.read(own.num_bits));
    }

private:
    struct State {
        std::uint8_t symbol;
        std::uint8_t num_bits;
        std::uint16_t base;
    };

    void build(std::span<const std::int16_t> probabilities);

    std::uint32_t accuracy_ = 0;
    std::vector<State> states_;
};

/// Codes of 1 to 11 bits for bytes.
class HuffmanCode {
public:
    HuffmanCode() = default;
    /// Takes a description off the bytes.
    ///
    /// Throws:  NoFrame.
    explicit HuffmanCode(Bytes& bytes);

    /// Throws:  NoFrame where the stream does not end with the last byte.
    void unpack(Bytes stream, std::span<std::uint8_t> to) const;

private:
    struct Entry {
        std::uint8_t symbol;
        std::uint8_t num_bits;
    };

    void build(std::vector<std::uint8_t> weights);

    std::uint32_t most_bits_ = 0;
    std::vector<Entry> table_;
};

} // namespace relumine::web
