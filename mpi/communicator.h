// Processes that MPI has started, as a team. Owns MPI: no other file sees it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "relumine/in/shared_work.h"

namespace relumine::mpi {

/// Thrown in each process when another one has failed and says why.
struct OtherFailed : std::exception {
    [[nodiscard]] const char* what() const noexcept override { return "another process failed"; }
};

/// All processes of MPI_COMM_WORLD. Every call begins with a meeting, in which a process that has
/// failed says so; so all end together, and one of them complains.
///
/// Throws:  OtherFailed from all calls but fail().
/// Threads: one object, used by the thread that made it.
class Communicator final : public prt::Team {
public:
    /// Starts MPI.
    Communicator();
    /// Ends MPI. All processes must get here.
    ~Communicator() override;

    /// A meeting that lasts longer ends the processes: `complain` is called in one of them, with a
    /// line that names those who did not come. 0: any time will do.
    void set_timeout(double seconds, std::function<void(const std::string&)> complain);

    [[nodiscard]] prt::Part part() const override { return part_; }
    [[nodiscard]] bool has_others() const override { return part_.count > 1; }
    void sum(std::span<std::int64_t> values) override { reduce(values, true); }
    void max(std::span<std::int64_t> values) override { reduce(values, false); }
    [[nodiscard]] std::vector<std::vector<std::byte>>
    all_gather(std::vector<std::byte> bytes) override;
    [[nodiscard]] std::vector<std::byte> broadcast(std::vector<std::byte> bytes) override;
    [[nodiscard]] std::vector<std::vector<std::byte>> gather(std::vector<std::byte> bytes) override;
    [[nodiscard]] std::vector<std::byte>
    scatter(std::vector<std::vector<std::byte>> bytes) override;
    [[nodiscard]] double seconds_waiting() const override { return seconds_waiting_; }

    /// Tells the others that this process has failed. Returns whether it is the one to complain.
    [[nodiscard]] bool fail();
    /// Waits until all have come here.
    void meet();

private:
    std::int64_t largest(std::int64_t value);
    template<typename Start>
    void run(const Start& start);
    template<typename Byte, typename Start>
    void run_in_pieces(std::span<Byte> bytes, const Start& start);
    [[noreturn]] void give_up();
    void reduce(std::span<std::int64_t> values, bool is_sum);
    [[nodiscard]] std::vector<std::size_t> sizes(std::size_t own);
    void broadcast_from(std::uint32_t process, std::span<std::byte> bytes);
    void send(std::span<const std::byte> bytes, std::uint32_t to);
    void receive(std::span<std::byte> bytes, std::uint32_t from);

    prt::Part part_;
    double timeout_ = 0.0;
    std::function<void(const std::string&)> complain_;
    double seconds_waiting_ = 0.0;
};

} // namespace relumine::mpi
