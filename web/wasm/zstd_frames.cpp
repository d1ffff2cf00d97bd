// Based on: Collet and Kucherawy, Zstandard Compression and the 'application/zstd' Media Type,
// RFC 8878. Names are the RFC's.
#include "web/wasm/zstd_frames.h"

#include <algorithm>
#include <array>
#include <cstring>

#include <xxhash.h>

#include "web/wasm/entropy_codes.h"

namespace relumine::web {

namespace {

constexpr std::uint32_t Magic = 0xFD2FB528;
constexpr std::size_t BlockHeaderSize = 3;
/// Most bytes of the content of a block.
constexpr std::size_t LargestBlock = std::size_t{1} << 17;

void require(bool is_right) {
    if (!is_right)
        throw NoFrame{};
}

/// Takes the first bytes off.
Bytes take(Bytes& bytes, std::size_t size) {
    require(size <= bytes.size());
    const Bytes taken = bytes.first(size);
    bytes = bytes.subspan(size);
    return taken;
}

std::uint64_t little_endian(Bytes bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = bytes.size(); i > 0; --i)
        value = value << 8 | bytes[i - 1];
    return value;
}

struct FrameHeader {
    std::size_t size;
    std::optional<std::uint64_t> content_size;
    bool has_checksum;
};

std::optional<FrameHeader> frame_header(Bytes bytes) {
    if (bytes.size() < 5)
        return std::nullopt;
    require(little_endian(bytes.first(4)) == Magic);
    const std::uint8_t descriptor = bytes[4];
    const bool is_single_segment = (descriptor >> 5 & 1) != 0;
    constexpr std::array<std::size_t, 4> DictionarySizes = {0, 1, 2, 4};
    constexpr std::array<std::size_t, 4> ContentSizes = {0, 2, 4, 8};
    const std::size_t dictionary = DictionarySizes[descriptor & 3];
    const std::size_t content =
        descriptor >> 6 == 0 && is_single_segment ? 1 : ContentSizes[descriptor >> 6];
    const std::size_t at = 5 + (is_single_segment ? 0 : 1);
    FrameHeader header{.size = at + dictionary + content,
                       .content_size = {},
                       .has_checksum = (descriptor >> 2 & 1) != 0};
    require((descriptor >> 3 & 1) == 0);
    if (bytes.size() < header.size)
        return std::nullopt;
    require(little_endian(bytes.subspan(at, dictionary)) == 0);
    if (content != 0)
        header.content_size =
            little_endian(bytes.subspan(at + dictionary, content)) + (content == 2 ? 256 : 0);
    return header;
}

struct BlockHeader {
    enum class Type : std::uint8_t { Raw, Repeated, Compressed };

