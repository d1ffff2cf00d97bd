#include "prt/steps.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <span>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "files/packed_parts.h"
#include "files/parallel.h"
#include "files/seconds.h"

namespace relumine::prt {

TooLarge::TooLarge(const std::string& what, std::uint64_t number, std::uint64_t size)
    : std::runtime_error(fmt::format("too many {}: {} take {} bytes", what, number, size)),
      count(number), bytes(size) {}

std::uint64_t largest_of_all(Team& team, std::uint64_t value) {
    std::array<std::int64_t, 1> values = {static_cast<std::int64_t>(value)};
    team.max(values);
    return static_cast<std::uint64_t>(values[0]);
}

void Progress::start_stage(double begin, double end) {
    begin_ = std::max(begin, last_);
    const double scale = begin < 1.0 ? (1.0 - begin_) / (1.0 - begin) : 0.0;
    end_ = begin_ + scale * (end - begin);
}

void Progress::report(double part) {
    poll();
    if (!on_progress_)
        return;
    const std::scoped_lock lock(mutex_);
    const double fraction = begin_ + (end_ - begin_) * part;
    if (fraction > last_)
        on_progress_(last_ = fraction);
}

void Progress::poll() const {
    if (stop_.stop_requested())
        throw Cancelled();
}

Steps::Steps(const Work& work, std::string part, std::function<Content()> content,
             std::function<void()> on_saved)
    : work_(work), part_(std::move(part)), content_(std::move(content)),
      on_saved_(std::move(on_saved)) {}

Checkpoint::Saved Steps::load(bool with_state) const {
    return work_.checkpoint != nullptr ? work_.checkpoint->load(part_, with_state)
                                       : Checkpoint::Saved();
}

void Steps::save() {
    const auto start = std::chrono::steady_clock::now();
    const Content content = content_();
    if (work_.checkpoint->save(part_, content.record, content.state)) {
        on_saved_();
        has_news_ = false;
    }
    seconds_saving_ += files::seconds_since(start);
}

void Steps::look_up() {
    has_news_ = true;
    if (largest_of_all(work_.team, work_.stop.stop_requested() ? 1 : 0) != 0)
        throw Cancelled();
    if (work_.checkpoint != nullptr && work_.checkpoint->is_due())
        save();
}

void Steps::run(const std::function<void()>& work) {
    const auto save_if_worthwhile = [this] {
        if (work_.checkpoint != nullptr && has_news_ && work_.checkpoint->is_worthwhile())
            save();
    };
    try {
        work();
    } catch (const TooLarge&) {
        if (work_.checkpoint != nullptr)
            save();
        throw;
    } catch (const Cancelled&) {
        save_if_worthwhile();
        throw;
    }
    if (work_.more_follows)
        save_if_worthwhile();
}

namespace {

/// Writes some blocks, in rising order, tile by tile.
std::vector<std::byte> record_of(const BlockWork& work, std::span<const std::size_t> blocks) {
    const std::size_t num_tiles =
        (work.num_blocks + work.blocks_per_tile - 1) / work.blocks_per_tile;
    return files::pack(1 + num_tiles, [&](std::size_t part) {
        files::ByteWriter writer;
        if (part == 0)
            return writer.take();
        const std::size_t tile = part - 1;
        for (auto block =
                 std::lower_bound(blocks.begin(), blocks.end(), tile * work.blocks_per_tile);
             block != blocks.end() && *block < part * work.blocks_per_tile; ++block) {
            writer.add<std::uint64_t>(*block % work.blocks_per_tile);
            work.write(*block, writer);
        }
        return writer.take();
    });
}

/// Reads the blocks of a record.
void read_blocks(const BlockWork& work, std::span<const std::byte> record,
                 std::vector<bool>& is_done) {
    std::size_t part = 0;
    files::unpack(record, [&](std::span<const std::byte> bytes) {
        for (files::ByteReader reader(bytes); !reader.at_end();) {
            const auto in_tile = reader.next<std::uint64_t>();
            const std::size_t block = (part - 1) * work.blocks_per_tile + in_tile;
            if (part == 0 || in_tile >= work.blocks_per_tile || block >= work.num_blocks ||
                is_done[block])
                throw std::runtime_error("checkpoint: expected each block once");
            is_done[block] = true;
            work.read(block, reader);
        }
        ++part;
    });
}

} // namespace

void do_blocks(const Work& work, const BlockWork& blocks, Progress& progress) {
    // In rising order; the numbers below count in it. They are the same in all processes, of which
    // some have less to do.
    std::vector<std::size_t> to_do;
    std::size_t num_done = 0, num_saved = 0;
    const auto own = [&](std::size_t number) {
        return std::min(number, to_do.size());
    };
    const auto content = [&] {
        return Steps::Content{
            .record = record_of(
                blocks, std::span(to_do).subspan(own(num_saved), own(num_done) - own(num_saved)))};
    };
    Steps steps(work, blocks.part, content, [&] { num_saved = num_done; });
    std::vector<bool> is_done(blocks.num_blocks);
    for (const std::vector<std::byte>& record : steps.load(false).records)
        read_blocks(blocks, record, is_done);
    for (std::size_t block = 0; block < blocks.num_blocks; ++block)
        if (!is_done[block])
            to_do.push_back(block);
    const auto most_to_do = static_cast<std::size_t>(largest_of_all(work.team, to_do.size()));
    std::atomic<std::size_t> num_reported = blocks.num_blocks - to_do.size();
    const auto check = [&] {
        if (blocks.check)
            blocks.check();
    };
    const auto blocks_per_step =
        static_cast<std::size_t>(work.step_size.value_or(blocks.blocks_per_step));
    steps.run([&] {
        for (check(); num_done < most_to_do; check()) {
            const std::size_t end = std::min(num_done + blocks_per_step, most_to_do);
            files::parallel_for(own(num_done), own(end), [&](std::size_t i) {
                blocks.work(to_do[i]);
                progress.report(static_cast<double>(++num_reported) /
                                static_cast<double>(blocks.num_blocks));
            });
            num_done = end;
            steps.look_up();
        }
    });
}

} // namespace relumine::prt
