#include "prt/parts/team_checkpoint.h"

#include <cstdint>
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

/// Puts what each process has of one record or state into one: the tiles in their order.
Bytes together(const std::vector<Bytes>& of_processes) {
    if (of_processes.empty() || of_processes.front().empty())
        return {};
    std::vector<std::vector<std::span<const std::byte>>> parts;
    std::size_t num_tiles = 0;
    for (const Bytes& bytes : of_processes)
        num_tiles += parts.emplace_back(files::packed_parts(bytes)).size() - 1;
    std::vector<std::span<const std::byte>> all = {parts[0].at(0)};
    for (std::size_t tile = 0; tile < num_tiles; ++tile)
        all.push_back(parts[tile % parts.size()].at(1 + tile / parts.size()));
    return files::joined_parts(all);
}

/// The inverse: gives each process its tiles.
void deal(std::span<const std::byte> bytes, std::span<files::ByteWriter> processes) {
    std::vector<std::span<const std::byte>> all;
    if (!bytes.empty())
        all = files::packed_parts(bytes);
    for (std::size_t i = 0; i < processes.size(); ++i) {
        std::vector<std::span<const std::byte>> own;
        if (!all.empty())
            own.push_back(all[0]);
        for (std::size_t part = 1 + i; part < all.size(); part += processes.size())
            own.push_back(all[part]);
        add_bytes(processes[i], own.empty() ? Bytes() : files::joined_parts(own));
    }
}

} // namespace

bool TeamCheckpoint::first_says(bool answer) {
    return largest_of_all(team_, store_ != nullptr && answer ? 1 : 0) != 0;
}

Checkpoint::Saved TeamCheckpoint::load(const std::string& part, bool with_state) {
    std::vector<Bytes> to_each;
    if (team_.is_first()) { // it may have no store
        std::vector<files::ByteWriter> writers(team_.part().count);
        const Saved saved = store_ != nullptr ? store_->load(part, with_state) : Saved();
        deal(saved.state, writers);
        for (const Bytes& record : saved.records)
            deal(record, writers);
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