    bool is_last;
    Type type;
    /// In the frame, and of the content if that is known from here.
    std::size_t stored_size, size;
};

BlockHeader block_header(Bytes bytes) {
    const std::uint64_t value = little_endian(bytes.first(BlockHeaderSize));
    require((value >> 1 & 3) != 3);
    BlockHeader header{.is_last = (value & 1) != 0,
                       .type = static_cast<BlockHeader::Type>(value >> 1 & 3),
                       .stored_size = static_cast<std::size_t>(value >> 3),
                       .size = static_cast<std::size_t>(value >> 3)};
    if (header.type == BlockHeader::Type::Repeated)
        header.stored_size = 1;
    require(header.size <= LargestBlock);
    return header;
}

/// How lengths and distances are coded in one kind of symbol.
struct SequenceCode {
    std::uint32_t largest_accuracy;
    std::uint32_t predefined_accuracy;
    std::span<const std::int16_t> predefined;
    /// Code i stands for base[i] and as many bits more as more_bits[i] says. Empty: base is 2^i,
    /// and bits are i.
    std::span<const std::uint32_t> base;
    std::span<const std::uint8_t> more_bits;
};

constexpr std::array<std::int16_t, 36> LiteralLengths = {4, 3, 2, 2, 2, 2, 2, 2, 2,  2,  2,  2,
                                                         2, 1, 1, 1, 2, 2, 2, 2, 2,  2,  2,  2,
                                                         2, 3, 2, 1, 1, 1, 1, 1, -1, -1, -1, -1};
constexpr std::array<std::int16_t, 53> MatchLengths = {
    1, 4, 3, 2, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1,  1,  1,  1,  1,  1,  1, 1,
    1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1, -1, -1};
constexpr std::array<std::int16_t, 29> Offsets = {1, 1, 1, 1, 1, 1, 2, 2, 2, 1,  1,  1,  1,  1, 1,
                                                  1, 1, 1, 1, 1, 1, 1, 1, 1, -1, -1, -1, -1, -1};

constexpr std::array<std::uint8_t, 36> LiteralBits = {0, 0, 0, 0, 0, 0,  0,  0,  0,  0,  0,  0,
                                                      0, 0, 0, 0, 1, 1,  1,  1,  2,  2,  3,  3,
                                                      4, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
constexpr std::array<std::uint8_t, 53> MatchBits = {
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,  0,  0,  0,  0,  0,  0, 0,
    0, 0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 3, 3, 4, 4, 5, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};

/// Each code begins where the one before ends.
template<std::size_t Size>
constexpr std::array<std::uint32_t, Size> bases(const std::array<std::uint8_t, Size>& bits,
                                                std::uint32_t first) {
    std::array<std::uint32_t, Size> base{};
    for (std::size_t i = 0; i < Size; ++i) {
        base[i] = first;
        first += std::uint32_t{1} << bits[i];
    }
    return base;
}
constexpr std::array LiteralBases = bases(LiteralBits, 0);
constexpr std::array MatchBases = bases(MatchBits, 3);
static_assert(LiteralBases[25] == 64 && LiteralBases[35] == 65536);
static_assert(MatchBases[43] == 131 && MatchBases[52] == 65539);

enum Kind : std::uint8_t { LiteralLength, Offset, MatchLength };
constexpr std::array<SequenceCode, 3> Codes = {{
    {9, 6, LiteralLengths, LiteralBases, LiteralBits},
    {8, 5, Offsets, {}, {}},
    {9, 6, MatchLengths, MatchBases, MatchBits},
}};

/// Unpacks the blocks of one frame.
class Unpacker {
public:
    explicit Unpacker(std::span<std::uint8_t> to) : to_(to) {}

    void add(const BlockHeader& header, Bytes stored) {
        switch (header.type) {
        case BlockHeader::Type::Raw:
            append(stored);
            break;
        case BlockHeader::Type::Repeated:
            require(header.size <= to_.size() - done_);
            std::fill_n(to_.begin() + static_cast<std::ptrdiff_t>(done_), header.size, stored[0]);
            done_ += header.size;
            break;
        case BlockHeader::Type::Compressed:
            const std::size_t before = done_;
            read_literals(stored);
            read_sequences(stored);
            append(literals_);
            require(done_ - before <= LargestBlock);
            break;
        }
    }

    [[nodiscard]] std::size_t size() const { return done_; }

private:
    void append(Bytes bytes) {
        require(bytes.size() <= to_.size() - done_);
        if (!bytes.empty())
            std::memcpy(to_.data() + done_, bytes.data(), bytes.size());
        done_ += bytes.size();
    }

    /// The bytes that are no repetitions of earlier ones.
    void read_literals(Bytes& block) {
        require(!block.empty());
        const std::uint32_t type = block[0] & 3u, format = block[0] >> 2 & 3u;
        if (type < 2) {
            constexpr std::array<std::size_t, 4> HeaderSizes = {1, 2, 1, 3};
            const std::uint64_t header = little_endian(take(block, HeaderSizes[format]));
            const std::size_t size =
                static_cast<std::size_t>(header >> ((format & 1u) == 0 ? 3 : 4));
            require(size <= LargestBlock);
            if (type == 0) {
                literals_ = take(block, size);
            } else {
                own_literals_.assign(size, take(block, 1)[0]);
                literals_ = own_literals_;
            }
            return;
        }
        const std::uint32_t num_bits = format < 2 ? 10 : format == 2 ? 14 : 18;
        const std::uint64_t header = little_endian(take(block, format < 2 ? 3 : format + 2)) >> 4;
        const std::uint64_t mask = (std::uint64_t{1} << num_bits) - 1;
        const std::size_t size = static_cast<std::size_t>(header & mask);
        require(size <= LargestBlock);
        Bytes stored = take(block, static_cast<std::size_t>(header >> num_bits & mask));
        if (type == 2)
            huffman_ = HuffmanCode(stored);
        own_literals_.resize(size);
        unpack_literals(stored, format != 0);
        literals_ = own_literals_;
    }

    /// They come in one stream or four, the last of which takes the rest.
    void unpack_literals(Bytes stored, bool in_four) {
        std::span<std::uint8_t> to = own_literals_;
        if (!in_four) {
            huffman_.unpack(stored, to);
            return;
        }
        Bytes sizes = take(stored, 6);
        const std::size_t part = (to.size() + 3) / 4;
        require(3 * part <= to.size());
        for (int i = 0; i < 3; ++i) {
            const auto size = static_cast<std::size_t>(little_endian(take(sizes, 2)));
            huffman_.unpack(take(stored, size), to.first(part));
            to = to.subspan(part);
        }
        huffman_.unpack(stored, to);
    }

    void read_table(Kind kind, std::uint32_t mode, Bytes& block) {
        const SequenceCode& code = Codes[kind];
        FseTable& table = tables_[kind];
        if (mode == 0)
            table = FseTable(code.predefined, code.predefined_accuracy);
        else if (mode == 1)
            table = FseTable(take(block, 1)[0]);
        else if (mode == 2)
            table = FseTable(block, code.largest_accuracy);
        require(!table.is_empty());
        require(table.largest_symbol() < (kind == Offset ? 32u : code.base.size()));
    }

    void read_sequences(Bytes block) {
        std::size_t count = take(block, 1)[0];
        if (count == 255)
            count = static_cast<std::size_t>(little_endian(take(block, 2))) + 0x7F00;
        else if (count >= 128)
            count = (count - 128) * 256 + take(block, 1)[0];
        if (count == 0) {
            require(block.empty());
            return;
        }
        const std::uint32_t modes = take(block, 1)[0];
        require((modes & 3u) == 0);
        read_table(LiteralLength, modes >> 6, block);
        read_table(Offset, modes >> 4 & 3u, block);
        read_table(MatchLength, modes >> 2 & 3u, block);
        BackwardBits bits(block);
        std::array<std::uint32_t, 3> states{};
        for (const Kind kind : {LiteralLength, Offset, MatchLength})
            states[kind] = tables_[kind].first_state(bits);
        for (std::size_t i = 0; i < count; ++i) {
            copy_sequence(states, bits);
            if (i + 1 == count)
                break;
            for (const Kind kind : {LiteralLength, MatchLength, Offset})
                states[kind] = tables_[kind].next_state(states[kind], bits);
        }
        require(bits.are_used_up());
    }

    void copy_sequence(const std::array<std::uint32_t, 3>& states, BackwardBits& bits) {
        const std::uint32_t offset_code = tables_[Offset].symbol(states[Offset]);
        const std::uint32_t literal_code = tables_[LiteralLength].symbol(states[LiteralLength]);
        const std::uint32_t match_code = tables_[MatchLength].symbol(states[MatchLength]);
        const std::uint64_t offset_value =
            (std::uint64_t{1} << offset_code) + bits.read(offset_code);
        const std::size_t match_length =
            MatchBases[match_code] + static_cast<std::size_t>(bits.read(MatchBits[match_code]));
        const std::size_t literal_length =
            LiteralBases[literal_code] +
            static_cast<std::size_t>(bits.read(LiteralBits[literal_code]));
        append(take(literals_, literal_length));
        copy_match(offset_of(offset_value, literal_length == 0), match_length);
    }

    /// Values of 1 to 3 stand for the last three offsets.
    std::uint64_t offset_of(std::uint64_t value, bool has_no_literals) {
        if (value > 3) {
            last_offsets_ = {value - 3, last_offsets_[0], last_offsets_[1]};
            return value - 3;
        }
        const std::size_t index = static_cast<std::size_t>(value) - (has_no_literals ? 0 : 1);
        const std::uint64_t offset = index < 3 ? last_offsets_[index] : last_offsets_[0] - 1;
        require(offset != 0);
        if (index != 0)
            last_offsets_ = {offset, last_offsets_[0], last_offsets_[index == 1 ? 2 : 1]};
        return offset;
    }

    void copy_match(std::uint64_t offset, std::size_t length) {
        require(offset <= done_ && length <= to_.size() - done_);
        std::uint8_t* to = to_.data() + done_;
        const std::uint8_t* from = to - static_cast<std::size_t>(offset);
        done_ += length;
        if (offset >= length) {
            std::memcpy(to, from, length);
            return;
        }
        // Bytes that this copy makes are copied on.
        for (std::size_t i = 0; i < length; ++i)
            to[i] = from[i];
    }

    std::span<std::uint8_t> to_;
    std::size_t done_ = 0;
    std::array<std::uint64_t, 3> last_offsets_ = {1, 4, 8};
    HuffmanCode huffman_;
    std::array<FseTable, 3> tables_;
    /// What is left of a block's literals, and where they are if not in the block.
    Bytes literals_;
    std::vector<std::uint8_t> own_literals_;
};

} // namespace

std::optional<std::size_t> frame_size(Bytes bytes) {
    const std::optional<FrameHeader> header = frame_header(bytes);
    if (!header)
        return std::nullopt;
    std::size_t at = header->size;
    for (bool is_last = false; !is_last;) {
        if (bytes.size() - at < BlockHeaderSize)
            return std::nullopt;
        const BlockHeader block = block_header(bytes.subspan(at));
        at += BlockHeaderSize + block.stored_size;
        if (at > bytes.size())
            return std::nullopt;
        is_last = block.is_last;
    }
    at += header->has_checksum ? 4 : 0;
    return at <= bytes.size() ? std::optional(at) : std::nullopt;
}

std::optional<std::uint64_t> content_size(Bytes bytes) {
    const std::optional<FrameHeader> header = frame_header(bytes);
    require(header.has_value());
    return header->content_size;
}

std::size_t unpack_frame(Bytes frame, std::span<std::uint8_t> to) {
    const std::optional<FrameHeader> header = frame_header(frame);
    require(header && frame_size(frame) == frame.size());
    frame = frame.subspan(header->size);
    Unpacker unpacker(to);
    for (bool is_last = false; !is_last;) {
        const BlockHeader block = block_header(take(frame, BlockHeaderSize));
        unpacker.add(block, take(frame, block.stored_size));
        is_last = block.is_last;
    }
    const std::size_t size = unpacker.size();
    require(!header->content_size || *header->content_size == size);
    if (header->has_checksum)
        require(little_endian(frame) == (XXH64(to.data(), size, 0) & 0xFFFFFFFFu));
    return size;
}

} // namespace relumine::web
