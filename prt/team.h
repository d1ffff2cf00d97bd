// Processes that share one work and can send each other bytes. Knows nothing of how they talk.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace relumine::prt {

/// The most parts of a precompute.
inline constexpr std::uint32_t MaxParts = 1 << 16;

/// One of several parts. Parts take the tiles of VisibleCounts in turn: neighbouring tiles cost
/// about the same, so the parts do, too.
struct Part {
    /// 0 .. count - 1
    std::uint32_t index = 0;
    std::uint32_t count = 1;

    bool operator==(const Part&) const = default;
};

/// Returns elements as the bytes that processes send each other.
template<typename Element>
[[nodiscard]] std::vector<std::byte> to_send(std::span<Element> elements) {
    static_assert(std::is_trivially_copyable_v<Element>);
    const auto bytes = std::as_bytes(elements);
    return {bytes.begin(), bytes.end()};
}

/// The processes that share a work. Their sums are of integers, which have the same sum in any
/// order: so each process gets the same result, and it is the same for any number of processes. The
/// first process (part 0) hands out work and takes in results.
///
/// All processes call the same functions in the same order, with spans of the same size, from one
/// thread each. A call waits for the others.
///
/// Throws:  from each call but the questions, where another process has failed.
class Team {
public:
    Team() = default;
    virtual ~Team() = default;
    Team(const Team&) = delete;
    Team& operator=(const Team&) = delete;

    /// The receivers of this process.
    [[nodiscard]] virtual Part part() const = 0;
    /// Whether there are other processes to wait for.
    [[nodiscard]] virtual bool has_others() const = 0;
    /// Whether this process has what all of them found: it writes the outputs.
    [[nodiscard]] bool is_first() const { return !has_others() || part().index == 0; }
    /// Replaces each value by its sum over all processes.
    virtual void sum(std::span<std::int64_t> values) = 0;
    /// Replaces each value by the largest of all processes.
    virtual void max(std::span<std::int64_t> values) = 0;
    /// Returns the bytes of all processes, by index, in each process.
    [[nodiscard]] virtual std::vector<std::vector<std::byte>>
    all_gather(std::vector<std::byte> bytes) = 0;
    /// Returns the bytes of all processes in the first one, by their index, and none in the others.
    [[nodiscard]] virtual std::vector<std::vector<std::byte>>
    gather(std::vector<std::byte> bytes) = 0;
    /// Returns the first process's bytes in each process; what the others give does not count.
    [[nodiscard]] virtual std::vector<std::byte> broadcast(std::vector<std::byte> bytes) = 0;
    /// Returns in process i what the first process has at i; what the others give does not count.
    [[nodiscard]] virtual std::vector<std::byte>
    scatter(std::vector<std::vector<std::byte>> bytes) = 0;

    /// Seconds that this process has spent on waiting for the others and on sending.
    [[nodiscard]] virtual double seconds_waiting() const = 0;
};

/// A process that asks no other: it does all of the work, or a part whose clusters are given.
class Alone final : public Team {
public:
    explicit Alone(const Part& part = {}) : part_(part) {}
    [[nodiscard]] Part part() const override { return part_; }
    [[nodiscard]] bool has_others() const override { return false; }
    void sum(std::span<std::int64_t>) override {}
    void max(std::span<std::int64_t>) override {}
    [[nodiscard]] std::vector<std::vector<std::byte>>
    all_gather(std::vector<std::byte> bytes) override {
        return {std::move(bytes)};
    }
    [[nodiscard]] std::vector<std::vector<std::byte>>
    gather(std::vector<std::byte> bytes) override {
        return {std::move(bytes)};
    }
    [[nodiscard]] std::vector<std::byte> broadcast(std::vector<std::byte> bytes) override {
        return bytes;
    }
    [[nodiscard]] std::vector<std::byte>
    scatter(std::vector<std::vector<std::byte>> bytes) override {
        return bytes.empty() ? std::vector<std::byte>() : std::move(bytes.front());
    }
    [[nodiscard]] double seconds_waiting() const override { return 0.0; }

private:
    Part part_;
};

/// Returns the process that does all of the work.
[[nodiscard]] inline Alone& alone() {
    static Alone all;
    return all;
}

} // namespace relumine::prt
