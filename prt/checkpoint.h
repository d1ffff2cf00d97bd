// Where long work leaves what it has done, so that a later run goes on from there. Knows nothing of
// files.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace relumine::prt {

/// A store of checkpoints. Work has parts by name; each leaves a growing list of records (what is
/// finished) and one state (what the rest needs), which every save replaces. Called from one thread
/// at a time.
class Checkpoint {
public:
    /// What an earlier run left of a part; both empty where it left nothing.
    struct Saved {
        std::vector<std::vector<std::byte>> records = {};
        std::vector<std::byte> state = {};
    };

    Checkpoint() = default;
    virtual ~Checkpoint() = default;
    Checkpoint(const Checkpoint&) = delete;
    Checkpoint& operator=(const Checkpoint&) = delete;

    /// To be asked once for each part, before its first save(). `with_state`: records count only as
    /// far as the state knows of them. Throws std::runtime_error for what is damaged.
    [[nodiscard]] virtual Saved load(const std::string& part, bool with_state) = 0;

    /// Whether it is time for the next save(). Cheap.
    [[nodiscard]] virtual bool is_due() = 0;
    /// Whether so much was done since the last save() that a save() pays before the work stops or
    /// goes on to its next part.
    [[nodiscard]] virtual bool is_worthwhile() = 0;

    /// Adds a record and replaces the part's state (empty: it has none); both or nothing. False
    /// when that failed: the record must be given again with the next.
    [[nodiscard]] virtual bool save(const std::string& part, std::span<const std::byte> record,
                                    std::span<const std::byte> state) = 0;
};

} // namespace relumine::prt
