// One checkpoint of all processes that share a precompute.
#pragma once

#include "prt/checkpoint.h"
#include "prt/team.h"

namespace relumine::prt {

/// Passes each process's records and states to the first process, which stores all of them as one
/// process would that does all work: so a checkpoint has all processes at the same place, whichever
/// of them is killed when, and any number of processes goes on from it.
///
/// All processes call the same functions in the same order.
class TeamCheckpoint final : public Checkpoint {
public:
    /// `store`: of the first process; null in the others. Both arguments must outlive this object.
    TeamCheckpoint(Team& team, Checkpoint* store) : team_(team), store_(store) {}

    [[nodiscard]] Saved load(const std::string& part, bool with_state) override;
    [[nodiscard]] bool is_due() override;
    [[nodiscard]] bool is_worthwhile() override;
    [[nodiscard]] bool save(const std::string& part, std::span<const std::byte> record,
                            std::span<const std::byte> state) override;

private:
    [[nodiscard]] bool first_says(bool answer);

    Team& team_;
    Checkpoint* store_;
};

} // namespace relumine::prt
