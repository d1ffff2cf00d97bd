#include "prt/parts/team_checkpoint.h"

#include <cstdint>
#include <stdexcept>
#include <utility>

#include "files/packed_parts.h"
#include "prt/work.h"

namespace relumine::prt {

namespace {

using Bytes = std::vector<std::byte>;

void add_bytes(files::ByteWriter& writer, std::span<const std::byte> bytes) {
    writer.add<std::uint64_t>(bytes.size());
    writer.add_all(bytes);
}

Bytes next_bytes(files::ByteReader& reader) {
    return reader.next_all<std::byte>(static_cast<std::size_t>(reader.next<std::uint64_t>()));
}

/// Puts what each process has of one record or state into one.
Bytes together(const std::vector<Bytes>& of_processes) {
    files::ByteWriter writer;
    bool is_empty = true;
    for (const Bytes& bytes : of_processes) {
        add_bytes(writer, bytes);
        is_empty = is_empty && bytes.empty();
    }
    return is_empty ? Bytes() : writer.take();
}

} // namespace

bool TeamCheckpoint::first_says(bool answer) {
    return largest_of_all(team_, store_ != nullptr && answer ? 1 : 0) != 0;
}

Checkpoint::Saved TeamCheckpoint::load(const std::string& part, bool with_state) {
    std::vector<Bytes> to_each;
    if (team_.is_first()) { // it may have no store
        std::vector<files::ByteWriter> writers(team_.part().count);
        const auto deal = [&writers](std::span<const std::byte> bytes) {
            files::ByteReader reader(bytes);
            for (files::ByteWriter& writer : writers)
                add_bytes(writer, bytes.empty() ? Bytes() : next_bytes(reader));
            if (!reader.at_end())
                throw std::runtime_error("checkpoint: expected one of as many processes");
        };
        const Saved saved = store_ != nullptr ? store_->load(part, with_state) : Saved();
        deal(saved.state);
        for (const Bytes& record : saved.records)
            deal(record);
        for (files::ByteWriter& writer : writers)
            to_each.push_back(writer.take());
    }
    const Bytes own = team_.scatter(std::move(to_each));
    files::ByteReader reader(own);
    Saved saved{.state = next_bytes(reader)};
    while (!reader.at_end())
        saved.records.push_back(next_bytes(reader));
    return saved;
}

bool TeamCheckpoint::is_due() {
    return first_says(store_ != nullptr && store_->is_due());
}

bool TeamCheckpoint::is_worthwhile() {
    return first_says(store_ != nullptr && store_->is_worthwhile());
}

bool TeamCheckpoint::save(const std::string& part, std::span<const std::byte> record,
                          std::span<const std::byte> state) {
    const std::vector<Bytes> records = team_.gather({record.begin(), record.end()});
    const std::vector<Bytes> states = team_.gather({state.begin(), state.end()});
    return first_says(store_ != nullptr && store_->save(part, together(records), together(states)));
}

} // namespace relumine::prt
