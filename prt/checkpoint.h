// Where long work leaves its finished part, so that a later run goes on from there. Knows nothing
// of files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace relumine::prt {

/// A store of checkpoints.
///
/// Work has named parts. Each part has a growing list of records (the finished results) and one
/// state (what the remaining work needs). Every save() replaces the state. Both are bytes of
/// files::pack(): a part that is the same in all processes, then one for each tile of receivers. So
/// they can be dealt out to any number of processes.
///
/// Threads: called from one thread at a time.
class Checkpoint {
public:
    /// What an earlier run left of a part. Both are empty where it left nothing.
    struct Saved {
        std::vector<std::vector<std::byte>> records = {};
        std::vector<std::byte> state = {};
    };

    Checkpoint() = default;
    virtual ~Checkpoint() = default;
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;

    /// Returns what an earlier run left of a part. Call it once for each part, before the first
    /// save() of the part. With `with_state`, only the records that the state covers count.
    ///
    /// Throws:  std::runtime_error for damaged data.
    [[nodiscard]] virtual Saved load(const std::string& part, bool with_state) = 0;

    /// Whether the next save() is due.
    ///
    /// Cost:    small; ask often.
    [[nodiscard]] virtual bool is_due() = 0;
    /// Whether enough was done since the last save() to pay for one more, before the work stops or
    /// goes on to its next part.
    [[nodiscard]] virtual bool is_worthwhile() = 0;

    /// Adds a record and replaces the state of the part; an empty state means none. Does both or
    /// nothing. Returns false on failure: give the record again with the next call.
    [[nodiscard]] virtual bool save(const std::string& part, std::span<const std::byte> record,
                                    std::span<const std::byte> state) = 0;
};

} // namespace relumine::prt
