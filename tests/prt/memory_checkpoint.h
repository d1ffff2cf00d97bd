// A checkpoint in memory that stops the work after some saves, as a kill would.
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include "prt/checkpoint.h"

namespace relumine::prt {

struct Killed : std::exception {};

class MemoryCheckpoint : public Checkpoint {
public:
    /// The save after so many throws Killed, before it saves anything.
    std::size_t saves_to_live = static_cast<std::size_t>(-1);
    std::size_t num_saves = 0;
    /// Of the looks, one is due
    std::size_t every = 1;
    /// Nothing can be saved
    bool is_failing = false;
    bool is_worth_it = true;
    std::map<std::string, Saved> parts;

    [[nodiscard]] Saved load(const std::string& part, bool) override { return parts[part]; }
    [[nodiscard]] bool is_due() override { return ++num_looks_ % every == 0; }
    [[nodiscard]] bool is_worthwhile() override { return is_worth_it; }
    [[nodiscard]] bool save(const std::string& part, std::span<const std::byte> record,
                            std::span<const std::byte> state) override {
        if (num_saves == saves_to_live)
            throw Killed();
        ++num_saves;
        if (is_failing)
            return false;
        if (!record.empty())
            parts[part].records.emplace_back(record.begin(), record.end());
        parts[part].state.assign(state.begin(), state.end());
        return true;
    }

private:
    std::size_t num_looks_ = 0;
};

/// Keeps what the store held after each save.
class CheckpointHistory final : public MemoryCheckpoint {
public:
    std::vector<std::map<std::string, Saved>> after;

    [[nodiscard]] bool save(const std::string& part, std::span<const std::byte> record,
                            std::span<const std::byte> state) override {
        const bool is_saved = MemoryCheckpoint::save(part, record, state);
        after.push_back(parts);
        return is_saved;
    }
};

} // namespace relumine::prt
